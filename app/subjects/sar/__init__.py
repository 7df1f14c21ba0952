"""Strategies for navigating through the aperture, and the image quality of each."""
