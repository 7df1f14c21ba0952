"""Results of a log as blocks: coefficients with intervals or the reason why not, warnings, provenance."""

from collections.abc import Iterable

from app.document.blocks import Answer, Bullets, Cell, CellLike, Column, Row, TableBlock, Text, numbers, table
from app.document.numbers import NONE, number
from app.document.wording import input_in_words, printable
from app.subjects.sensors.charts import TERM_NAMES
from nav_model.allan.adoption import DRIFTS, VIBRATION_KEY, WALK_KEYS
from nav_model.allan.motion import MOTION_CAVEAT, MotionAnalysis
from nav_model.allan.noise_terms import TERMS
from nav_model.allan.result import (
    UNITS,
    AxisNoise,
    Coefficient,
    LogAnalysis,
    LogSource,
    axis_label,
    triad_coefficient,
)
from nav_model.allan.vibration import BLOCK_S
from nav_model.design import Design
from nav_model.design.parts import declaration_of
from nav_model.design.presets import entry_of

_TRIADS = {"gyro": "Gyros", "accelerometer": "Accelerometers"}


def origin_answer(design: Design) -> Answer:
    """Where the noise comes from, in a line: a log, the catalogue, or typed."""
    sentences = []
    for key in (*WALK_KEYS.values(), VIBRATION_KEY):
        label, value, source = _origin_row(design, key)
        mark = f" {source.mark}" if source.tone == "warn" else ""
        origin = source.text.partition(":")[0]
        sentences.append(f"{label} {value}: {origin}{mark}.")
    return Answer("Sensor noise", "open", tuple(sentences))


def _origin_row(design: Design, key: str) -> tuple[str, str, Cell]:
    value = design[key]
    assert isinstance(value, float | int)
    return str(declaration_of(key).label), input_in_words(design, key, value), _origin(design, key)


def _origin(design: Design, key: str) -> Cell:
    if key in design.origins:
        return Cell(printable(design.origins[key]))
    if key == VIBRATION_KEY:
        return Cell("bench value; a log in motion gives a better one" if design[key] == 1 else "set by hand")
    entry = entry_of(design, "imu")
    item = entry.values.get(key.rpartition(".")[2]) if entry else None
    if entry is None or item is None or item.value != design[key]:
        return Cell("set by hand")
    text = f"catalogue, {entry.name}: {item.source}"
    return Cell(text) if item.confirmed else Cell(text, f"⚠ {item.status} source", "warn")


def reading_text(provenance: LogSource) -> Text:
    """File, rate, duration, and how the file was understood."""
    return Text(
        f"{provenance.file_name}: {provenance.samples} samples at {number(provenance.rate_hz, 6, given=True)} Hz, "
        f"{_duration(provenance.duration_s)}. Read as: {'; '.join(provenance.reading)}."
    )


def _duration(seconds: float) -> str:
    return (
        f"{number(seconds, 4, given=True)} s"
        if seconds < 600
        else f"{seconds:.0f} s ({number(seconds / 3600, given=True)} h)"
    )


def offer(result: LogAnalysis) -> Answer:
    """Offer of the log to the design: one random walk per triad, or why there is none; drifts that it shows."""
    lines = []
    for quantity, title in (("gyro", "Angle random walk"), ("accelerometer", "Velocity random walk")):
        if not any(axis.quantity == quantity for axis in result.axes):
            continue
        walk = triad_coefficient(result, quantity)
        if walk is None:
            unresolved = (axis.not_resolved.get("random_walk") for axis in result.axes if axis.quantity == quantity)
            why = next(filter(None, unresolved), "not resolved on all three axes")
            lines.append(f"{title}: {why}, so there is no value to use.")
            continue
        unit, scale = UNITS[quantity]["random_walk"]
        lines.append(
            f"{title}: {number(walk.value / scale)} {unit} ({_range(walk, scale)}), {_interval(walk)}; {walk.method}."
        )
        for term in DRIFTS:
            if (drift := triad_coefficient(result, quantity, term)) is not None:
                unit, scale = UNITS[quantity][term]
                value = f"{number(drift.value / scale)} {unit} ({_range(drift, scale)})"
                lines.append(f"{TERM_NAMES[term].capitalize()} of the {quantity}s: {value}, {_interval(drift)}.")
    return Answer("Result", "open", tuple(lines))


def _interval(walk: Coefficient) -> str:
    return f"⚠ {walk.interval}" if walk.reading else walk.interval


def _range(walk: Coefficient, scale: float) -> str:
    return f"{number(walk.low / scale)} to {number(walk.high / scale)}"


def coefficient_tables(result: LogAnalysis) -> tuple[TableBlock, ...]:
    """A table for each triad: every coefficient of every axis, or the reason why the log does not show it."""
    return tuple(
        _triad_table(title, quantity, axes)
        for quantity, title in _TRIADS.items()
        if (axes := [axis for axis in result.axes if axis.quantity == quantity])
    )


def _triad_table(title: str, quantity: str, axes: list[AxisNoise]) -> TableBlock:
    heads = (f"{TERM_NAMES[term].capitalize()} [{UNITS[quantity][term][0]}]" for term in TERMS)
    return table(
        f"log-{quantity}",
        f"{title}: noise coefficients",
        ("Axis", *(Column(head, width=1) for head in heads)),
        ((axis.name[-1], *_axis_cells(axis)) for axis in axes),
        "< = 95 % upper bound, term not resolved.",
    )


def _axis_cells(axis: AxisNoise) -> Row:
    reasons = set(axis.not_resolved.values())
    if len(axis.not_resolved) == len(TERMS) and len(reasons) == 1:  # said once for the axis
        return Cell(reasons.pop(), tone="quiet"), *(NONE for _ in TERMS[1:])
    return tuple(_coefficient_cell(axis, term) for term in TERMS)


def _coefficient_cell(axis: AxisNoise, term: str) -> CellLike:
    coefficient = axis.coefficients[term]
    _, scale = UNITS[axis.quantity][term]
    if term in axis.at_most:
        return Cell(f"< {number(axis.at_most[term] / scale)}", tone="quiet")
    if coefficient is None:
        return Cell(axis.not_resolved[term], tone="quiet")
    text = f"{number(coefficient.value / scale)}\n({_range(coefficient, scale)})"
    if not coefficient.reading:
        return text
    floor = number(axis.white_floor / scale)
    return Cell(f"{text}\nread at 1 s; white-noise floor {floor}", f"⚠ {coefficient.interval}", "warn")


def remedies(result: LogAnalysis) -> tuple[Bullets, ...]:
    """Logs that would resolve the coefficients that this one does not, each once."""
    axes: dict[tuple[str, str], list[str]] = {}
    for axis in result.axes:
        for term, remedy in axis.would_resolve.items():
            axes.setdefault((TERM_NAMES[term], remedy), []).append(axis.name)
    by_remedy: dict[tuple[str, tuple[str, ...]], list[str]] = {}
    for (term, remedy), names in axes.items():
        by_remedy.setdefault((remedy, tuple(names)), []).append(term)
    items = (
        f"{', '.join(terms)} on {_axes(names, result)}: {remedy}" for (remedy, names), terms in by_remedy.items()
    )
    return _list("Which log would resolve the rest", items)


def warnings(result: LogAnalysis) -> tuple[Bullets, ...]:
    """Warnings about the log, each with its axes."""
    axes: dict[str, list[str]] = {}
    for axis in result.axes:
        for warning in axis.warnings:
            axes.setdefault(warning, []).append(axis.name)
    by_axis = (f"{_axes(names, result)}: {warning}" for warning, names in axes.items())
    return _list("Warnings", (*result.warnings, *by_axis))


def _axes(names: Iterable[str], result: LogAnalysis) -> str:
    chosen = list(names)
    return "all axes" if len(chosen) == len(result.axes) else ", ".join(map(axis_label, chosen))


def _list(title: str, items: Iterable[str]) -> tuple[Bullets, ...]:
    lines = tuple(items)
    return (Bullets(lines, title),) if lines else ()


def motion_answer(result: MotionAnalysis) -> Answer:
    """The vibration factor with its qualification."""
    factor = result.vibration_factor
    parts = [
        f"{name} {number(value)}"
        for name, value in (("gyros", result.gyro_factor), ("accelerometers", result.accelerometer_factor))
        if value is not None
    ]
    which = f"{'The larger of ' if len(parts) > 1 else ''}{' and '.join(parts)}, rms over the axes."
    return Answer(
        "No bench noise to compare with" if factor is None else f"Vibration factor {number(factor)}",
        "open",
        (
            *((which[:1].upper() + which[1:],) if parts else ()),
            f"⚠ An estimate: {MOTION_CAVEAT}. One factor multiplies both random walks, so the larger is pessimistic "
            "for the other sensor. In road tests, errors were 8 to 35 times those that bench noise predicts; a "
            "factor far above that overstates them.",
        ),
    )


def motion_table(result: MotionAnalysis) -> TableBlock:
    """Effective noise of a log in motion, the factors over the bench and what they leave out."""
    low, high = result.band_hz
    heads = (f"Effective, {low:g} to {high:g} Hz", f"Median {BLOCK_S:g} s block", "5 to 95 % of blocks",
             "Over the design's")  # fmt: skip
    rows = []
    for axis in result.axes:
        unit, scale = UNITS[axis.quantity]["random_walk"]
        effective, typical = (f"{number(value / scale)} {unit}" for value in (axis.effective, axis.typical))
        blocks = f"{number(axis.low / scale)} to {number(axis.high / scale)}"
        factor = NONE if axis.factor is None else number(axis.factor)
        rows.append((axis_label(axis.name), effective, typical, blocks, factor))
    return table("log-motion", "Effective noise in motion", ("Axis", *numbers(*heads)), rows)
