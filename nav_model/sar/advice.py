"""Advice for one design: which strategy to use, why, and what would change the answer."""

from dataclasses import dataclass, replace

import numpy as np

from nav_model.budget.contributors import Contributors
from nav_model.sar.strategies import NAMES
from nav_model.sar.winners import Conditions, break_even_aperture, map_of_winners


@dataclass(frozen=True)
class Advice:
    """Numbers [m, s] and the sentences made of them.

    ``sigma``: detrended line-of-sight sigma by strategy, infinite where there is none.
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
_NEEDS = "It needs post-processing: the image is made after the flight, with the fixes of the leg after the aperture."
LEFT = {1: "after linear detrend", 2: "after quadratic autofocus", 3: "after cubic autofocus"}
"""Order of the autofocus -> what its residual is called."""


def advise(
    conditions: Conditions, wavelength: float, required_phase: float | None = None, confidence: float = 1.0
) -> Advice:
    """Advice for one design. ``required_phase`` [rad]: limit on the detrended phase, at the ``confidence`` at which
    the sentences tell every residual.

    The fix noise at which 2 and 5 break even is given at the design's state at the last fix (which itself
    depends on that noise, so it is a first estimate and said to be "about"); zero when fewer than three fixes
    lie in the aperture or no noise is low enough.
    """
    result = map_of_winners(conditions)
    sigma = {key: float(value) for key, value in zip(result.strategies, result.sigma, strict=True)}
    chosen = result.strategies[int(result.winner)]
    phase, spread = 4 * np.pi / wavelength, spread_of(confidence)
    length = {key: _length(confidence * value) for key, value in sigma.items()}
    span, coast = float(np.asarray(conditions.aperture_time)), float(np.asarray(conditions.coast_time))
    sentence = (
        f"Use {NAMES[chosen]}: {_DONE[chosen]}. The residual is {length[chosen]} {spread} "
        f"({np.degrees(phase * confidence * sigma[chosen]):.3g}° of phase) {LEFT[conditions.autofocus_order]}."
    )
    if chosen == "9":
        sentence += f" {_NEEDS}"
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
    change += f"The quadratic fit is worthwhile for apertures longer than about {break_even:.3g} s"
    change += f"; yours is {span:.3g} s."
    if limit > 0:
        change += (
            f" At this aperture it is worthwhile with a position noise below about {_length(limit)}; "
            f"yours is {_length(float(np.asarray(conditions.gnss_sigma)))}."
        )
    if required_phase is not None:
        ratio = phase * confidence * sigma[chosen] / required_phase
        verdict = "meets" if ratio <= 1 else "misses"
        change += (
            f" {NAMES[chosen]} {verdict} the limit of {np.degrees(required_phase):.3g}° "
            f"by a factor of {max(ratio, 1 / ratio):.3g}."
        )
        if "9" in sigma and chosen != "9":
            smoothed = phase * confidence * sigma["9"] / required_phase
            met = "would meet" if smoothed <= 1 else "would miss"
            change += f" Post-processed, {NAMES['9']} {met} it by a factor of {max(smoothed, 1 / smoothed):.3g}."
    return Advice(chosen, sentence, because, change, sigma, break_even, limit)


def _break_even_noise(conditions: Conditions) -> float:
    """Fix noise [m] at which strategies 2 and 5 are equal, as the fit's noise grows with its square. Zero with
    autofocus. Contributors enter both alike."""
    if conditions.autofocus_order > 1:
        return 0.0
    conditions = replace(conditions, contributors=Contributors())
    free, _, fitted, *_ = np.square(map_of_winners(conditions).sigma)
    given = float(np.asarray(conditions.gnss_sigma))
    upright = conditions.vertical_gnss_sigma
    small = replace(
        conditions,
        gnss_sigma=given * 1e-9,
        vertical_gnss_sigma=None if upright is None else np.multiply(upright, 1e-9),
    )
    rest = float(map_of_winners(small).sigma[2]) ** 2
    room = (float(free) - rest) / (float(fitted) - rest)
    return given * float(np.sqrt(max(room, 0.0)))


def spread_of(confidence: float) -> str:
    """What a residual at a confidence is called."""
    return "rms" if confidence == 1 else f"at {confidence:g}σ"


def _length(metres: float) -> str:
    return f"{metres:.3g} m" if metres >= 1 else f"{metres * 1e3:.3g} mm"
