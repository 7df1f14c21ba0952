"""Advice for one design: which strategy to use, why, and what would change the answer."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from nav_model.base.units import plain_number
from nav_model.budget import Budget
from nav_model.budget.contributors import Contributors
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.sar.strategies import NAMES
from nav_model.sar.winners import WORTH, Conditions, break_even_aperture, map_of_winners


@dataclass(frozen=True)
class Advice:
    """Numbers [m, s] and the sentences made of them.

    ``strategy``: the simplest within 5 % of the least, as the map has it; the sentence knows the one in use and the
    limit. ``sigma``: detrended line-of-sight sigma by strategy, infinite where there is none.
    """

    strategy: str
    sentence: str
    because: str
    would_change: str
    sigma: dict[str, float]
    break_even_aperture: float
    break_even_gnss_sigma: float


_DONE = {
    "2": "free INS from the last fix",
    "3": "free INS through the outage and the aperture",
    "5": "subtract the quadratic fitted to INS minus GNSS over the aperture",
    "5w": "subtract the fitted quadratic, weighted by its noise",
    "9": "smooth the trajectory after the flight, with the fixes before, in and after the aperture",
}
_SIMPLEST_FIRST = ("2", "3", "4", "5", "5w", "8", "9", "6", "7")  # reconstructions last
LEFT = {1: "after linear detrend", 2: "after quadratic autofocus", 3: "after cubic autofocus"}
"""Order of the polynomial that an autofocus removes -> what its residual is called."""


def left_by(budget: Budget) -> str:
    """Name of the residual of a design's autofocus."""
    used = budget.design.autofocus
    return f"after {used.method}" if used.works else LEFT[budget.sar.autofocus_order]


class Recommendation(NamedTuple):
    """A strategy, by its key, and the sentence that recommends it."""

    strategy: str
    sentence: str


def strategy_in_use(*, post_processed: bool, outage: bool) -> str:
    """Key of the strategy whose figures the requirements are checked against, the budget's."""
    if post_processed:
        return "9"
    return "3" if outage else "2"


def candidates(*, post_processed: bool, outage: bool) -> tuple[str, ...]:
    """Keys of the strategies that a design can use, the simplest first.

    The whole-leg smoother needs post-processing; without an outage the INS after one is the INS from the filter.
    """
    needed = {"3": outage, "9": post_processed}
    return tuple(key for key in _SIMPLEST_FIRST if needed.get(key, True))


def recommendation(
    phase: Mapping[str, float],
    in_use: str,
    processing: str,
    limit: float | None,
    confidence: float = 1.0,
    *,
    smoothed: float | None = None,
) -> Recommendation:
    """The strategy to use, and one sentence that never names one that fails where another is met.

    Parameters
    ----------
    phase : mapping
        Key of each strategy that the design can use, the simplest first -> its detrended phase [rad] at `confidence`.
    in_use : str
        The strategy whose phase the requirement is checked against.
    processing : str
        Of the design.
    limit : float or None
        On the detrended phase [rad] at `confidence`.
    confidence : float
        Factor on one sigma.
    smoothed : float or None
        Phase of the whole-leg smoother, where a design in real time could be post-processed.

    Returns
    -------
    Recommendation
        The strategy in use unless another is better: the simplest within 5 % of the least, or the least where that
        alone meets the limit, or where none does.
    """
    least = min(phase, key=lambda key: phase[key])
    best = next(key for key in phase if phase[key] <= (1 + WORTH) * phase[least])
    if phase[in_use] <= phase[best]:
        best = in_use
    when = "post-processed" if processing == POST_PROCESSED else "in real time"

    def value(phase: float) -> str:
        return f"{plain_number(math.degrees(phase), 3, zeros=True)}°"

    if limit is None:
        if best == in_use:
            return Recommendation(
                best, f"No strategy is more than 5 % better than {NAMES[best]}, in use: {value(phase[best])}."
            )
        return Recommendation(
            best,
            f"{NAMES[best]} leaves {value(phase[best])} {when}, {NAMES[in_use]}, in use, {value(phase[in_use])}.",
        )
    bound = f"{plain_number(math.degrees(limit), 3)}°" + ("" if confidence == 1 else f" at {confidence:g}σ")
    if phase[in_use] <= limit:
        gain = "" if best == in_use else f" {NAMES[best]} leaves {value(phase[best])}."
        return Recommendation(best, f"{NAMES[in_use]} meets {bound} {when}.{gain}")
    if phase[best] > limit:
        best = least
    if phase[best] <= limit:
        return Recommendation(best, f"{NAMES[best]} meets {bound} {when}: {value(phase[best])}.")
    if value(phase[in_use]) == value(phase[best]):  # of equals, to the digits that are shown, the one in use
        best = in_use
    closest = f"{NAMES[best]}, {'in use, ' * (best == in_use)}{value(phase[best])}"
    later = ""
    if processing != POST_PROCESSED and smoothed is not None and smoothed <= limit:
        later = f" Post-processed, {NAMES['9']} meets it: {value(smoothed)}."
    return Recommendation(best, f"No strategy meets {bound} {when}. Closest: {closest}.{later}")


def advise(
    conditions: Conditions, wavelength: float, required_phase: float | None = None, confidence: float = 1.0
) -> Advice:
    """Advice for one design.

    The fix noise at which 2 and 5 break even is given at the design's state at the last fix (which itself
    depends on that noise, so it is a first estimate and said to be "about"); zero when fewer than three fixes
    lie in the aperture or no noise is low enough.

    Parameters
    ----------
    conditions : Conditions
        The design.
    wavelength : float
        m.
    required_phase : float, optional
        Limit on the detrended phase, rad.
    confidence : float, optional
        Sigmas at which the limit holds and the sentences tell every residual.
    """
    result = map_of_winners(conditions)
    sigma = {key: float(value) for key, value in zip(result.strategies, result.sigma, strict=True)}
    phase = 4 * np.pi / wavelength
    length = {key: _length(confidence * value) for key, value in sigma.items()}
    span, coast = float(np.asarray(conditions.aperture_time)), float(np.asarray(conditions.coast_time))
    post_processed = conditions.post_processed
    fitting = candidates(post_processed=post_processed, outage=coast > 0)
    advised = recommendation(
        {key: phase * confidence * sigma[key] for key in fitting if key in sigma},
        strategy_in_use(post_processed=post_processed, outage=coast > 0),
        POST_PROCESSED if post_processed else REAL_TIME,
        required_phase,
        confidence,
        smoothed=phase * confidence * sigma["9"] if "9" in sigma else None,
    )
    sentence = f"{advised.sentence} {NAMES[advised.strategy]}: {_DONE[advised.strategy]}."
    fitted = np.isfinite(sigma["5"])
    because = f"{NAMES['2']}: {length['2']}"
    because += (
        f"; {NAMES['5']}: {length['5']}; {NAMES['5w']}: {length['5w']}."
        if fitted
        else ". With fewer than three fixes in the aperture there is no quadratic to fit."
    )
    if coast > 0:
        because += f" {NAMES['3']} ({coast:.4g} s without fixes): {length['3']}."
    if "9" in sigma:
        because += f" {NAMES['9']}: {length['9']}."
        if not conditions.post_processed:
            because += " It needs post-processing, so it cannot be chosen while the design is processed in real time."
    break_even = float(break_even_aperture(conditions))
    limit = _break_even_noise(conditions) if fitted else 0.0
    change = ""
    if conditions.autofocus_order > 1:
        change = "Autofocus removes the quadratic under every strategy, so the choice hardly matters here. "
    elif conditions.residual is not None:
        change = "Autofocus removes the quadratic under every strategy within its limits, so the choice among these "
        change += "hardly matters here. "
    change += f"The quadratic fit is worthwhile for apertures longer than about {break_even:.3g} s"
    change += f"; yours is {span:.3g} s."
    if limit > 0:
        change += (
            f" At this aperture it is worthwhile with a position noise below about {_length(limit)}; "
            f"yours is {_length(float(np.asarray(conditions.gnss_sigma)))}."
        )
    return Advice(result.strategies[int(result.winner)], sentence, because, change, sigma, break_even, limit)


def _break_even_noise(conditions: Conditions) -> float:
    """Fix noise [m] at which strategies 2 and 5 are equal, as the fit's noise grows with its square. Zero with
    autofocus. Contributors enter both alike."""
    if conditions.autofocus_order > 1 or conditions.residual is not None:
        return 0.0
    conditions = replace(conditions, contributors=Contributors())
    free, _, fitted, *_ = np.square(map_of_winners(conditions).sigma)
    given = float(np.asarray(conditions.gnss_sigma))
    vertical = conditions.vertical_gnss_sigma
    small = replace(
        conditions,
        gnss_sigma=given * 1e-9,
        vertical_gnss_sigma=None if vertical is None else np.multiply(vertical, 1e-9),
    )
    rest = float(map_of_winners(small).sigma[2]) ** 2
    room = (float(free) - rest) / (float(fitted) - rest)
    return given * float(np.sqrt(max(room, 0.0)))


def spread_of(confidence: float) -> str:
    """Name of a residual at a confidence."""
    return "rms" if confidence == 1 else f"at {confidence:g}σ"


def _length(metres: float) -> str:
    return f"{metres:.3g} m" if metres >= 1 else f"{metres * 1e3:.3g} mm"
