"""Ways of navigating through the aperture, and what each costs the image."""
