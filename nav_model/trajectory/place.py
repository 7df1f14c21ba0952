"""The place of the image along a flight, by the budget's model of it. [P-7]

A flight has shifts of the image by source. All that the budget adds to them on the way to a figure is added here by
the same formulas, `RealTime.shift` and what follows from it: an error source that they get, the flight has too.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nav_model.budget.inputs import RECTIFICATION, Inputs
from nav_model.budget.real_time import RealTime, with_range_errors
from nav_model.budget.shares import ACCELEROMETER_BIAS, CONSTANT, GYRO_BIAS, SEEN, SIZES
from nav_model.design.figures import IN_FLIGHT, of_kind
from nav_model.processing.geolocation import Shifts

FloatArray = NDArray[np.float64]
PLACES = tuple(name for name in of_kind("place") if name in IN_FLIGHT)
"""Figures of place that are known along a flight."""
_FLOWN = (*SEEN, *CONSTANT, ACCELEROMETER_BIAS, GYRO_BIAS, RECTIFICATION)
_CIRCULAR = ("ce90", "cep")  # of both axes on the ground


def beside(x: Inputs) -> tuple[str, ...]:
    """Sources of error that a design has and its flight has not."""
    sizes = {name: [getattr(x, field) for field in fields] for name, fields in SIZES.items() if name not in _FLOWN}
    return (*(name for name, values in sizes.items() if any(np.any(value) for value in values)), *x.fast)


def alone(x: Inputs, source: str = "") -> Inputs:
    """The inputs with one source beside the flight, or with none."""
    others = [name for name in beside(x) if name in SIZES and name != source]
    zeros: dict[str, Any] = {field: np.zeros(()) for name in others for field in SIZES[name]}
    return replace(x, fast={name: fast for name, fast in x.fast.items() if name == source}, **zeros)


def places_of(moved: Shifts, by_source: Shifts, x: Inputs) -> Mapping[str, tuple[FloatArray, FloatArray]]:
    """The figures of place, without contributors.

    Parameters
    ----------
    moved : Shifts
        Variances of the image's shift by all errors of the flight, (apertures) each [m²].
    by_source : Shifts
        Those of each source, (sources, apertures).
    x : Inputs

    Returns
    -------
    mapping
        Figure -> one sigma (apertures) [m], and variances [m²] of the flight's sources and then of those `beside` it,
        (sources, apertures): of CE90 the sums of both axes.
    """
    still = Shifts(*np.zeros(len(Shifts._fields)))
    whole, parts = _model(x, moved), [_model(alone(x), by_source)]
    parts += [_model(alone(x, source), still) for source in beside(x)]
    count, figures = len(moved.range), {}
    for name in PLACES:
        rows = [np.broadcast_to(np.atleast_1d(_variance(part, name)), (*np.shape(part.shift.range)[:-1], count))
                for part in parts]  # fmt: skip
        figures[name] = np.asarray(whole.value(name)), np.vstack(rows)
    return figures


def _model(x: Inputs, moved: Shifts) -> RealTime:
    model = RealTime(x)
    model.shift = with_range_errors(x, moved)
    return model


def _variance(model: RealTime, name: str) -> FloatArray:
    if name in _CIRCULAR:
        along, across, _ = model.ground
        return np.asarray(along + across)
    return np.asarray(model.value(name) ** 2)
