"""Sources of a design's noise values: logs and the catalogue."""
