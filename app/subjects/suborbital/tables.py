"""The tables of the suborbital study: the paper's four for these sensors, every source, methods, gravity."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from dataclasses import dataclass
from html import escape

from app.document.prose import prose
from app.subjects.suborbital.charts.shown import Shown, called
from nav_model.constants import ARCSECOND
from nav_model.suborbital.study import Row, table
from nav_model.suborbital.summary import PAPER_FINAL_M

Cell = str | float | None


@dataclass(frozen=True)
class Table:
    """A table as plain data: numbers in the unit of their column's head, None where there is nothing."""

    key: str
    title: str
    heads: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    knowledge: str
    digits: int = 0

    def csv(self) -> str:
        """The table as CSV text, full precision."""
        text = io.StringIO()
        writer = csv.writer(text)
        writer.writerow(self.heads)
        writer.writerows(["" if cell is None else cell for cell in row] for row in self.rows)
        return text.getvalue()

    @property
    def html(self) -> str:
        """The table for `SortableTable`: numbers sort by their size, whatever their sign."""
        head = "".join(
            f'<th scope="col" style="{_NUMBERS if i else _NAMES}"><button>{escape(name)}</button></th>'
            for i, name in enumerate(self.heads)
        )
        body = "".join(
            "<tr>" + "".join(self._cell(i, cell) for i, cell in enumerate(row)) + "</tr>" for row in self.rows
        )
        return (
            f'<h3>{escape(self.title)}</h3><div class="scroll" tabindex="0" role="region" '
            f'aria-label="{escape(self.title)}"><table class="checks"><thead><tr>{head}</tr></thead>'
            f'<tbody>{body}</tbody></table></div><p class="know quiet"><b>How do we know:</b> '
            f"{prose(self.knowledge)}</p>"
        )

    def _cell(self, index: int, cell: Cell) -> str:
        if index == 0:
            return f"<th scope='row'>{escape(str(cell))}</th>"
        if cell is None:
            return "<td class='num quiet' data-sort=''>–</td>"
        text = cell if isinstance(cell, str) else number(cell, self.digits)
        size = "" if isinstance(cell, str) else f" data-sort='{abs(cell)!r}'"
        return f"<td class='num'{size}>{escape(text)}</td>"


_PROMISED = 0.005  # of the exact error: what S p should hold
_NAMES, _NUMBERS = "min-width:150px", "text-align:right;min-width:52px"


def number(value: float, digits: int) -> str:
    """Digits in groups of three, a typeset minus, and no sign on what rounds to zero."""
    return f"{round(value, digits) + 0.0:,.{digits}f}".replace(",", "\u202f").replace("-", "−")


_PAPER_GROUPS: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    ("accelerometers", "Accelerometer errors",
     ("accelerometer bias", "accelerometer instability", "accelerometer total")),
    ("gyros", "Gyro errors", ("gyro bias", "gyro instability", "gyro total")),
    ("initial", "Initial conditions", ("initial position and velocity", "initial attitude")),
)  # fmt: skip
_CHANNELS = ("north", "east", "height")
PAPER_NOTE = (
    "The paper's values are as far as they can be read; its sensors and trajectory are lost and its x and y are not "
    "our north and east: they stand beside ours for comparison only and are never a test."
)


def _heads(*words: str) -> tuple[str, ...]:
    return tuple(f"{word} {channel} [m]" for word in words for channel in _CHANNELS)


_PAPER_HEADS = ("paper x [m]", "paper y [m]", "paper height [m]")


def _paper(name: str) -> tuple[Cell, ...]:
    """The paper's readings, a range where that is all that can be read."""
    found = PAPER_FINAL_M.get(name)
    if found is None:
        return (None, None, None)
    pairs = (found[axis] for axis in ("x", "y", "height"))
    return tuple(float(low) if low == high else f"{low:g} to {high:g}" for low, high in pairs)


def paper_tables(shown: Shown) -> tuple[Table, ...]:
    """The paper's four tables for these sensors: final errors, m, the paper's readings beside them."""
    rows = {row.name: row for row in table(shown.study)}
    how = f"Final errors at {shown.study.flight.time_s[-1]:.0f} s. {shown.how}. {PAPER_NOTE}"
    tables = [
        Table(
            key,
            title,
            ("source", *_heads("INS", "tracker"), *_PAPER_HEADS),
            tuple((name, *rows[name].pure_m, *rows[name].aided_m, *_paper(name)) for name in names),
            how,
        )
        for key, title, names in _PAPER_GROUPS
    ]
    every = rows["all"]
    lines: tuple[tuple[Cell, ...], ...] = (
        ("INS alone", *every.pure_m, None, None, None),
        ("INS with star tracker", *every.aided_m, None, None, None),
        ("improvement in size", *every.improvement_m, *_paper("improvement by the star tracker")),
    )
    heads = ("everything", *(f"{channel} [m]" for channel in _CHANNELS), *_PAPER_HEADS)
    return (*tables, Table("tracker", "INS against star tracker", heads, lines, how))


def source_table(shown: Shown) -> Table:
    """Every case: single sources, classes, tracker and gravity, with down-range and cross-range."""

    def line(row: Row) -> tuple[Cell, ...]:
        return (
            row.name, *row.pure_m, row.pure_down_range_m, row.pure_cross_range_m,
            *row.aided_m, row.aided_down_range_m, row.aided_cross_range_m,
        )  # fmt: skip

    names = (*_CHANNELS, "down-range", "cross-range")
    study = shown.study
    noise: tuple[Cell, ...] = (
        "white noise, 1σ", *map(float, study.pure_noise.position_sigma_m[-1]), None, None,
        *map(float, study.aided_noise.position_sigma_m[-1]), None, None,
    )  # fmt: skip
    gravity = dict(zip(study.names, study.marks, strict=True))["gravity model"]
    return Table(
        "sources",
        "Every error source, one at a time and by class",
        ("source", *(f"INS {n} [m]" for n in names), *(f"tracker {n} [m]" for n in names)),
        (*(line(row) for row in table(study)), noise),
        f"{shown.how}. Gravity row: {gravity}. White noise: covariance of [B-4].",
    )


def gap_table(shown: Shown) -> Table:
    """How far the linear answers are from the integrated ones: S p alone, and the curves sliders move."""
    plain, gap = shown.matrix_gap, shown.gap
    study = shown.survey.study
    rows = [k for k, kind in enumerate(study.kinds) if kind != "gravity"]
    worst = max(rows, key=lambda k: max(plain.pure_share[k], plain.aided_share[k]))
    beyond = [k for k in rows if max(plain.pure_share[k], plain.aided_share[k]) > _PROMISED]
    said = (
        f"within {100 * _PROMISED:g} % on every row"
        if not beyond
        else f"within {100 * _PROMISED:g} % on {len(rows) - len(beyond)} of {len(rows)} rows; "
        f"{called(study.names[worst])} is off by {100 * max(plain.pure_share[worst], plain.aided_share[worst]):.2g} %"
    )
    last = (
        "the last two columns appear once sliders have moved and the study was recomputed"
        if gap is None
        else "the last two columns: the moved curves before this exact run"
    )

    def after(k: int) -> tuple[Cell, Cell]:
        return (None, None) if gap is None else (float(gap.pure_m[k]), float(gap.aided_m[k]))

    return Table(
        "linear",
        "Linear answers against the integrated INS",
        ("source", "S p, INS [m]", "S p, INS [%]", "S p, tracker [m]", "S p, tracker [%]", "moved, INS [m]",
         "moved, tracker [m]"),
        tuple(
            (called(study.names[k]), float(plain.pure_m[k]), float(100 * plain.pure_share[k]),
             float(plain.aided_m[k]), float(100 * plain.aided_share[k]), *after(k))
            for k in rows
        ),
        f"Distance at the end of the flight from the last exact run, and its share of the error. S p alone [B-4] is "
        f"{said}. The page never shows S p alone: its curves start at the exact run and only move by S; {last}.",
        digits=2,
    )  # fmt: skip


def noise_table(shown: Shown) -> Table:
    """White noise at the end: ensemble against prediction."""
    ensemble = shown.ensemble
    heads = ("INS, channel", "predicted 1σ [m]", "ensemble rms [m]", "rms / predicted", "inside 95 %")
    if ensemble is None:
        study = shown.study
        spreads = (("INS alone", study.pure_noise), ("INS with star tracker", study.aided_noise))
        rows: tuple[tuple[Cell, ...], ...] = tuple(
            (f"{ins}, {channel}", float(spread.position_sigma_m[-1, i]), None, None, None)
            for ins, spread in spreads
            for i, channel in enumerate(_CHANNELS)
        )
        said = "No ensemble is flown at these inputs."
    else:
        rows = tuple(
            (f"{ins}, {channel}", sigma, rms, rms / sigma if sigma > 0 else None, "yes" if inside else "no")
            for ins, channel, rms, sigma, inside in ensemble.final
        )
        inside = sum(row[-1] for row in ensemble.final)
        said = (
            f"{ensemble.source}; {ensemble.runs} runs, seed {ensemble.seed}. {inside} of {len(rows)} inside "
            f"{ensemble.low:.2f} to {ensemble.high:.2f}, where each lies with 95 % probability if the prediction is "
            "right: one in twenty falls outside by chance."
        )
    return Table("white-noise", "White noise at the end of the flight", heads, rows, said, digits=2)


def method_table(shown: Shown) -> Table:
    """The five attitude methods on this flight's images."""
    sigma = shown.survey.settings["camera.centroid_noise"] / ARCSECOND
    return Table(
        "methods",
        "Attitude methods compared",
        ("method", "mean error [arcsec]", "rms about x [arcsec]", "rms about y [arcsec]",
         "rms about boresight [arcsec]", "mean NEES (3 expected)"),
        tuple(
            (s.method, s.mean_error_rad / ARCSECOND, *(rms / ARCSECOND for rms in s.axis_rms_rad), s.mean_nees)
            for s in shown.survey.scores
        ),
        f"The same images of this flight for all five, one a second, centroid noise {sigma:.3g} arcsec per axis; "
        f"{shown.survey.scenes_refused} refused by the gate. Covariances [B-9]. TRIAD takes the two brightest stars: "
        "where these happen to stand close together its error is large, so its mean hangs on few scenes. Over 1000 "
        "random scenes of five stars at 10 arcsec that mean is about 240 arcsec, but from 207 to 362 over twenty "
        "seeds, where the optimal methods stay within 72 to 78.",
        digits=2,
    )  # fmt: skip


def gravity_table(shown: Shown) -> Table:
    """What a wrong gravity model costs an otherwise perfect INS."""
    return Table(
        "gravity-mismatch",
        "Cost of a mismatched gravity model",
        ("truth / INS", *(f"{channel} [m]" for channel in _CHANNELS)),
        tuple((f"{truth} / {model}", *map(float, error)) for truth, model, error in shown.survey.gravity),
        "Final error of an INS without any other error, the golden flight flown in each true field; integrated [B-3]."
        if shown.survey.gravity
        else "Not run for a trajectory from a file: it is flown in one field only.",
        digits=1,
    )


def star_table(shown: Shown) -> Table:
    """The stars of the image looked at."""
    frame = shown.star_frame
    real = shown.survey.settings["sky.stars"] == "Hipparcos"
    return Table(
        "stars",
        f"Identified stars at {frame.time_s:.0f} s",
        ("star", "Hp magnitude", "x [pixel]", "y [pixel]", "x measured [pixel]", "y measured [pixel]"),
        tuple(
            (f"{'HIP ' if real else ''}{number}", *map(float, numbers))
            for number, *numbers in zip(
                frame.identifier, frame.magnitude, frame.pixel_x, frame.pixel_y, frame.measured_x, frame.measured_y,
                strict=True,
            )
        ),
        _attitude_said(frame.error_rad, frame.sigma_rad, frame.source, frame.reason),
        digits=2,
    )  # fmt: skip


def _attitude_said(error: object, sigma: object, source: str, reason: str) -> str:
    if error is None or sigma is None:
        return f"Frame not used: {reason}. {source}."
    numbers: Callable[[object], str] = lambda v: ", ".join(f"{x / ARCSECOND:.1f}" for x in v)  # type: ignore[attr-defined]  # noqa: E731
    return (
        f"Attitude error about body x, y, boresight: {numbers(error)} arcsec; predicted 1σ {numbers(sigma)} arcsec "
        f"[B-9]. {source}."
    )
