"""The strategies as blocks: which to use and why, their errors and parts, the impulse responses.

Closed forms follow the current budget; results of runs use the wavelength of their study. Where there are no
runs yet, their cells say so.
"""

from __future__ import annotations

import math
from types import EllipsisType

import numpy as np

from app.charts.kinds import DotChart
from app.document.blocks import Answer, Block, Bullets, Cell, Column, Table, Text
from app.document.numbers import NONE, hundredths, number
from app.document.ranks_html import ranks_html
from nav_model.aperture.geometry import metres_to_phase
from nav_model.budget import Budget
from nav_model.design.processing import REAL_TIME
from nav_model.sar.advice import LEFT
from nav_model.sar.agreement import agreement, agreement_sentence
from nav_model.sar.decomposition import Band
from nav_model.sar.design_case import flight_cautions, study_cautions
from nav_model.sar.design_study import ClosedForms, SarStudy
from nav_model.sar.strategies import NAMES, STRATEGIES, Strategy

_NOT_RUN = "…"
_ENGINES = {"fast": "runs of the error model", "simulator": "flights of the simulator"}
_BANDS = "Median of the runs, 5 to 95 % in brackets."
_SIDE_LOBES = (
    "Fixed: outside the null-to-null lobe of the error-free response, where a shoulder counts as a side lobe. Nulls: "
    "outside the minima found."
)


def answer(budget: Budget, closed: ClosedForms, study: SarStudy | None) -> tuple[Answer, tuple[Block, ...]]:
    """Which strategy to use and whether it meets the limit; then why, and what would change the answer.

    Of the runs where there are some, otherwise of the formulas.
    """
    advice = closed.advice
    if study is None:
        key, sigma, smoothed = advice.strategy, advice.sigma[advice.strategy], advice.sigma["9"]
        note = "The formulas cover some of the strategies; the runs cover all."
    else:
        best, now = study.best(), study.best(causal=True)
        key, sigma, smoothed, note = best.key, study.residual(best.key), study.residual("9"), ""
        if now.key != key:
            note = f"Best in real time: {now.name}, {_degrees(study.residual(now.key), budget)}°."
    if key == "9":
        note = f"It needs post-processing. {note}"
    elif budget.design.processing.mode == REAL_TIME:
        note = f"{note} Post-processed, {NAMES['9']}: {_degrees(smoothed, budget)}°."
    word, tone, limit = f"Use {NAMES[key]}", "open", ""
    if closed.required_phase is not None:
        met = float(metres_to_phase(sigma, budget.sar.wavelength)) <= closed.required_phase
        word, tone = (f"✓ {word}", "good") if met else (f"✗ {NAMES[key]} is best, but misses the limit", "bad")
        limit = f"; the limit is {number(math.degrees(closed.required_phase), given=True)}°"
    source = "by formula" if study is None else f"in {study.runs} runs"
    said = f"It leaves {_degrees(sigma, budget)}° rms of phase {LEFT[budget.sar.autofocus_order]}, {source}{limit}."
    runs = () if study is None else (Text(f"By the runs: {study.sentence}"),)
    return Answer(word, tone, (said, note.strip()) if note else (said,)), (
        *runs,
        Text(advice.sentence),
        Text(f"Why: {advice.because}"),
        Text(f"What would change it: {advice.would_change}"),
    )


def ranking(chart: DotChart, best: str) -> str:
    """The strategies in their order as HTML; ``best`` names the one to use."""
    return ranks_html(chart, {strategy.name: _kind(strategy) for strategy in STRATEGIES}, best)


def _degrees(sigma: float, budget: Budget) -> str:
    return number(math.degrees(float(metres_to_phase(sigma, budget.sar.wavelength))))


def runs_in_words(study: SarStudy) -> str:
    """Which runs, and how many."""
    return f"{study.runs} {_ENGINES[study.engine]}, seed {study.seed}"


def cautions(budget: Budget, study: SarStudy | None) -> Bullets:
    """What a careful reader must know."""
    flown = flight_cautions(study.budget) if study is not None and study.engine == "simulator" else ()
    return Bullets((*study_cautions(budget), *flown), "Assumptions and cautions")


def error_table(budget: Budget, closed: ClosedForms, study: SarStudy | None, key: str) -> Table:
    """One row per strategy: closed form and runs, in millimetres and in degrees."""
    rows = []
    for index, strategy in enumerate(STRATEGIES):
        form = closed.detrended.get(strategy.key)
        cells = [NONE, NONE] if form is None else [_number(scale * form) for scale in _scales(budget)]
        if study is None:
            cells += [_NOT_RUN] * 4
        else:
            cells += [_number(scale * float(study.rms[index])) for scale in _scales(study.budget)]
            cells += [_banded(study.parts["residual_rms"], index, scale) for scale in _scales(study.budget)]
        rows.append((Cell(strategy.name), Cell(_kind(strategy)), *map(Cell, cells)))
    runs = "" if study is None else f"{runs_in_words(study)}. {_BANDS} "
    return Table(
        f"{key}-sar-errors",
        f"Line-of-sight error by strategy, rms over the aperture {LEFT[budget.sar.autofocus_order]}",
        (
            Column("Strategy", width=1.75),
            Column("Kind", width=1.3),
            *(
                Column(unit, numeric=True, width=width, group=group)
                for group, widths in (
                    ("Formula", (0.8, 0.75)), ("Runs, rms", (0.8, 0.75)), ("Runs, median", (1.3, 1.3)),
                )
                for unit, width in zip(("[mm]", "[°]"), widths, strict=True)
            ),
        ),
        tuple(rows),
        f"{runs}Formulas [T-15], [T-16], [S-6], [S-7] with [S-1], [S-2], from the filter just after a fix [T-8]; "
        f"{NAMES['9']} [P-3], [P-5]. Degrees are two-way phase [T-13].",
    )  # fmt: skip


def run_tables(study: SarStudy, beside: SarStudy | None, key: str) -> tuple[Table, ...]:
    """Measures of the runs: parts of the error, impulse responses, and a comparison of the engines."""
    engines = () if beside is None else (_agreement_table(study, beside, key),)
    return (_parts_table(study, key), *_response_tables(study, key), *engines)


def _parts_table(study: SarStudy, key: str) -> Table:
    """Parts of each residual in degrees; the largest residual in millimetres; the jumps of the filter."""
    millimetres, degrees = _scales(study.budget)
    parts = (
        ("Largest residual [mm]", "detrended_max", millimetres), ("Quadratic [°]", "quadratic", degrees),
        ("Cubic [°]", "cubic", degrees), ("Higher orders [°]", "higher_rms", degrees),
        ("High frequency [°]", "high_frequency_rms", degrees),
    )  # fmt: skip
    return _by_strategy(
        f"{key}-sar-parts",
        "Parts of the error by strategy",
        tuple(title for title, *_ in parts),
        [
            tuple(_banded(study.parts[name], index, scale) for _, name, scale in parts)
            for index in range(len(STRATEGIES))
        ],
        f"{_BANDS} Quadratic and cubic: coefficients at the aperture's ends, before autofocus [S-5], [S-6]. Others: "
        f"rms [T-14]. {NAMES['4']} jumps at the fixes by {_banded(study.jump_rms, ..., millimetres)} mm rms.",
    )


def _response_tables(study: SarStudy, key: str) -> tuple[Table, Table]:
    """The impulse response of each strategy: lobe, then side lobes integrated, both ways."""
    cell, r = study.budget.sar.cell_length, study.responses

    def response(index: int, *cells: str) -> tuple[str, ...]:
        if math.isfinite(float(r["width_cells"].median[index])):
            return cells
        return ("not focused", *(NONE for _ in cells[1:]))

    def to_hundredths(index: int, *names: str) -> tuple[str, ...]:
        return tuple(_bracketed(*map(hundredths, _of(r[name], index))) for name in names)

    lobe, integrated = [], []
    for index in range(len(STRATEGIES)):
        widths = (_banded(r["width_cells"], index, scale) for scale in (1.0, cell))
        peaks = to_hundredths(index, "pslr_fixed_db", "pslr_null_db", "peak_loss_db")
        lobe.append(response(index, *widths, *peaks))
        ratios = to_hundredths(index, "islr_fixed_db", "islr_null_db", "islr_fixed_ten_db")
        shift = _bracketed(*(hundredths(value, sign="+") for value in _of(r["shift_cells"], index)))
        integrated.append(response(index, *ratios, shift))
    return (
        _by_strategy(
            f"{key}-sar-lobe",
            "Azimuth impulse response by strategy: width, peak side lobe, peak loss",
            ("Width [cells]", "Width [m]", "PSLR, fixed [dB]", "PSLR, nulls [dB]", "Peak loss [dB]"),
            lobe,
            f"{_BANDS} Width at −3 dB, {study.budget.sar.window} window, cell {number(cell)} m [S-3]. PSLR: peak "
            f"side lobe ratio. {_SIDE_LOBES}",
        ),
        _by_strategy(
            f"{key}-sar-islr",
            "Azimuth impulse response by strategy: integrated side lobes, shift",
            ("ISLR, fixed [dB]", "ISLR, nulls [dB]", "ISLR, fixed, ten nulls [dB]", "Shift [cells]"),
            integrated,
            f"{_BANDS} ISLR: integrated side lobe ratio, over the whole line unless said otherwise. {_SIDE_LOBES}",
        ),
    )


def _agreement_table(study: SarStudy, beside: SarStudy, key: str) -> Table:
    """Flights of the simulator beside the error model: the two engines, strategy by strategy."""
    found = agreement(study, beside)
    scales = _scales(study.budget)
    rows = tuple(
        (
            Cell(NAMES[one.key]),
            *(Cell(_number(scale * sigma)) for sigma in (one.flown, one.fast) for scale in scales),
            Cell(f"{number(one.ratio, 4)} ± {number(one.error, 2)}"),
            Cell("✓ agrees", tone="good") if one.agrees else Cell("✗ differs", tone="warn"),
        )
        for one in found
    )
    return Table(
        f"{key}-sar-engines",
        "Simulator and error model compared",
        (
            Column("Strategy", width=1.5),
            *(
                Column(unit, numeric=True, width=1, group=group)
                for group in ("Simulator", "Error model") for unit in ("[mm]", "[°]")
            ),
            Column("Ratio", numeric=True, width=1),
            Column("Within three standard errors", width=1),
        ),
        rows,
        f"{agreement_sentence(found)} Residual after autofocus, rms over {study.runs} flights and over {beside.runs} "
        "runs; ± one standard error of the ratio.",
    )  # fmt: skip


def _by_strategy(key: str, caption: str, titles: tuple[str, ...], rows: list[tuple[str, ...]], note: str) -> Table:
    named = zip(STRATEGIES, rows, strict=True)
    return Table(
        key,
        caption,
        (Column("Strategy", width=1.5), *(Column(title, numeric=True, width=1) for title in titles)),
        tuple((Cell(strategy.name), *map(Cell, cells)) for strategy, cells in named),
        note,
    )


def _scales(budget: Budget) -> tuple[float, float]:
    """Millimetres, and degrees of two-way phase, of a metre of line of sight."""
    return 1000.0, math.degrees(float(metres_to_phase(1.0, budget.sar.wavelength)))


def _kind(strategy: Strategy) -> str:
    if strategy.key == "1":
        return "reference"
    return strategy.timing + (", reconstruction" if strategy.reconstruction else "")


def _number(value: float) -> str:
    return "0" if abs(value) < 1e-9 else number(value)  # of the ideal, rounding of the transform is left


def _of(band: Band, index: int | EllipsisType) -> tuple[float, float, float]:
    median, low, high = (float(np.asarray(part)[index]) for part in (band.median, band.low, band.high))
    return median, low, high


def _banded(band: Band, index: int | EllipsisType, scale: float) -> str:
    return _bracketed(*(_number(scale * value) for value in _of(band, index)))


def _bracketed(median: str, low: str, high: str) -> str:
    """Median and band; the band stays in one piece where a cell breaks."""
    if low == median == high:
        return median
    return f"{median} ({low}\u00a0to\u00a0{high})"
