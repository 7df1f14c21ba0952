"""Designs that cannot be analysed, refused with the input to change."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import cast

from nav_model.aperture.geometry import hidden
from nav_model.base.errors import InputError
from nav_model.base.units import format_bound
from nav_model.budget.inputs import LONGEST_APERTURE, Inputs, inputs_of
from nav_model.design import Design
from nav_model.design.parts import quantity


@contextmanager
def refused(design: Design) -> Iterator[None]:
    """Refuse a design whose values are too far apart for double precision."""
    try:
        yield
    except ArithmeticError as error:
        key, *others = filter(design.uses, _TOGETHER)
        beside = ", ".join(f"{other} {_text(design, other)}" for other in others)
        reason = (
            f"{_text(design, key)} is too far from {beside} for double precision ({error}). "
            "Bring these values closer together."
        )
        raise InputError(key, reason, design[key]) from error


_TOGETHER = (
    "gnss.correlated_noise", "imu.angle_random_walk", "imu.velocity_random_walk", "gnss.position_noise",
    "gnss.interval", "gnss.velocity_noise", "gnss.vertical_correlated_noise",
)  # fmt: skip


def _text(design: Design, key: str) -> str:
    return quantity(key).show(cast("float", design[key]), 3)


def imaged_inputs(design: Design) -> Inputs:
    """The inputs of a design that an aperture can be flown with; every answer about a design asks for them.

    Raises
    ------
    InputError
        If no line of sight is left, the aperture is too long, or the compensation's data come after it.
    """
    x = inputs_of(design)
    _refuse_hidden_target(float(x.squint), float(x.grazing_angle))
    _refuse_long_aperture(float(x.aperture))
    _refuse_late_data(design.motion.delay, float(x.aperture))
    return x


def _refuse_hidden_target(squint: float, grazing: float) -> None:
    if hidden(squint, grazing):
        forward = squint > 0
        most = format_bound(math.copysign(math.pi / 2 - grazing, squint), "°", "angle", low=not forward)
        raise InputError(
            "radar.squint_angle",
            f"{math.degrees(squint):.4g}° leaves no line of sight at a grazing angle of "
            f"{math.degrees(grazing):.4g}°. Enter at {'most' if forward else 'least'} {most}, or a smaller grazing "
            "angle.",
        )


def _refuse_long_aperture(aperture: float) -> None:
    if aperture > LONGEST_APERTURE:
        raise InputError(
            "radar.azimuth_resolution",
            f"This resolution needs an aperture of {aperture:.4g} s at this range and speed. "
            f"At most {LONGEST_APERTURE:g} s are allowed.",
        )


def _refuse_late_data(delay: float, aperture: float) -> None:
    if delay > aperture:
        raise InputError(
            "motion.delay",
            f"{delay:.4g} s is longer than the aperture of {aperture:.4g} s. Enter a shorter delay.",
            delay,
        )
