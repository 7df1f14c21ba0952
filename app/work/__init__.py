"""Work that must not hold up a slider: processes, runs, progress."""
