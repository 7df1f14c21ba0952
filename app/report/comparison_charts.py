"""Charts of several budgets side by side, as plain data. Designs go by short labels: names may be long."""

import math
from collections.abc import Sequence

import numpy as np

from app.charts.kinds import Bar, BarChart, Chart, Line
from nav_model.aperture.geometry import phase_to_metres
from nav_model.budget import Budget


def position_comparison(budgets: Sequence[Budget], labels: Sequence[str]) -> Chart:
    """Horizontal position of at most seven budgets against time since the last fix, with all terms."""
    return Chart(
        key="position",
        title="Horizontal position after the last fix",
        x_label="time since the last fix [s]",
        y_label="horizontal position, 1σ [m]",
        lines=tuple(
            Line(label, label, budget.coast.time, budget.coast.refined_horizontal, f"design {i}",
                 "linear covariance propagation [T-17]")
            for i, (budget, label) in enumerate(zip(budgets, labels, strict=True), start=1)
        ),
        y_log=True,
        knowledge="In real time, with Schuler and Coriolis terms [T-17].",
    )  # fmt: skip


def phase_comparison(budgets: Sequence[Budget], labels: Sequence[str]) -> BarChart:
    """Quadratic and detrended phase of some budgets."""

    def bar(budget: Budget, label: str) -> Bar:
        image = budget.smoothed or budget.sar
        phases = np.array([image.quadratic, image.detrended])
        first, second = map(float, np.degrees(phases))
        first_mm, second_mm = map(float, 1000 * phase_to_metres(phases, budget.sar.wavelength))
        marks = "[P-5]" if budget.smoothed else "[S-5], [T-15], [S-6]"
        return Bar(label, first, second, first_mm, second_mm, marks)

    return BarChart(
        key="phase",
        title="Phase over the aperture",
        x_label="line-of-sight phase over the aperture, 1σ [°]",
        first_label="quadratic",
        second_label="detrended phase",
        bars=tuple(bar(budget, label) for budget, label in zip(budgets, labels, strict=True)),
        first_limit=math.nan,
        second_limit=math.nan,
        knowledge="Totals in quadrature, in real time [S-5], [T-15], [S-6], post-processed [P-5]; each with its own "
        "radar, aperture, autofocus and processing.",
    )
