"""Noise parameters with confidence intervals from an inertial log, static or moving, or the reason why there are
none."""
