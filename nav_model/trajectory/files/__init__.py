"""Flights from files: plans that are flown, recordings as they were flown. `reader` tells a file by its content."""
