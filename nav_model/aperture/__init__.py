"""One synthetic aperture: its geometry, the phase that an error makes, its window and impulse response."""
