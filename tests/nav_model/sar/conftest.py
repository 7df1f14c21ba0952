"""The three designs of sar.md's strategy table, as per-axis models."""

import numpy as np
import pytest

from nav_model.sar.axis_model import AxisModel

DEG_ROOT_HOUR = np.pi / 180 / 60
M_S_ROOT_HOUR = 1 / 60


@pytest.fixture(scope="session")
def table_designs():
    """name -> (model, aperture time)."""
    return {
        "GNSS 1 m": (AxisModel(0.05 * M_S_ROOT_HOUR, 0.5 * DEG_ROOT_HOUR, 1.0, 1.0), 20.0),
        "GNSS 2 cm": (AxisModel(0.05 * M_S_ROOT_HOUR, 0.5 * DEG_ROOT_HOUR, 0.02, 1.0), 20.0),
        "short": (AxisModel(0.07 * M_S_ROOT_HOUR, 0.15 * DEG_ROOT_HOUR, 0.02, 1.0), 5.0),
    }
