"""A flown flight as blocks: figures by line, time and place, jumps, and the receiver."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from app.document.blocks import Block, Bullets, Cell, Row, TableBlock, Text, numbers, table
from app.document.flown import range_of, value_of, whole
from app.document.numbers import NONE, number, show
from app.subjects.flown.charts import IN_APERTURES, lines_of
from app.subjects.flown.run import FlownFlight
from nav_model.base.text.csv_text import csv_text
from nav_model.base.units import clock
from nav_model.design.figures import FIGURES

if TYPE_CHECKING:
    from nav_model.flown.relation import Fitted
    from nav_model.flown.result import Measured

_MARKS = {"met": ("✓ met", "good"), "not met": ("✗ not met", "bad"), "open": ("open", "warn")}
_SHOWN = (
    "horizontal_position", "vertical_position", "horizontal_velocity", "vertical_velocity", "tilt", "heading",
    "detrended_phase", "quadratic_phase", "ce90",
)  # fmt: skip
_PARTS = {"white": "White noise", "slow": "Slow error", "time": "Correlation time"}
_UNITS = {"imu": "IMU", "gnss": "Receiver"}
_MOST_JUMPS = 50


def main_figure(flight: FlownFlight) -> str:
    """The figure to show by aperture first: the one that decides, else one that is limited."""
    decisive = flight.result.decisive
    if decisive is not None and decisive[1] in IN_APERTURES:
        return decisive[1]
    limited = {name for line in lines_of(flight) for name, one in line.figures.items() if one.limit is not None}
    return next((name for name in IN_APERTURES if name in limited), IN_APERTURES[0])


def line_table(flight: FlownFlight, key: str = "flown") -> TableBlock:
    """Each line: its figures with limit, what was flown with its band, and the verdicts."""
    result = flight.result
    rows: list[Row] = []
    for line in result.lines:
        start, stop = (clock(at - flight.start_s) for at in (line.start_s, line.stop_s))
        left_out = line.apertures_left_out
        words = f"; {left_out} aperture{'' if left_out == 1 else 's'} left out" if left_out else ""
        rows.append((f"{line.name}: {start} to {stop} min{words}",))
        limited = sorted(line.figures, key=lambda name: line.figures[name].limit is None)
        rows += [
            _row(name, line.figures[name])
            for name in limited
            if line.figures[name].limit is not None or (name in _SHOWN and math.isfinite(line.figures[name].flown))
        ]
    return table(
        f"{key}-lines",
        f"Figures by line, at {flight.design.requirements.confidence:g}σ, with their 95 % bands",
        ("Quantity", "Verdict", *numbers("Flown", "Budget", "Freedom")),
        rows,
        "Consistent: the budget lies in the band, else how many times it was flown, of navigation alone. Freedom: "
        "degrees of freedom of the mean square which give the band [P-18]. Times are from "
        "the start of the solution.",
    )


def _row(name: str, one: Measured) -> Row:
    mark, tone = _MARKS.get(one.verdict, (one.verdict or NONE, "quiet"))
    against = f"{number(one.ratio)} × it" if one.against_budget in ("more", "less") else one.against_budget
    flown = NONE if math.isnan(one.flown) else value_of(name, one.flown)
    if one.freedom > 0.0:
        flown = f"{flown}\n{range_of(name, one.low_95, one.high_95)}"
    return (
        FIGURES[name].label if one.limit is None else f"{FIGURES[name].label}\nlimit {value_of(name, one.limit)}",
        Cell(mark, tone=tone, more=one.reason),
        flown,
        "\n".join(filter(None, (value_of(name, one.budget), against))),
        NONE if not one.freedom else number(one.freedom, 2),
    )


def claims_table(flight: FlownFlight, key: str = "flown") -> TableBlock:
    """Claims of the file for each line, beside budget and limit."""
    rows: list[Row] = []
    for line, figures in flight.result.claims.items():
        rows.append((line,))
        for name, one in figures.items():
            met = one.claimed_to_be_met
            says = NONE if met is None else "claimed to be met" if met else "claimed not to be met"
            limit = NONE if one.limit is None else value_of(name, one.limit)
            rows.append((FIGURES[name].label, value_of(name, one.claimed), value_of(name, one.budget), limit, says))
    return table(
        f"{key}-claims",
        f"Claimed by the file, at {flight.design.requirements.confidence:g}σ",
        ("Quantity", *numbers("Claimed", "Budget", "Limit"), "Says"),
        rows,
        "A claim is no error: it gives no verdict.",
    )


def flight_blocks(flight: FlownFlight, key: str = "flown") -> tuple[Block, ...]:
    """The figures by line where two solutions show any, and the claims where there are any; else why."""
    blocks: list[Block] = []
    if flight.result.lines:
        blocks.append(line_table(flight, key))
    if flight.result.claims:
        blocks.append(claims_table(flight, key))
    return tuple(blocks) or (Text(whole(flight.result.reason)),)


def place_blocks(flight: FlownFlight, key: str = "flown") -> tuple[Block, ...]:
    """Time and place: the files, lag, lever arm and offset with their sigmas, and what was noted."""
    result, rows = flight.result, list[Row]()
    compared = result.compared
    if compared is not None:
        rows.append(_fitted("Lag of the solution", compared.lag, "time"))
        for name, arm in zip(("forward", "right", "down"), compared.lever_arm or (), strict=False):
            rows.append(_fitted(f"Lever arm {name}", arm, "length"))
        for name, offset in zip(("north", "east", "down"), compared.offset, strict=True):
            rows.append(_fitted(f"Offset {name}", offset, "length"))
    nees = result.nees
    remarks = [compared.remark] if compared is not None and compared.remark else []
    notes = [whole(note) for note in (*remarks, *result.notes)]
    if nees:
        notes.append(
            f"Claims of both: mean square {number(nees['mean'])}, 95 % band {number(nees['low_95'])} to "
            f"{number(nees['high_95'])}; {number(nees['factor'])} times their sigmas would be true."
        )
    sources = tuple(f"{one.name}, SHA-256 {one.sha256}" for one in flight.sources)
    blocks: list[Block] = []
    if rows:
        blocks.append(
            table(
                f"{key}-place",
                "Fitted between the two solutions",
                ("Quantity", *numbers("Value", "Sigma"), "In the difference"),
                rows,
            )
        )
    return (*blocks, Bullets(tuple(notes), "Remarks"), Bullets(sources, "Files"))


def _fitted(name: str, one: Fitted, dimension: str) -> Row:
    return (
        name,
        show(one.value, dimension),
        show(one.sigma, dimension, like=one.value),
        "taken off" if one.removed else "left in",
    )


def jump_block(flight: FlownFlight, key: str = "flown") -> Block:
    """The jumps, the largest where there are many."""
    jumps = flight.result.jumps
    if not jumps:
        return Text(
            "No jumps, no gaps and no changes of the kind of fix."
            if flight.result.compared
            else "Not looked for without a second solution."
        )
    largest = sorted(jumps, key=lambda jump: -jump.size_m)[:_MOST_JUMPS]
    return table(
        f"{key}-jumps",
        f"Jumps: {len(jumps)}" + (f", the {_MOST_JUMPS} largest" if len(jumps) > _MOST_JUMPS else ""),
        ("Time", *numbers("Size"), "Cause"),
        [
            (f"{clock(jump.time_s - flight.start_s)} min", show(jump.size_m, "length"), jump.cause)
            for jump in sorted(largest, key=lambda jump: jump.time_s)
        ],
        "Apertures that touch one are left out.",
    )


def noise_blocks(flight: FlownFlight, key: str = "flown") -> tuple[Block, ...]:
    """Noise of IMU and receiver over that of their design, where the lines tell."""
    rows = [
        (_UNITS.get(name, name), number(one.value), f"{number(one.low_95)} to {number(one.high_95)}")
        for name, one in flight.result.noise.items()
    ]
    if not rows:
        return ()
    return (
        table(
            f"{key}-noise",
            "Noise on the lines, over that of the design",
            ("Unit", *numbers("Times as noisy", "95 % interval")),
            rows,
            "As its design has it: 1 [P-19].",
        ),
    )


def receiver_block(flight: FlownFlight, key: str = "flown") -> Block:
    """The receiver's noise as it was seen, beside what the design declares."""
    receiver = flight.result.receiver
    rows = [
        (f"{label}, {axis}", *_estimate(one, "time" if part == "time" else "length"))
        for axis in ("horizontal", "vertical")
        for part, label in _PARTS.items()
        if (one := (receiver.get(axis) or {}).get(part))
    ]
    if velocity := receiver.get("velocity"):
        rows.append(("White noise, velocity", *_estimate(velocity, "speed")))
    if not rows:
        why = receiver.get("reason") or (
            "a receiver shows in fixes alone, a solution without an attitude, beside a reference"
        )
        return Text(f"Not told: {why}.")
    reason = receiver.get("reason", "")
    return table(
        f"{key}-receiver",
        "The receiver, 1σ",
        ("Noise", *numbers("Declared", "Seen", "95 % interval")),
        rows,
        f"Not told: {reason}." if reason else "",
    )


def _estimate(one: Mapping[str, Any], dimension: str) -> tuple[str, ...]:
    declared = one["declared"]
    known = declared is not None and math.isfinite(declared) and declared > 0.0
    like = one["value"]
    low, high = (show(one[end], dimension, like=like) for end in ("low_95", "high_95"))
    return show(declared, dimension, like=like) if known else NONE, show(like, dimension), f"{low} to {high}"


def as_csv(flight: FlownFlight) -> str:
    """Every figure of every line in SI; an empty cell where there is nothing to tell."""
    head = (
        "line", "start_s", "stop_s", "figure", "limit", "budget", "flown", "low_95", "high_95", "freedom",
        "apertures", "verdict", "against_budget", "ratio", "reason",
    )  # fmt: skip
    rows = [
        (line["name"], line["start_s"], line["stop_s"], name, *(_cell(one[column]) for column in head[4:]))
        for line in flight.data["lines"]
        for name, one in line["figures"].items()
    ]
    return csv_text([head, *rows])


def _cell(value: Any) -> Any:
    return "" if value is None or (isinstance(value, float) and not math.isfinite(value)) else value
