"""Which errors of an INS a star tracker corrects over a suborbital flight."""
