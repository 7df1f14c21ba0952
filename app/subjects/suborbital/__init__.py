"""What a star tracker repairs of an INS over a suborbital flight."""
