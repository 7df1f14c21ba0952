"""A study as a file, for the page and the command."""

import io
import json
from typing import Any

import numpy as np

from nav_model.simulation.design_study import SimulationStudy, to_document


def as_json(study: SimulationStudy) -> str:
    """The whole study, one line end at the end."""
    return json.dumps(to_document(study), ensure_ascii=False, allow_nan=False, indent=1) + "\n"


def as_csv(study: SimulationStudy) -> str:
    """The sigmas against time."""
    from nav_model.simulation.result import to_csv

    return to_csv(study.result)


def as_npz(study: SimulationStudy) -> bytes:
    """Every array; in memory, as NumPy's archive seeks and a file is written once."""
    from nav_model.simulation.result import to_arrays

    packed = io.BytesIO()
    arrays: dict[str, Any] = {**to_arrays(study.result), "refined_position_sigma_m": study.refined_sigma}
    np.savez_compressed(packed, **arrays)
    return packed.getvalue()
