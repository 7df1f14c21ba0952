"""Where a design's noise comes from: logs and the catalogue."""
