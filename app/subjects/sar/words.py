"""What the SAR page says in words and tables, as HTML."""

from __future__ import annotations

import math
from html import escape

import numpy as np

from app.document.prose import prose
from app.subjects.sar.charts import short_name
from nav_model.budget import Budget
from nav_model.sar.agreement import agreement, agreement_sentence
from nav_model.sar.decomposition import Band
from nav_model.sar.design_case import flight_cautions, study_cautions
from nav_model.sar.design_study import ClosedForms, SarStudy
from nav_model.sar.geometry import metres_to_phase
from nav_model.sar.strategies import STRATEGIES, Strategy
from nav_model.units import plain_number

_NONE = '<span class="quiet" title="no closed form">—</span>'


def answer(budget: Budget, closed: ClosedForms, study: SarStudy | None, stale: bool) -> str:
    """Which strategy, why, and what would change the answer; then what the runs say."""
    advice = closed.advice
    css, mark = "open", ""
    if closed.required_phase is not None:
        phase = float(metres_to_phase(advice.sigma[advice.strategy], budget.sar.wavelength))
        met = phase <= closed.required_phase
        css, mark = ("good", "✓ meets the limit") if met else ("bad", "✗ misses the limit")
    runs = ""
    if study is not None:
        said = "<span class='stale'>stale: of an earlier design</span> " if stale else ""
        runs = f"<p>{said}{escape(study.sentence)}</p>"
    return (
        f'<div class="strip {css}" role="status"><h2>Strategy {escape(advice.strategy)}</h2>'
        + (f"<p><b>{mark}</b></p>" if mark else "")
        + f"<p>{escape(advice.sentence)}</p><p><b>Why:</b> {escape(advice.because)}</p>"
        f"<p><b>What would change it:</b> {escape(advice.would_change)}</p>{runs}</div>"
    )


def phase_of_a_metre(budget: Budget) -> float:
    """Two-way phase [°] of a metre of line of sight."""
    return math.degrees(float(metres_to_phase(1.0, budget.sar.wavelength)))


def caution_list(budget: Budget, study: SarStudy | None) -> str:
    """What a careful reader must know."""
    flown = flight_cautions(study.budget) if study is not None and study.engine == "simulator" else ()
    items = "".join(f"<li>{prose(sentence)}</li>" for sentence in (*study_cautions(budget), *flown))
    return f'<ul class="cautions quiet" aria-label="Assumptions and cautions">{items}</ul>'


def error_table(budget: Budget, closed: ClosedForms, study: SarStudy | None, stale: bool) -> str:
    """A row a strategy: closed form beside the runs, in millimetres and degrees, and the parts of the residual."""
    own = phase_of_a_metre(budget)
    degrees = own if study is None else phase_of_a_metre(study.budget)
    rows = []
    for index, strategy in enumerate(STRATEGIES):
        name = f"{escape(short_name(strategy.key))}<br><span class='quiet'>{_kind(strategy)}</span>"
        form = closed.detrended.get(strategy.key)
        cells = [_NONE if form is None else f"{_number(1000 * form)} mm<br>{_number(own * form)}°"]
        if study is None:
            cells += ["…"] * 9
        else:
            rms = float(study.rms[index])
            parts = study.parts
            cells += [
                f"{_number(1000 * rms)} mm<br>{_number(degrees * rms)}°",
                _band(parts["residual_rms"], index, 1000, " mm"),
                _band(parts["residual_rms"], index, degrees, "°"),
                _band(parts["detrended_max"], index, 1000, " mm"),
                _band(parts["quadratic"], index, degrees, "°"),
                _band(parts["cubic"], index, degrees, "°"),
                _band(parts["higher_rms"], index, degrees, "°"),
                _band(parts["high_frequency_rms"], index, degrees, "°"),
                _band(study.jump_rms, ..., 1000, " mm") if strategy.key == "4" else "",
            ]
        rows.append((name, cells))
    left = {1: "the line", 2: "the quadratic", 3: "the cubic"}[budget.sar.autofocus_order]
    head = (
        "Closed form, rms", "Runs, rms", "Runs, median", "in phase", "Largest", "Quadratic", "Cubic",
        "Higher orders", "High frequency", "Jumps",
    )  # fmt: skip
    note = f"Rms after {left} is removed; largest after the line; below each median of the runs its 5 to 95 % band."
    return _table("Errors by strategy", note, head, rows, stale)


def response_table(study: SarStudy | None, stale: bool) -> str:
    """A row a strategy: the impulse response, side lobes both ways; medians and 5 to 95 %."""
    rows = []
    for index, strategy in enumerate(STRATEGIES):
        if study is None:
            cells = ["…"] * 8
        elif not math.isfinite(study.responses["width_cells"].median[index]):
            cells = ["no image: smeared", *[""] * 7]
        else:
            r, cell = study.responses, study.budget.sar.cell_length
            width = r["width_cells"]
            cells = [
                f"{_number(float(width.median[index]))} cells<br>{_band(width, index, cell, ' m')}",
                *(
                    _decibels(r[name], index)
                    for name in (
                        "pslr_fixed_db", "pslr_null_db", "islr_fixed_db", "islr_null_db", "islr_fixed_ten_db",
                        "peak_loss_db",
                    )
                ),
                _signed(r["shift_cells"], index),
            ]  # fmt: skip
        rows.append((escape(short_name(strategy.key)), cells))
    head = (
        "Width, −3 dB", "PSLR, fixed", "PSLR, nulls", "ISLR, fixed, whole line",
        "ISLR, nulls, whole line", "ISLR, fixed, ten nulls", "Peak loss", "Shift, cells",
    )  # fmt: skip
    note = (
        "Medians of the runs with their 5 to 95 % bands. Fixed: outside the null-to-null lobe of the error-free "
        "response, where a shoulder counts as a side lobe; nulls: outside the minima found."
    )
    return _table("Impulse response by strategy", note, head, rows, stale)


def agreement_table(study: SarStudy | None, beside: SarStudy | None, stale: bool) -> str:
    """Flights of the simulator beside the fast engine; nothing where there are no flights."""
    if study is None or beside is None:
        return ""
    found = agreement(study, beside)
    degrees = phase_of_a_metre(study.budget)
    rows = [
        (
            escape(short_name(one.key)),
            [
                f"{_number(1000 * one.flown)} mm<br>{_number(degrees * one.flown)}°",
                f"{_number(1000 * one.fast)} mm<br>{_number(degrees * one.fast)}°",
                f"{one.ratio:.3f} ± {one.error:.3f}",
                "<span class='mark'>✓ agrees</span>" if one.agrees else "<span class='mark'>✗ parts</span>",
            ],
        )
        for one in found
    ]
    note = (
        f"{agreement_sentence(found)} Residual after autofocus, rms over {study.runs} flights and over {beside.runs} "
        "runs; ± one standard error of the ratio."
    )
    head = ("Simulator", "Error model", "Ratio", "Within three standard errors")
    return "<br>" + _table("The two engines beside each other", note, head, rows, stale)


def _table(title: str, note: str, head: tuple[str, ...], rows: list[tuple[str, list[str]]], stale: bool) -> str:
    mark = " <span class='stale'>stale: runs are of an earlier design</span>" if stale else ""
    columns = "".join(f'<th scope="col" class="num wrap">{escape(name)}</th>' for name in head)
    body = "".join(
        f"<tr><th scope='row' class='name'>{name}</th>"
        + "".join(f'<td class="num">{cell}</td>' for cell in cells)
        + "</tr>"
        for name, cells in rows
    )
    return (
        f'<h3>{escape(title)}{mark}</h3><p class="know quiet">{escape(note)}</p>'
        f'<div class="scroll" tabindex="0" role="region" aria-label="{escape(title)}">'
        f'<table class="checks"><thead><tr><th scope="col">Strategy</th>{columns}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>"
    )


def _kind(strategy: Strategy) -> str:
    if strategy.key == "1":
        return "reference"
    return strategy.timing + (", reconstruction" if strategy.reconstruction else "")


def _number(value: float) -> str:
    if abs(value) < 1e-9:
        return "0"
    return plain_number(value, 3)


def _band(band: Band, index: object, scale: float, unit: str) -> str:
    median, low, high = (scale * float(np.asarray(part)[index]) for part in (band.median, band.low, band.high))
    return f"{_number(median)}{unit}<br><span class='quiet'>({_number(low)} to {_number(high)})</span>"


def _signed(band: Band, index: int) -> str:
    median, low, high = (float(part[index]) for part in (band.median, band.low, band.high))
    return f"{median:+.2f}<br><span class='quiet'>({low:+.2f} to {high:+.2f})</span>".replace("-", "−")


def _decibels(band: Band, index: int) -> str:
    median, low, high = (float(part[index]) + 0.0 for part in (band.median, band.low, band.high))
    text = f"{median:.2f} dB<br><span class='quiet'>({low:.2f} to {high:.2f})</span>"
    return text.replace("-0.00", "0.00").replace("-", "−")
