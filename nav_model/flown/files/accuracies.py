"""Accuracies of a solution; zeros are none."""

import numpy as np

from nav_model.flown.solution import Claims
from nav_model.trajectory.files.epochs import Epochs
from nav_model.trajectory.files.heights import Heights


def claims_of(epochs: Epochs, heights: Heights) -> Claims | None:
    """The claims of epochs; rows of zeros are none, nor are sigmas below zero."""
    members = {}
    for name in ("position", "velocity", "attitude"):
        sigma = getattr(epochs, f"sigma_{name}")
        if sigma is None:
            continue
        with np.errstate(invalid="ignore"):
            empty = ~(sigma >= 0.0).all(axis=1) | (sigma == 0.0).all(axis=1)
        if empty.all():
            heights.note(f"the sigmas of the {name} are zero, which is no claim")
        else:
            members[name] = np.where(empty[:, None], np.nan, sigma)
    return Claims(epochs.accuracy, **members) if members else None
