"""The charts of the suborbital study, as plain data. Each takes a `Content` and draws what is in it; none computes
an error."""
