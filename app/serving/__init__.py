"""The server: access, limits, logs and metrics."""
