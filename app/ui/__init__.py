"""Widgets and looks of our own."""
