"""Suborbital: the errors of an INS that a star tracker corrects over a suborbital flight."""
