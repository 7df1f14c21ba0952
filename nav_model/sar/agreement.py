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
    agreements = []
    for index, strategy in enumerate(STRATEGIES[1:], start=1):
        flown_rms, fast_rms = float(flown.rms[index]), float(fast.rms[index])
        ratio = flown_rms / fast_rms
        error = ratio * float(np.hypot(flown.rms_error[index] / flown_rms, fast.rms_error[index] / fast_rms))
        agreements.append(Agreement(strategy.key, flown_rms, fast_rms, ratio, error))
    return tuple(agreements)


def agreement_sentence(agreements: tuple[Agreement, ...]) -> str:
    """A sentence on whether the engines agree, and where they differ."""
    different = [row for row in agreements if not row.agrees]
    if not different:
        worst = max(agreements, key=lambda row: abs(row.ratio - 1) / row.error)
        return (
            "Both engines agree within three standard errors for every strategy. The largest difference is "
            f"{100 * (worst.ratio - 1):+.1f} % (standard error {100 * worst.error:.1f} %), for {NAMES[worst.key]}."
        ).replace("-", "−")
    named = "; ".join(
        f"{NAMES[row.key]} {100 * (row.ratio - 1):+.0f} % ± {100 * row.error:.0f} %" for row in different
    )
    return (
        f"The engines differ by more than three standard errors for {len(different)} of {len(agreements)} strategies "
        f"(simulator over error model): {named}. The cautions list what only the simulator includes."
    ).replace("-", "−")
