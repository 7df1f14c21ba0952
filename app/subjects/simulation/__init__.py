"""The design flown many times, beside its closed forms."""
