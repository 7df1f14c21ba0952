"""A log's results as HTML: coefficients with intervals or the reason why not, warnings, where they come from."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from app.subjects.sensors.charts import TERM_NAMES
from nav_model.allan.adoption import VIBRATION_KEY, WALK_KEYS
from nav_model.allan.motion import BLOCK_S, MOTION_CAVEAT, MotionAnalysis
from nav_model.allan.noise_terms import TERMS
from nav_model.allan.result import UNITS, AxisNoise, Coefficient, LogAnalysis, Provenance, triad_random_walk
from nav_model.catalogue import find
from nav_model.design import Design
from nav_model.design.declaration import BaseQuantity
from nav_model.design.file import preset_of
from nav_model.design.parts import declaration_of
from nav_model.units import format_quantity, plain_number

_TRIADS = {"gyro": "Gyros", "accelerometer": "Accelerometers"}
_DIGITS = 3


def origin_table(design: Design) -> str:
    """Where the noise that the design states comes from: a log, the catalogue, or a hand."""
    rows = "".join(_origin_row(design, key) for key in (*WALK_KEYS.values(), VIBRATION_KEY))
    return _table("Where the design's noise comes from", ("In the design", "Value", "From"), rows, numeric=(1,))


def _origin_row(design: Design, key: str) -> str:
    declaration = declaration_of(key)
    assert isinstance(declaration, BaseQuantity)
    value = design[key]
    assert isinstance(value, float | int)
    unit = design.unit(key) if declaration.dimension else ""
    shown = _number(value, unit, declaration.dimension)
    return (
        f'<tr><th scope="row">{escape(str(declaration.label))}</th><td class="num">{shown}</td>'
        f"<td>{_origin(design, key)}</td></tr>"
    )


def _number(value: float, unit: str, dimension: str) -> str:
    return escape(format_quantity(value, unit, dimension, 4)) if dimension else plain_number(value, 4)


def _origin(design: Design, key: str) -> str:
    if key in design.origins:
        return f'<span class="mark">noted</span>: {escape(design.origins[key])}'
    if key == VIBRATION_KEY:
        return "bench noise; a log in motion says more" if design[key] == 1 else "set by hand"
    preset = preset_of(design, "imu")
    item = find("imu", preset).values.get(key.rpartition(".")[2]) if preset else None
    if item is None or item.value != design[key]:
        return "set by hand"
    doubt = "confirmed" if item.confirmed else f'<span class="mark">⚠ {escape(item.status)}</span>'
    return f"catalogue, {escape(str(preset))}: {doubt}, {escape(item.source)}"


def provenance_line(provenance: Provenance) -> str:
    """File, digest, rate, duration, and how the file was understood."""
    reading = "; ".join(provenance.reading)
    return (
        f"<p><b>{escape(provenance.file_name)}</b>: {provenance.samples} samples at {provenance.rate_hz:g} Hz, "
        f"{_duration(provenance.duration_s)}. Read as: {escape(reading)}.<br>"
        f'<span class="quiet digest">SHA-256 {provenance.sha256}</span></p>'
    )


def _duration(seconds: float) -> str:
    return f"{seconds:.4g} s" if seconds < 600 else f"{seconds:.0f} s ({seconds / 3600:.2f} h)"


def offer_strip(result: LogAnalysis) -> str:
    """What the log offers to the design: one random walk per triad, or why there is none."""
    lines = []
    for quantity, title in (("gyro", "Angle random walk"), ("accelerometer", "Velocity random walk")):
        if not any(axis.quantity == quantity for axis in result.axes):
            continue
        found = triad_random_walk(result, quantity)
        if found is None:
            lines.append(f"<p><b>{title}</b>: not resolved on all three axes, so the log offers none.</p>")
            continue
        unit, scale = UNITS[quantity]["random_walk"]
        lines.append(
            f'<p><b>{title}</b> <span class="num">{_in(found.value, scale)} {unit}</span> '
            f'<span class="num">({_in(found.low, scale)} to {_in(found.high, scale)})</span>, '
            f"{_interval(found)}; {escape(found.method)}</p>"
        )
    return f'<div class="strip open" role="status"><h2>The log says</h2><div>{"".join(lines)}</div></div>'


def _interval(found: Coefficient) -> str:
    return f'<span class="mark">⚠ {escape(found.interval)}</span>' if found.reading else escape(found.interval)


def coefficient_tables(result: LogAnalysis) -> str:
    """A table for each triad: every coefficient of every axis, or the reason why the log does not show it."""
    return "".join(
        _triad_table(title, quantity, axes)
        for quantity, title in _TRIADS.items()
        if (axes := [axis for axis in result.axes if axis.quantity == quantity])
    )


def _triad_table(title: str, quantity: str, axes: list[AxisNoise]) -> str:
    heads = ("Axis", *(f"{TERM_NAMES[term].capitalize()} [{UNITS[quantity][term][0]}]" for term in TERMS))
    rows = "".join(f'<tr><th scope="row">{axis.name[-1]}</th>{_axis_cells(axis)}</tr>' for axis in axes)
    return f"<h3>{title}</h3>" + _table(f"{title}: noise coefficients", heads, rows)


def _axis_cells(axis: AxisNoise) -> str:
    reasons = set(axis.not_resolved.values())
    if len(axis.not_resolved) == len(TERMS) and len(reasons) == 1:
        return f'<td colspan="{len(TERMS)}" class="fine">{escape(reasons.pop())}</td>'
    return "".join(_coefficient_cell(axis, term) for term in TERMS)


def _coefficient_cell(axis: AxisNoise, term: str) -> str:
    found = axis.coefficients[term]
    if found is None:
        return f'<td class="fine">{escape(axis.not_resolved[term])}</td>'
    _, scale = UNITS[axis.quantity][term]
    mark = ""
    if found.reading:
        mark = (
            f'<br><span class="fine">effective reading about 1 s; white floor <b class="num">'
            f'{_in(axis.white_floor, scale)}</b></span><br><span class="mark fine">⚠ {escape(found.interval)}</span>'
        )
    return (
        f'<td><b class="num">{_in(found.value, scale)}</b><br>'
        f'<span class="num quiet">{_in(found.low, scale)} to {_in(found.high, scale)}</span>{mark}</td>'
    )


def remedy_list(result: LogAnalysis) -> str:
    """What log would show the coefficients that this one does not, each said once."""
    found: dict[tuple[str, str], list[str]] = {}
    for axis in result.axes:
        for term, remedy in axis.would_resolve.items():
            found.setdefault((TERM_NAMES[term], remedy), []).append(axis.name)
    by_remedy: dict[tuple[str, tuple[str, ...]], list[str]] = {}
    for (term, remedy), names in found.items():
        by_remedy.setdefault((remedy, tuple(names)), []).append(term)
    items = [
        f"<b>{escape(', '.join(terms))}</b> on {_axes(names, result)}: {escape(remedy)}"
        for (remedy, names), terms in by_remedy.items()
    ]
    return _list("What log would show the rest", items)


def warning_list(result: LogAnalysis) -> str:
    """What to know before trusting the log, each warning with its axes."""
    found: dict[str, list[str]] = {}
    for axis in result.axes:
        for warning in axis.warnings:
            found.setdefault(warning, []).append(axis.name)
    items = [escape(warning) for warning in result.warnings]
    items += [f"<b>{_axes(names, result)}</b>: {escape(warning)}" for warning, names in found.items()]
    return _list("Warnings", items)


def _axes(names: Iterable[str], result: LogAnalysis) -> str:
    chosen = list(names)
    return "all axes" if len(chosen) == len(result.axes) else escape(", ".join(chosen))


def motion_table(result: MotionAnalysis) -> str:
    """Effective noise of a log in motion, the factors over the bench and what they leave out."""
    rows = ""
    for axis in result.axes:
        unit, scale = UNITS[axis.quantity]["random_walk"]
        factor = "" if axis.factor is None else plain_number(axis.factor, _DIGITS)
        rows += (
            f'<tr><th scope="row">{escape(axis.name)}</th><td class="num">{_in(axis.effective, scale)} {unit}</td>'
            f'<td class="num">{_in(axis.typical, scale)} {unit}</td>'
            f'<td class="num">{_in(axis.low, scale)} to {_in(axis.high, scale)}</td>'
            f'<td class="num">{factor}</td></tr>'
        )
    low, high = result.band_hz
    heads = ("Axis", f"Effective, {low:g} to {high:g} Hz", f"Median {BLOCK_S:g} s block", "5 to 95 % of blocks",
             "Over the design's")  # fmt: skip
    return _table("Effective noise in motion", heads, rows, numeric=(1, 2, 3, 4))


def motion_strip(result: MotionAnalysis) -> str:
    """The vibration factor with its qualification."""
    factor = result.vibration_factor
    parts = [
        f"{name} {plain_number(value, _DIGITS)}"
        for name, value in (("gyros", result.gyro_factor), ("accelerometers", result.accelerometer_factor))
        if value is not None
    ]
    said = "No bench noise to compare with" if factor is None else f"Vibration factor {plain_number(factor, _DIGITS)}"
    return (
        f'<div class="strip open" role="status"><h2>{said}</h2>'
        f"<p>{'the larger of ' if len(parts) > 1 else ''}{' and '.join(parts)}, rms over the axes</p>"
        f'<p><span class="mark">⚠ An estimate:</span> {escape(MOTION_CAVEAT)}. '
        "One factor multiplies both random walks, so the larger is pessimistic for the other sensor. Real drives "
        "showed errors 8 to 35 times those bench noise predicts; a factor far above that overstates them.</p></div>"
    )


def _in(value: float, scale: float) -> str:
    return plain_number(value / scale, _DIGITS)


def _table(label: str, heads: Iterable[str], rows: str, numeric: tuple[int, ...] = ()) -> str:
    head = "".join(
        f'<th scope="col"{" class=num" if index in numeric else ""}>{_heading(text)}</th>'
        for index, text in enumerate(heads)
    )
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{escape(label)}"><table class="checks">'
        f"<thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>"
    )


def _heading(text: str) -> str:
    """A heading whose unit is not broken over lines."""
    name, bracket, unit = text.partition(" [")
    return f'{escape(name)} <span class="num quiet">[{escape(unit)}</span>' if bracket else escape(text)


def _list(title: str, items: list[str]) -> str:
    if not items:
        return ""
    return f'<h3>{title}</h3><ul class="cautions">{"".join(f"<li>{item}</li>" for item in items)}</ul>'
