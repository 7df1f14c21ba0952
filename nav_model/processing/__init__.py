"""Post-processing: the smoothed error, sources as spectra, and image location errors."""
