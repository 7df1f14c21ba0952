"""Saved designs side by side, reviewed and signed."""
