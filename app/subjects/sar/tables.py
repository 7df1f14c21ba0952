"""The tables of the strategies: errors in degrees and millimetres, their parts, the impulse responses."""

from __future__ import annotations

import math

import numpy as np

from app.document.blocks import Cell, Column, Table
from app.subjects.sar.charts import short_name
from nav_model.sar.agreement import agreement, agreement_sentence
from nav_model.sar.decomposition import Band
from nav_model.sar.design_study import SarStudy
from nav_model.sar.geometry import metres_to_phase
from nav_model.sar.strategies import STRATEGIES, Strategy
from nav_model.units import plain_number

_LEFT = {1: "the line", 2: "the quadratic", 3: "the cubic"}
_WHAT = {"fast": "runs of the error model", "simulator": "flights of the simulator"}
_BANDS = "Medians of the runs, in brackets their 5 to 95 % band."
_FIXED = (
    "Fixed: outside the null-to-null lobe of the error-free response, where a shoulder counts as a side lobe; nulls: "
    "outside the minima found."
)


def error_table(study: SarStudy, key: str) -> Table:
    """A row a strategy: closed form beside the runs, in millimetres and in degrees."""
    degrees = _degrees(study)
    rows = []
    for index, strategy in enumerate(STRATEGIES):
        form = study.closed.detrended.get(strategy.key)
        rms = float(study.rms[index])
        closed = ("–", "–") if form is None else (_number(1000 * form), _number(degrees * form))
        band = study.parts["residual_rms"]
        rows.append(
            (
                Cell(short_name(strategy.key)),
                Cell(_kind(strategy)),
                *map(Cell, closed),
                Cell(_number(1000 * rms)),
                Cell(_number(degrees * rms)),
                Cell(_banded(band, index, 1000)),
                Cell(_banded(band, index, degrees)),
            )
        )
    left = _LEFT[study.budget.sar.autofocus_order]
    return Table(
        f"{key}-sar-errors",
        f"Line-of-sight error by strategy, rms over the aperture after {left} is removed",
        (
            Column("Strategy", width=1.75),
            Column("Kind", width=1.3),
            Column("Closed form [mm]", numeric=True, width=0.8),
            Column("[°]", numeric=True, width=0.75),
            Column("Runs, rms [mm]", numeric=True, width=0.8),
            Column("[°]", numeric=True, width=0.75),
            Column("Runs, median [mm]", numeric=True, width=1.3),
            Column("[°]", numeric=True, width=1.3),
        ),
        tuple(rows),
        f"{study.runs} {_WHAT[study.engine]}, seed {study.seed}. {_BANDS} Closed forms [T-15], [T-16], "
        "[S-6], [S-7] with [S-1], [S-2], from the filter just after a fix [T-8]; degrees are two-way phase [T-13].",
    )


def parts_table(study: SarStudy, key: str) -> Table:
    """What each residual is made of, in degrees; the largest in millimetres; the jumps of the raw filter."""
    degrees = _degrees(study)
    parts = study.parts
    jumps = _banded(study.jump_rms, ..., 1000)
    return Table(
        f"{key}-sar-parts",
        "What the error of each strategy is made of",
        (
            Column("Strategy", width=1.5),
            *(
                Column(title, numeric=True, width=1)
                for title in ("Largest after the line [mm]", "Quadratic [°]", "Cubic [°]", "Higher orders [°]",
                              "High frequency [°]")
            ),
        ),
        tuple(
            (
                Cell(short_name(strategy.key)),
                Cell(_banded(parts["detrended_max"], index, 1000)),
                *(
                    Cell(_banded(parts[name], index, degrees))
                    for name in ("quadratic", "cubic", "higher_rms", "high_frequency_rms")
                ),
            )
            for index, strategy in enumerate(STRATEGIES)
        ),
        f"{_BANDS} Quadratic and cubic: coefficients at the aperture's ends, before autofocus [S-5], [S-6]; the "
        f"others rms [T-14]. The raw filter (4) jumps at the fixes by {jumps} mm rms.",
    )  # fmt: skip


def agreement_table(study: SarStudy, beside: SarStudy, key: str) -> Table:
    """Flights of the simulator beside the error model: the two engines, strategy by strategy."""
    found = agreement(study, beside)
    degrees = _degrees(study)
    rows = tuple(
        (
            Cell(short_name(one.key)),
            Cell(_number(1000 * one.flown)),
            Cell(_number(degrees * one.flown)),
            Cell(_number(1000 * one.fast)),
            Cell(_number(degrees * one.fast)),
            Cell(f"{one.ratio:.3f} ± {one.error:.3f}"),
            Cell("✓ agrees", tone="good") if one.agrees else Cell("✗ parts", tone="warn"),
        )
        for one in found
    )
    titles = ("Simulator [mm]", "[°]", "Error model [mm]", "[°]", "Ratio")
    columns = (*(Column(title, numeric=True, width=1) for title in titles), Column("Within three errors", width=1))
    return Table(
        f"{key}-sar-engines",
        "The two engines beside each other",
        (Column("Strategy", width=1.5), *columns),
        rows,
        f"{agreement_sentence(found)} Residual after autofocus, rms over {study.runs} flights and over {beside.runs} "
        "runs; ± one standard error of the ratio.",
    )


def response_tables(study: SarStudy, key: str) -> tuple[Table, Table]:
    """The impulse response of each strategy: lobe, then side lobes integrated, both ways."""
    cell = study.budget.sar.cell_length
    r = study.responses

    def row(index: int, strategy: Strategy, cells: tuple[str, ...]) -> tuple[Cell, ...]:
        if not math.isfinite(float(r["width_cells"].median[index])):
            cells = ("no image: smeared", *("–" for _ in cells[1:]))
        return (Cell(short_name(strategy.key)), *map(Cell, cells))

    lobe = tuple(
        row(index, strategy, (
            _banded(r["width_cells"], index, 1.0), _banded(r["width_cells"], index, cell),
            _decibels(r["pslr_fixed_db"], index), _decibels(r["pslr_null_db"], index),
            _decibels(r["peak_loss_db"], index),
        ))
        for index, strategy in enumerate(STRATEGIES)
    )  # fmt: skip
    integrated = tuple(
        row(index, strategy, (
            _decibels(r["islr_fixed_db"], index), _decibels(r["islr_null_db"], index),
            _decibels(r["islr_fixed_ten_db"], index), _shift(r["shift_cells"], index),
        ))
        for index, strategy in enumerate(STRATEGIES)
    )  # fmt: skip

    def columns(*titles: str) -> tuple[Column, ...]:
        return (Column("Strategy", width=1.5), *(Column(title, numeric=True, width=1) for title in titles))

    return (
        Table(
            f"{key}-sar-lobe",
            "Azimuth impulse response by strategy: width, peak side lobe, peak loss",
            columns("Width [cells]", "Width [m]", "PSLR, fixed [dB]", "PSLR, nulls [dB]", "Peak loss [dB]"),
            lobe,
            f"{_BANDS} Width at −3 dB, {study.budget.sar.window} window, cell {_number(cell)} m [S-3]. {_FIXED}",
        ),
        Table(
            f"{key}-sar-islr",
            "Azimuth impulse response by strategy: integrated side lobes, shift",
            columns("ISLR, fixed [dB]", "ISLR, nulls [dB]", "ISLR, fixed, ten nulls [dB]", "Shift [cells]"),
            integrated,
            f"{_BANDS} Over the whole line unless said otherwise. {_FIXED}",
        ),
    )


def _degrees(study: SarStudy) -> float:
    """Two-way phase [°] of a metre of line of sight."""
    return math.degrees(float(metres_to_phase(1.0, study.budget.sar.wavelength)))


def _kind(strategy: Strategy) -> str:
    if strategy.key == "1":
        return "reference"
    return strategy.timing + (", reconstruction" if strategy.reconstruction else "")


def _number(value: float) -> str:
    return "0" if abs(value) < 1e-9 else plain_number(value, 3).replace("-", "−")


def _of(band: Band, index: object) -> tuple[float, float, float]:
    median, low, high = (float(np.asarray(part)[index]) for part in (band.median, band.low, band.high))  # type: ignore[index]
    return median, low, high


def _banded(band: Band, index: object, scale: float) -> str:
    return _bracketed(*(_number(scale * value) for value in _of(band, index)))


def _decibels(band: Band, index: int) -> str:
    return _bracketed(*(f"{round(value, 2) + 0.0:.2f}".replace("-", "−") for value in _of(band, index)))


def _shift(band: Band, index: int) -> str:
    return _bracketed(*(f"{round(value, 2) + 0.0:+.2f}".replace("-", "−") for value in _of(band, index)))


def _bracketed(median: str, low: str, high: str) -> str:
    """Median and band; the band stays in one piece where a cell breaks."""
    if low == median == high:
        return median
    return f"{median} ({low}\u00a0to\u00a0{high})"
