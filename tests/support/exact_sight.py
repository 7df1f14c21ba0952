"""Lines of sight over an aperture from exact ranges, for tests of what takes them in series."""

from typing import Any

import numpy as np

from nav_model.sar.line_of_sight import ApertureGeometry, ranges_to_target


def directions(geometry: ApertureGeometry, time: Any) -> Any:
    """Unit line of sight at each time (n,): (n, 3)."""
    vectors = ranges_to_target(geometry, time)
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
