"""What navigation errors and vibration do to the image: phase, side lobes, and where the image lies."""

import math
from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from nav_model.analytic.steady_state import Horizontal
from nav_model.aperture import geometry, phase
from nav_model.aperture.polynomial_response import half_power_extent
from nav_model.aperture.window import ideal_null_cells
from nav_model.base.arrays import Array
from nav_model.base.frozen import FrozenMapping
from nav_model.budget.contributors import composed, entering
from nav_model.budget.fast import LEVELS, levels, stays
from nav_model.budget.figures import INITIAL_TILT, PLACING, along_track_phase, phase_sources
from nav_model.budget.inputs import Inputs
from nav_model.budget.response import NO_IMAGE, response_of
from nav_model.budget.result import Echo, PhaseLine, Placement, Sar, Spectral
from nav_model.budget.shares import Shares, shares_by_step, shares_of
from nav_model.design import Design
from nav_model.design.contributors import BY_ORDER
from nav_model.processing.geolocation import Shifts, ground_covariance
from nav_model.processing.paired_echo import NOTHING, echo, fast_lines

_COLUMNS = {"quadratic_phase": "quadratic", "cubic_phase": "cubic", "detrended_phase": "detrended"}


def sar_of(design: Design, x: Inputs, start: Horizontal, shares: Mapping[str, Shares]) -> Sar:
    """Phase budget of the aperture in real time; `start` is the covariance at the last fix. [S-5]

    `shares` are those of the initial tilt and of the along-track phase.
    """
    radar = design.radar
    wavelength, aperture = float(x.wavelength), float(x.aperture)
    budget = phase_sources(x, start)
    of_model = {name: _in_phase(x, budget, column) for name, column in _COLUMNS.items()}
    limited = [name for name in BY_ORDER if any(limit.on == name for limit in x.limits)]
    for name in limited:
        of_model[name] = _in_phase(x, phase_sources(replace(x, autofocus_order=BY_ORDER[name]), start), "detrended")
    along = float(along_track_phase(x, start))
    of_model["along_track_quadratic_phase"] = along, shares["along_track_quadratic_phase"]
    found = {name: composed(*of, entering(x.own, name, post_processed=False)) for name, of in of_model.items()}
    one, two, three = (found[name] for name in _COLUMNS)
    in_the_middle = along_track_phase(replace(x, before_aperture=x.before_aperture + x.aperture / 2), start)
    lines = tuple(
        PhaseLine(
            source,
            *(each.sizes.get(source, 0.0) for each in (one, two, three)),
            *(each.shares.get(source, 0.0) for each in (one, three)),
        )
        for source in dict.fromkeys((*one.sizes, *two.sizes, *three.sizes))
    )
    return Sar(
        wavelength=wavelength,
        aperture_time=aperture,
        aperture_length=aperture * design.flight.speed,
        cell_length=float(
            geometry.cell_length(wavelength, radar.slant_range, design.flight.speed, aperture, x.squint)
        ),
        window=radar.window,
        autofocus_order=radar.autofocus_order,
        quadratic=one.sigma,
        cubic=two.sigma,
        detrended=three.sigma,
        along_track_quadratic=found["along_track_quadratic_phase"].sigma,
        by_order=FrozenMapping({name: found[name].sigma for name in limited}),
        along_track_growth=float(in_the_middle) / along,
        lines=lines,
        shares=FrozenMapping({name: each.shares for name, each in found.items()}),
        tilt_shares=shares[INITIAL_TILT],
        half_power_extent=(
            None if one.sigma > NO_IMAGE else half_power_extent(one.sigma, x.window)  # type: ignore[arg-type]
        ),
        respond=partial(response_of, x),
    )


def _in_phase(x: Inputs, budget: Mapping[str, phase.PhaseVariances], column: str) -> tuple[float, Shares]:
    """A phase [rad] without contributors, and the share of each source in its variance."""
    whole = getattr(phase.total(budget), column)
    shares = {source: float(getattr(made, column) / whole) for source, made in budget.items()}
    return float(x.to_phase * np.sqrt(whole)), shares


def spectral_of(x: Inputs, cell: float) -> Spectral:
    """Echoes beyond the main lobe, the highest first, and scattered energy; `cell` [m] is one in azimuth."""
    if not x.fast:
        none: Shares = FrozenMapping({"no such source": 1.0})
        return Spectral(
            (), FrozenMapping(dict.fromkeys(LEVELS, NOTHING)), 1.0, FrozenMapping(dict.fromkeys(LEVELS, none))
        )

    shares = shares_of(shares_by_step(x, _heights))
    lobe = ideal_null_cells(x.window)
    echoes = [
        Echo(name, float(at), float(phase), float(level), float(at * x.aperture * cell))
        for name, made in x.fast.items()
        for at, phase, level, beside in zip(
            made.frequency,
            x.to_phase * made.amplitude,
            echo(x.to_phase * made.amplitude),
            fast_lines(made, x.aperture, lobe),
            strict=True,
        )
        if beside and level > NOTHING
    ]
    return Spectral(
        tuple(sorted(echoes, key=lambda item: -item.level)),
        FrozenMapping({name: float(value) for name, value in _heights(x).items()}),
        float(stays(x.fast.values(), x.to_phase, x.aperture, x.window)[0]),
        FrozenMapping({name: _of(x.fast, shares[name]) for name in LEVELS}),
        float(x.to_phase**2 * sum(made.scattered for made in x.fast.values())),
    )


def _heights(x: Inputs) -> dict[str, Array]:
    return levels(x.fast.values(), x.to_phase, x.aperture, x.window)


def _of(names: Collection[str], shares: Shares) -> Shares:
    """The shares of these sources, scaled to add up to one; equal where none has any."""
    whole = math.fsum(shares[name] for name in names)
    return FrozenMapping({name: shares[name] / whole if whole else 1 / len(names) for name in names})


def placement_of(
    x: Inputs, moved: Shifts, sized: Mapping[str, tuple[float, Shares]], *, post_processed: bool = False
) -> Placement:
    """Where the image lies: from the variances of its shift, and from value and shares of `PLACING`. [P-7]

    What enters a figure in this processing is in that figure, and in no other.
    """
    ground = ground_covariance(moved, x.grazing_angle, x.scene_height_error, x.squint)
    placed = {name: composed(*sized[name], entering(x.own, name, post_processed=post_processed)) for name in PLACING}
    return Placement(
        range=placed["range_shift"].sigma,
        azimuth=placed["azimuth_shift"].sigma,
        ground=(float(ground[0]), float(ground[1]), float(ground[2])),
        ce90=placed["ce90"].sigma,
        cep=placed["cep"].sigma,
        le90=placed["le90"].sigma,
        shares=FrozenMapping({name: placed[name].shares for name in PLACING}),
    )
