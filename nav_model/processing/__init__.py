"""Post-processing: the error that a smoother leaves, every source as a spectrum, and where the image lies."""
