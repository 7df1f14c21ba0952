"""The charts of a budget, as plain data: phase by source, point target, regime; `BUDGET_CHARTS` has all of them."""

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from app.charts.kinds import TOTAL, Array, Bar, BarChart, Chart, Line, Points
from app.document.numbers import decibels, number, percent, show
from app.document.wording import DETRENDED
from app.subjects.budget.tables import PARTS, by_tilt
from app.subjects.budget.timelines import DEGREES, attitude_chart, limit_at_sigma, position_chart, velocity_chart
from nav_model.analytic import regime
from nav_model.aperture.geometry import phase_to_metres
from nav_model.aperture.impulse_response import MINIMUM_SAMPLES, aperture_positions, response_curve
from nav_model.aperture.polynomial_response import polynomial_curve
from nav_model.budget import Budget
from nav_model.budget.fast import scattered_floor
from nav_model.design import figures

Parts = tuple[tuple[str, float], ...]

_RESPONSE_CELLS = 6.0  # shown on each side of the target
_GIVEN = "given in the design"


def phase_chart(budget: Budget) -> BarChart:
    """The phase of the design's processing by source, its total, and the parts of that along the line of sight of
    mid-aperture and along the track."""
    sar, post_processed = budget.sar, budget.post_processed
    given = {each.name for each in budget.design.contributors}

    def bar(label: str, quadratic: float, detrended: float, source: str, parts: Parts = ()) -> Bar:
        quadratic, detrended = quadratic or math.nan, detrended or math.nan  # what does not enter has no bar
        first, second = map(float, 1000 * phase_to_metres(np.array([quadratic, detrended]), sar.wavelength))
        limited = label == TOTAL
        return Bar(label, quadratic * DEGREES, detrended * DEGREES, first, second, source, limited, parts)

    def of_image(label: str, prefix: str = "", parts: Parts = ()) -> Bar:
        both = [budget.figure(f"{prefix}{name}") for name in (figures.QUADRATIC, figures.DETRENDED)]
        marks = ", ".join(dict.fromkeys(figure.mark for figure in both))
        return bar(label, both[0].sigma, both[1].sigma, marks, parts)

    residual = DETRENDED[sar.autofocus_order]
    removed = f"Quadratic phase before autofocus; detrended phase: rms over the aperture after {residual}."
    if budget.design.autofocus.works:
        removed = (
            f"Both after autofocus ({budget.design.autofocus.method}) [S-9], with its error of estimation [S-10]."
        )
    if not post_processed:
        mark, by = "[S-8]", _by_mechanism(budget)
        slow = " Tilt from the augmented filter [T-8]." if budget.design.gnss.correlated else ""
        knowledge = (
            f"Formulas along the line of sight as it turns [S-8]; of mid-aperture [S-5], [T-15], [S-6]; along-track "
            f"[S-2]. {removed}{by_tilt(budget)}{slow}"
        )
    else:
        mark, by = "[P-4], [P-5]", ()
        knowledge = f"Smoothed with every fix [P-3]; shares [P-4]; over the aperture [P-5]. {removed}"
    return BarChart(
        key="phase",
        title="SAR phase error by source",
        x_label="phase over the aperture, 1σ [°]",
        first_label="quadratic phase",
        second_label="detrended phase",
        bars=(
            *(
                bar(line.source, line.quadratic, line.detrended, _GIVEN if line.source in given else mark)
                for line in budget.phase_lines(budget.processing)
            ),
            of_image(TOTAL),
            of_image(PARTS["line_of_sight"], "line_of_sight_", by),
            of_image(PARTS["along_track"], "along_track_"),
        ),
        first_limit=limit_at_sigma(budget, figures.QUADRATIC, DEGREES),
        second_limit=limit_at_sigma(budget, figures.DETRENDED, DEGREES),
        knowledge=knowledge,
    )


def _by_mechanism(budget: Budget) -> Parts:
    """Shares in the quadratic phase along the line of sight of mid-aperture, the largest first."""
    shares = ((line.source, line.share) for line in budget.sight_lines() if line.share)
    return tuple(sorted(shares, key=lambda part: -part[1]))


@cache
def _regime_curves() -> tuple[Array, Array, Array]:
    return regime.curves(1e-2, 1e5, 200)


def regime_chart(budget: Budget) -> Chart:
    """Horizontal over vertical position variance against gyro dominance, with the design and the catalogue."""
    kappa, exact, asymptote = _regime_curves()
    here, height = regime.design_point(budget.design)
    names, kappas, ratios = regime.catalogue_points(budget.design)
    velocity = budget.design.gnss.velocity_noise is not None
    source, alone = ("formula [P-6]", ", position fixes alone") if velocity else ("formula [T-6]", "")
    return Chart(
        key="regime",
        title="What limits horizontal position: gyro or accelerometer",
        x_label="gyro dominance κ [1]",
        y_label="variance, horizontal / vertical [1]",
        lines=(
            Line("exact", f"exact, u⁴ = 1 + κu{alone}", kappa, exact, "exact", "formula [T-6]"),
            Line("asymptote", f"gyro-dominated, κ^(1/3){alone}", kappa, asymptote, "asymptote", "formula [T-7]"),
        ),
        points=(
            Points("catalogue", "catalogue with this GNSS", kappas, ratios, names, "reference", "circle",
                   source),
            Points("design", "this design", np.array([here]), np.array([height]), ("this design",),
                   "this design", "cross", source),
        ),
        x_log=True,
        y_log=True,
        knowledge=_regime_knowledge(here, height, velocity=velocity),
    )  # fmt: skip


def _regime_knowledge(kappa: float, ratio: float, *, velocity: bool) -> str:
    """Sentence on what rules the horizontal channel; with velocity fixes gyro dominance alone does not say it."""
    if velocity:
        return (
            f"Real time: κ = {number(kappa)}; with this design's velocity fixes the variance ratio is "
            f"{number(ratio)} [P-6]. The curves [T-6], [T-7] are for position fixes alone."
        )
    rule = (
        "gyro noise limits the horizontal channel" if kappa > 10 else
        "accelerometer noise limits it; gyro noise has little effect on position" if kappa < 0.1 else
        "both matter"
    )  # fmt: skip
    off = percent(abs(float(regime.asymptote_error(kappa))))
    return f"Real time: κ = {number(kappa)}: {rule}; the asymptote is {off} off here [T-6], [T-7]."


@cache
def _ideal_response(window: str) -> tuple[Array, Array]:
    """Cells from the target, and the power [dB] there of an aperture without error."""
    cells, power = polynomial_curve(0.0, 0.0, window, _RESPONSE_CELLS)  # type: ignore[arg-type]
    return cells, power[0]


def response_chart(budget: Budget) -> Chart:
    """Azimuth impulse response: without error, with the 1σ quadratic error, with this and cubic."""
    sar, random = budget.sar, budget.spectral.random
    response = budget.response(budget.processing)
    width = ""
    measures = "No image: more than 1000 rad of quadratic phase."
    if response is not None:
        width = f"width {show(float(response.half_power_extent_cells) * sar.cell_length, 'length')}"
        measures = (
            f"With 1σ quadratic error, {budget.verdict.processing}: {width} "
            f"({number(float(response.half_power_extent_cells))} cells), "
            f"PSLR {decibels(float(response.pslr_fixed_db))}, "
            f"ISLR {decibels(float(response.islr_fixed_db))} (outside the error-free main lobe, whole line), "
            f"peak loss {decibels(-float(response.peak_loss_db))}."
        )
    echoes = " With the paired echoes [P-9]." if budget.spectral.echoes else ""
    floor = " The floor is the mean power scattered by random motion and the oscillator [P-11]." if random > 0 else ""
    knowledge = f"{measures} Before autofocus.{echoes}{floor}"
    return replace(response_curves(budget), knowledge=knowledge, aside=width)


def response_curves(budget: Budget) -> Chart:
    """Impulse response without the measures of its side lobes: what a slider moves."""
    sar, focused = budget.sar, budget.half_power_extent is not None
    cells, ideal = _ideal_response(sar.window)
    cells, spread = _spread(budget) if focused else (cells, np.full((2, len(cells)), np.nan))
    metres = cells * sar.cell_length
    return Chart(
        key="response",
        title=f"Point target in azimuth{'' if focused else ', not focused'}",
        x_label="azimuth [m]",
        y_label="power [dB]",
        lines=tuple(
            Line(key, label, metres, np.where(np.isfinite(values), values, np.nan), style, "aperture integral [S-5]")
            for key, label, values, style in (  # an exact null has no logarithm
                ("ideal", "no error", ideal, "reference"),
                ("quadratic", "with 1σ quadratic error", spread[0], "quadratic"),
                ("cubic", "with quadratic and cubic", spread[1], "with cubic"),
            )
        ),
        y_range=(-45.0, 2.0),
    )


def with_compared(chart: Chart, other: Budget | None) -> Chart:
    """Response curves with the quadratic one of another design, NaN without one."""
    x = y = np.full(1, np.nan)
    if other is not None:
        line = next(line for line in response_curves(other).lines if line.key == "quadratic")
        x, y = line.x.copy(), line.y
    return replace(chart, lines=(*chart.lines, Line("compared", "compared", x, y, "compared", "aperture integral")))


def _spread(budget: Budget) -> tuple[Array, Array]:
    """Cells from the target, and the power [dB] there with the quadratic and with the cubic too."""
    sar, spectral = budget.sar, budget.spectral
    quadratic, cubic = (budget.figure(name).sigma for name in (figures.QUADRATIC, figures.CUBIC))
    window: Any = sar.window
    if not spectral.echoes:
        cells, power = polynomial_curve(quadratic, cubic, window, _RESPONSE_CELLS)
    else:
        x = aperture_positions(MINIMUM_SAMPLES)
        phase = quadratic * x**2 + spectral.phase(x, sar.aperture_time)
        phases = np.stack((phase, phase + cubic * x**3))
        cells, power = response_curve(np.exp(1j * phases), window, _RESPONSE_CELLS)
    if spectral.random > 0:
        floor = scattered_floor(budget.design, cells, sar.wavelength, sar.aperture_time, spectral.random)
        power = 10 * np.log10(10 ** (power / 10) * math.exp(-spectral.random) + floor)
    return cells, power


BUDGET_CHARTS = (position_chart, velocity_chart, attitude_chart, phase_chart, response_chart, regime_chart)
"""Every chart of the Budget page, in the order of the page and of the report."""
