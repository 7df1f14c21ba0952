"""Trajectory: the covariance along a flight, real time and post-processed, with the image figures of its lines."""
