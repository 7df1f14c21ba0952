"""One Earth: shape, gravity, rotations, trajectories."""
