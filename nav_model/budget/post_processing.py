"""The figures of a design after the flight, when a smoother has the whole leg."""

import math
from functools import partial

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.frozen import FrozenMapping
from nav_model.budget.contributors import composed, entering
from nav_model.budget.figures import IMAGING, SETTLED, SMOOTHED, smoothed_with_shifts
from nav_model.budget.image import placement_of
from nav_model.budget.inputs import Inputs
from nav_model.budget.navigation import smoothed_outage
from nav_model.budget.refusals import refused
from nav_model.budget.response import response_of
from nav_model.budget.result import (
    AfterFlight,
    Outage,
    Placement,
    PostProcessed,
    Sar,
    Sigmas,
    Spectral,
    SteadyState,
)
from nav_model.budget.shares import shares_by_step, shares_of
from nav_model.budget.verdict import judge
from nav_model.design import Design
from nav_model.design.contributors import BY_ORDER
from nav_model.processing.geolocation import Shifts


def after_flight(
    design: Design, inputs: Inputs, steady_state: SteadyState, coast: Outage, sar: Sar, spectral: Spectral
) -> AfterFlight:
    """Figures, image location and verdict after post-processing. [P-3], [P-5]

    Raises
    ------
    InputError
        If double precision cannot hold the design's values together.
    """
    with refused(design), np.errstate(invalid="raise", divide="raise"):
        smoothed, placement = _post_processed(inputs)
    verdict = judge(design, steady_state, coast, sar, placement, spectral, smoothed)
    return AfterFlight(smoothed, placement, verdict)


def _post_processed(x: Inputs) -> tuple[PostProcessed, Placement]:
    moved: list[Shifts | None] = []

    def both(y: Inputs) -> dict[str, Array]:
        found, shifts = smoothed_with_shifts(y, SMOOTHED)
        moved.append(shifts)
        return found

    sized = shares_by_step(x, both)
    value = {name: value for name, (value, _) in sized.items()}
    if not all(map(math.isfinite, value.values())):
        raise FloatingPointError("the smoothed figures are beyond double precision")
    shares = shares_of(sized)
    shares["detrended_phase"] = shares[f"detrended_phase_{x.autofocus_order}"]
    value["detrended_phase"] = value[f"detrended_phase_{x.autofocus_order}"]
    whole = {
        name: composed(value[name], shares[name], entering(x.own, name, post_processed=True))
        for name in (*SETTLED, *IMAGING, *BY_ORDER)
    }
    smoothed = PostProcessed(
        sigmas=Sigmas(*(whole[name].sigma for name in SETTLED)),
        quadratic=whole["quadratic_phase"].sigma,
        cubic=whole["cubic_phase"].sigma,
        detrended=whole["detrended_phase"].sigma,
        by_order=FrozenMapping({name: whole[name].sigma for name in BY_ORDER}),
        along_track_quadratic=whole["along_track_quadratic_phase"].sigma,
        turning_quadratic=value["turning_quadratic_phase"],
        turning_by_order=(value["turning_detrended_phase_1"], value["turning_detrended_phase_2"]),
        azimuth_shift=value["slope_shift"],
        shares=FrozenMapping(shares | {name: each.shares for name, each in whole.items()}),
        sizes=FrozenMapping({name: each.sizes for name, each in whole.items()}),
        navigation=FrozenMapping({name: value[name] for name in IMAGING}),
        respond=partial(response_of, x),
        through=partial(smoothed_outage, x),
    )
    assert moved[0] is not None
    shifts = Shifts(*(np.asarray(value.real.flat[0]) for value in moved[0]))  # the shares' steps are imaginary
    return smoothed, placement_of(x, shifts, sized, post_processed=True)
