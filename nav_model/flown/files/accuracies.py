"""Accuracies of a solution: from their own times to those of the solution, and zeros, which are none."""

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError
from nav_model.flown.solution import Claims
from nav_model.trajectory.files.epochs import Epochs
from nav_model.trajectory.files.heights import Heights


def at_times(time: Array, stamps: Array, sigmas: Array, heights: Heights, name: str) -> Array:
    """Sigmas (m, k) at `stamps`, at the times of a solution: linear between, NaN before the first and after the last.

    Parameters
    ----------
    time, stamps : array
        Of the solution (n,), and of the sigmas (m,) [s].
    sigmas : array (m, k)
        Accuracies.
    heights : Heights
        Sentences on how it was read.
    name : str
        File of the sigmas, in messages.

    Raises
    ------
    InputError
        Where the two have no time in common.
    """
    good = np.isfinite(stamps) & np.isfinite(sigmas).all(axis=1)
    stamps, sigmas = stamps[good], sigmas[good]
    inside = (time >= stamps[0]) & (time <= stamps[-1]) if len(stamps) else np.zeros(len(time), dtype=bool)
    if not inside.any():
        spans = " and ".join(f"{t[0]:.0f} to {t[-1]:.0f} s" for t in (time, stamps) if len(t))
        raise InputError(name, f"has no time in common with {heights.file_name} ({spans}). Give those of one flight.")
    if outside := int(np.sum(~inside)):
        heights.note(f"no accuracies at {outside} of {len(time)} times, which {name} does not cover")
    columns = [np.interp(time, stamps, column, left=np.nan, right=np.nan) for column in sigmas.T]
    return np.column_stack(columns)


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
    return Claims(epochs.accuracy, **members) if members or epochs.accuracy == "test ratio" else None
