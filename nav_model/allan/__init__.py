"""Static or moving inertial log -> noise parameters with confidence, or the reason why not."""
