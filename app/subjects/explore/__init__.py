"""Inverse questions: what would close the design."""
