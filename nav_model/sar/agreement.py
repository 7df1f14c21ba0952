"""Agreement of the two engines: full flights of the simulator and the per-axis error model."""

from typing import NamedTuple

import numpy as np

from nav_model.sar.design_study import SarStudy
from nav_model.sar.strategies import NAMES, STRATEGIES

LEAST_BESIDE = 200
"""Runs of the fast engine, at least, that stand beside flights of the simulator."""

_ALLOWED = 3.0  # standard errors


class Agreement(NamedTuple):
    """One strategy's residual, rms over the runs [m], by both engines.

    ``ratio``: flown over fast, ``error`` its standard error from the runs of both.
    """

    key: str
    flown: float
    fast: float
    ratio: float
    error: float

    @property
    def agrees(self) -> bool:
        """Within three standard errors."""
        return abs(self.ratio - 1) <= _ALLOWED * self.error


def agreement(flown: SarStudy, fast: SarStudy) -> tuple[Agreement, ...]:
    """Every strategy but the ideal; both studies of the same design."""
    found = []
    for index, strategy in enumerate(STRATEGIES[1:], start=1):
        one, other = float(flown.rms[index]), float(fast.rms[index])
        ratio = one / other
        error = ratio * float(np.hypot(flown.rms_error[index] / one, fast.rms_error[index] / other))
        found.append(Agreement(strategy.key, one, other, ratio, error))
    return tuple(found)


def agreement_sentence(found: tuple[Agreement, ...]) -> str:
    """Whether the engines agree, and where they differ."""
    apart = [one for one in found if not one.agrees]
    if not apart:
        worst = max(found, key=lambda one: abs(one.ratio - 1) / one.error)
        return (
            "Both engines agree within three standard errors for every strategy. The largest difference is "
            f"{100 * (worst.ratio - 1):+.1f} % (standard error {100 * worst.error:.1f} %), for {NAMES[worst.key]}."
        ).replace("-", "−")
    named = "; ".join(f"{NAMES[one.key]} {100 * (one.ratio - 1):+.0f} % ± {100 * one.error:.0f} %" for one in apart)
    return (
        f"The engines differ by more than three standard errors for {len(apart)} of {len(found)} strategies "
        f"(simulator over error model): {named}. The cautions list what only the simulator includes."
    ).replace("-", "−")
