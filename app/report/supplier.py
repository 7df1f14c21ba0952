"""The sheet for a supplier: required values, how each is verified, and a log's outcome line by line."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from importlib.metadata import version
from typing import Any, cast

from app.document.blocks import (
    Answer,
    Approval,
    Bullets,
    Cell,
    Chapter,
    Report,
    Row,
    Section,
    TableBlock,
    Text,
    numbers,
    table,
)
from app.document.html import to_html
from app.document.wording import input_in_words, printable, shortened, title_of
from nav_model.allan.result import axis_label
from nav_model.base.errors import under
from nav_model.design import Design
from nav_model.design.declaration import in_sentence
from nav_model.design.figures import RESPONSE
from nav_model.design.parts import declaration_of
from nav_model.design.user_entries import Allotment
from nav_model.equations.literature import WORKS
from nav_model.explore.margins import value_of
from nav_model.explore.supplier import (
    AVERAGING,
    CONFIDENCE,
    Acceptance,
    RequiredInput,
    Unit,
    accepted_share,
    degrees_of,
    exceeding,
    required,
)

NAMES: dict[Unit, str] = {"imu": "IMU", "gnss": "satellite receiver"}

_HOUR = 3600.0
_FIXES = 1000
_SOURCES: dict[Unit, tuple[str, ...]] = {
    "imu": tuple(WORKS[name] for name in ("IEEE 952", "Riley 2008", "Greenhall 2003")),
    "gnss": (WORKS["ISO 17123-8"], WORKS["JCGM 100"]),
}


def supplier_report(design: Design, unit: Unit) -> Report:
    """The sheet of one unit.

    Raises
    ------
    InputError
        As `nav_model.explore.supplier.required`.
    """
    now = datetime.now(UTC)
    lines = required(design, unit)
    degrees = degrees_of(_HOUR, design.imu.rate) if unit == "imu" else _FIXES - 1.0  # of freedom, of the test
    values = _values(design, unit, lines, accepted_share(degrees)), Bullets(_conditions(design, unit))
    proof = Text(_proof(design, unit)), Text(_decision(unit, degrees))
    title = f"{NAMES[unit][:1].upper()}{NAMES[unit][1:]} requirements for {title_of(design)}"
    chapter = Chapter(
        key=unit,
        kind="Requirement sheet",
        title=title,
        running=f"{shortened(title)} · {design.content_hash[:12]}",
        facts=(
            ("Design", design.content_hash[:12]),
            ("Written", f"{now:%d %B %Y, %H:%M} UTC"),
            ("Program", f"NavBudget {version('navbudget')}"),
        ),
        sections=(
            Section(f"{unit}-values", "Required values", values),
            Section(f"{unit}-proof", "How each is verified", proof),
            Section("approval", "Approval", (Approval(("Prepared", "Checked", "Approved"), (title,)),)),
            Section(f"{unit}-sources", "Sources", (Bullets(_SOURCES[unit]),)),
        ),
    )  # fmt: skip
    return Report(title, now.isoformat(timespec="seconds"), version("navbudget"), (chapter,), ())


def supplier_bytes(design: Design, unit: Unit) -> bytes:
    """The sheet of one unit as an HTML file.

    Raises
    ------
    InputError
        Where values cannot be required, with the reason.
    """
    with under(f"No requirement sheet for the {NAMES[unit]}"):
        return to_html(supplier_report(design, unit)).encode()


def _values(design: Design, unit: Unit, lines: Sequence[RequiredInput], share: float) -> TableBlock:
    """Required values; the reading that is accepted is so large a share of each."""
    note = f"An accepted reading in this test proves the value with {100 * CONFIDENCE:.0f} % confidence. Noise: 1σ."
    if design.allocation and (others := [printable(c.name) for c in design.limits if c.on in RESPONSE]):
        note += f" Not allocated, so not in these values: limits on the impulse response ({', '.join(others)})."
    if over := exceeding(design):
        note += f" Over their part in this design: {', '.join(map(printable, over))}."
    if bounded := [in_sentence(declaration_of(line.key).label) for line in lines if line.bounded]:
        note += f" At the bound of the input, as no limit asks for less: {', '.join(bounded)}."
    rows = (
        (
            str(declaration_of(line.key).label),
            *(input_in_words(design, line.key, value) for value in (line.value, share * line.value, line.current)),
        )
        for line in lines
    )
    return table(
        f"{unit}-required",
        _meaning(design.allocation),
        (("Quantity", 1.4), *numbers("At most", "Accepted reading", "Assumed so far", width=1)),
        rows,
        note,
    )


def _meaning(plan: Allotment | None) -> str:
    """Meaning of the required values, in words."""
    if plan is not None and plan.required:
        return f"Largest values of all units together, frozen with design {plan.frozen}"
    if plan is not None:
        return (
            "Largest values within the design's allocation: all at once meet each allocated limit less its reserve, "
            "as long as every other source keeps to its part"
        )
    return "Largest values, IMU and receiver together, that meet every limit; every other input as assumed"


def _conditions(design: Design, unit: Unit) -> tuple[str, ...]:
    """Conditions of the values, and what the design assumes beside them, which the supplier confirms."""

    def text_of(key: str) -> str:
        return input_in_words(design, key, cast("float", design[key]))

    if unit == "gnss":
        slow = "none"
        if design.gnss.correlated:
            vertical = cast("float", value_of(design, "gnss.vertical_correlated_noise"))
            slow = (
                f"{text_of('gnss.correlated_noise')} horizontal, "
                f"{input_in_words(design, 'gnss.vertical_correlated_noise', vertical)} vertical, "
                f"for {text_of('gnss.correlation_time')}"
            )
        return (
            f"Fixes every {design.gnss.interval:g} s. Errors independent from fix to fix, per axis.",
            f"Slow error (ionosphere, multipath) assumed in addition to these values: {slow}.",
            f"Lever arm to the IMU, error assumed: {text_of('trajectory.lever_arm_error')}. Latency of the fixes "
            f"against the IMU's clock, error assumed: {text_of('trajectory.time_offset')}. Both to be confirmed.",
        )
    bandwidth = text_of("imu.bandwidth") if design.imu.bandwidth else "not stated"
    return (
        f"At rest, white noise per axis. The design multiplies it by {design.imu.vibration_factor:g} in flight.",
        f"Bias that the filter does not absorb, assumed 1σ: {text_of('imu.accelerometer_bias')} and "
        f"{text_of('imu.gyro_bias')}. A log at rest does not show it: the in-run bias instability is to be stated.",
        f"Bandwidth of rates and accelerations: {bandwidth}. Latency against the radar, error assumed: "
        f"{text_of('trajectory.radar_time_offset')}.",
        "The values hold over the temperature range of the flight; change of bias and scale factor with temperature "
        "is to be stated.",
    )


def _proof(design: Design, unit: Unit) -> str:
    if unit == "gnss":
        return (
            f"Log: {_FIXES} fixes of an antenna that does not move, at a surveyed place, each at least three "
            "correlation times after the one before. Reading: the standard deviation of each axis."
        )
    return (
        f"Log: one hour at rest on a solid base at constant temperature, at {design.imu.rate:g} Hz or faster, after "
        "the unit has warmed up; every axis, as rates or increments. Reading: the overlapping Allan deviation at "
        f"{AVERAGING:g} s, times the square root of {AVERAGING:g} s."
    )


def _decision(unit: Unit, degrees: float) -> str:
    rule = (
        f"Decision: every axis may read at most {100 * accepted_share(degrees):.1f} % of the required value. That "
        f"is the root of the chi-square quantile at {100 * (1 - CONFIDENCE):.0f} % over the degrees of freedom, "
        f"here {degrees:.0f}. Shorter logs need a lower reading"
    )
    return f"{rule}: navbudget allan LOG --against DESIGN computes both and decides." if unit == "imu" else f"{rule}."


def acceptance_blocks(
    design: Design, rows: Sequence[Acceptance], reading: Sequence[str] = ()
) -> tuple[Answer, TableBlock]:
    """Answer to whether a log shows what its inertial unit must, and why, by axis; `reading`: how it was read."""
    failed = [axis_label(row.name) for row in rows if not row.passes]
    text = f"Not within the accepted reading: {', '.join(failed)}." if failed else f"All {len(rows)} axes pass."
    answer = Answer("✗ Fails" if failed else "✓ Passes", "bad" if failed else "good", (f"Requirement sheet. {text}",))
    body: Iterable[Row] = (
        (
            axis_label(row.name),
            str(declaration_of(row.input).label),
            *(input_in_words(design, row.input, value) for value in (row.reading, row.accepted, row.required)),
            f"{row.degrees_of_freedom:.0f}",
            Cell("✓ pass", tone="good") if row.passes else Cell("✗ fail", tone="bad"),
        )
        for row in rows
    )
    note = f"A reading is accepted if it proves the required value with {100 * CONFIDENCE:.0f} % confidence."
    if reading:
        note += f" The log was read as: {'; '.join(reading)}."
    return answer, table(
        "acceptance",
        "This log against the requirement sheet",
        ("Axis", "Quantity", *numbers("Reading", "Accepted reading", "Required", "Degrees of freedom"), "Result"),
        body,
        note,
    )


def acceptance_json(design: Design, rows: Sequence[Acceptance]) -> dict[str, Any]:
    """Acceptance of a log as JSON, SI."""
    return {
        "design": design.content_hash,
        "confidence": CONFIDENCE,
        "passes": all(row.passes for row in rows),
        "axes": [asdict(row) | {"passes": row.passes} for row in rows],
    }
