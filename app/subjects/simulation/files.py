"""A study as a file, for the page and the command."""

import io
import json
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from nav_model.simulation.design_study import SimulationStudy, to_document
from nav_model.simulation.result import to_arrays, to_csv


def as_json(study: SimulationStudy) -> bytes:
    """The whole study, one line end at the end."""
    return (json.dumps(to_document(study), ensure_ascii=False, allow_nan=False, indent=1) + "\n").encode()


def as_npz(study: SimulationStudy) -> bytes:
    """Every array; in memory, as NumPy's archive seeks and a file is written once."""
    packed = io.BytesIO()
    arrays: dict[str, Any] = {**to_arrays(study.result), "refined_position_sigma_m": study.refined_sigma}
    np.savez_compressed(packed, **arrays)
    return packed.getvalue()


FILES: Mapping[str, Callable[[SimulationStudy], bytes]] = {
    ".json": as_json,
    ".npz": as_npz,
    ".csv": lambda study: to_csv(study.result).encode(),
}
"""By the end of a file's name."""
