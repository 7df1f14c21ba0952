"""The suborbital study as sections of a report: what a star tracker repairs of an INS, and what it does not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from app.charts.kinds import Chart
from app.document.blocks import Answer, Block, Cell, Column, Section, Text
from app.document.blocks import Table as ReportTable
from app.document.chart_block import chart_block
from app.document.numbers import number, percent
from app.subjects.suborbital import charts, tables
from app.subjects.suborbital.charts import Shown
from app.subjects.suborbital.finding import Finding
from nav_model.design import Design
from nav_model.suborbital.input_table import GROUPS
from nav_model.suborbital.settings import Settings, from_design
from nav_model.suborbital.summary import explain

_ERRORS = tuple(draw for channel in (2, 1, 0) for draw in (charts.source_chart(channel), charts.aided_chart(channel)))
_SENSORS = tuple(charts.sensor_chart(sensor, axis) for sensor in (0, 1) for axis in range(3))
_FLIGHT = (
    charts.map_chart, charts.height_chart, charts.force_chart, charts.rate_chart, charts.gravity_chart,
)  # fmt: skip
_OF_A_DESIGN = "design"  # how the origin of an input begins that a design gave
REFERENCES = (
    "[B] Moghtadaei Rad, Heyrani Nobari and Nikkhah, on integrating a star tracker with an inertial unit for a "
    "suborbital flight; its printed equations, sensors and trajectory are lost. [B-1] to [B-9] are derived in "
    "NavBudget and verified against independent integrations, scipy's align_vectors and Monte Carlo runs in its test "
    "suite.",
    "van Leeuwen, Hipparcos, the New Reduction of the Raw Data, Springer, 2007; CDS I/311: the camera's stars.",
)


def belongs(finding: Finding, design: Design) -> bool:
    """Whether no input of the study comes from another design than this one, as it is now."""
    return not _takes_a_design(finding.settings) or _has_unit_of(finding.settings, design)


def of_design(finding: Finding) -> str:
    """The design whose inertial unit it took."""
    origins = finding.settings.origin.values()
    return next((origin for origin in origins if origin.startswith(_OF_A_DESIGN)), "none")


def sections(finding: Finding, key: str) -> tuple[Section, ...]:
    """The plain sentence, the tables, the charts, every input with its origin."""
    shown = finding.shown
    return (
        Section(
            f"{key}-suborbital",
            "Suborbital flight: what a star tracker repairs, and what it does not",
            (*_answer(finding), *_paper_tables(shown, key)),
            REFERENCES,
        ),
        Section(
            f"{key}-suborbital-errors",
            "Suborbital flight: errors by source, with and without star tracker",
            (*_drawn((*_ERRORS, charts.growth_chart), shown, key),
             _table(tables.source_table(shown), key), _table(tables.gap_table(shown), key)),
        ),
        Section(
            f"{key}-suborbital-sensors",
            "Suborbital flight: errors of the sensors",
            (*_drawn(_SENSORS, shown, key), *_noise(shown, key)),
        ),
        Section(
            f"{key}-suborbital-attitude",
            "Suborbital flight: attitude and stars",
            (*_drawn((charts.inertial_attitude_chart, charts.navigation_attitude_chart), shown, key),
             _table(tables.method_table(shown), key),
             *_drawn((charts.star_chart, charts.star_count_chart), shown, key)),
        ),
        Section(
            f"{key}-suborbital-flight",
            "Suborbital flight: trajectory and gravity",
            (*_drawn(_FLIGHT, shown, key), _table(tables.gravity_table(shown), key)),
        ),
        Section(f"{key}-suborbital-inputs", "Suborbital flight: inputs of the study", (_inputs(finding, key),)),
    )  # fmt: skip


def _drawn(describe: tuple[Callable[[Shown], Chart], ...], shown: Shown, key: str) -> tuple[Block, ...]:
    return tuple(chart_block(draw(shown), f"{key}-suborbital") for draw in describe)


def _noise(shown: Shown, key: str) -> tuple[Block, ...]:
    """White noise flown against its prediction, where it was flown; the prediction alone is a row of the sources."""
    if shown.ensemble is None:
        return ()
    return (*_drawn(tuple(map(charts.noise_chart, (2, 1, 0))), shown, key), _table(tables.noise_table(shown), key))


def _takes_a_design(settings: Settings) -> bool:
    return any(origin.startswith(_OF_A_DESIGN) for origin in settings.origin.values())


def _has_unit_of(settings: Settings, design: Design) -> bool:
    return dict(from_design(settings, design).values) == dict(settings.values)


def _answer(finding: Finding) -> tuple[Block, ...]:
    """The plain sentence, whose sensors these are, how exact the answer is."""
    study = finding.shown.study
    sensors = (
        "Sensors: this design's inertial unit gives white noise and constant biases; instability, scale factor, "
        "misalignment and initial errors are those listed under the inputs of the study."
        if _takes_a_design(finding.settings)
        else "The study has inputs of its own, listed at its end; they are not this design's inertial unit."
    )
    exact = "Integrated exactly at these inputs."
    if not finding.shown.exact:
        exact = "Moved from the last exact run by the linear sensitivity matrix [B-4]."
    elif finding.shown.gap is not None:
        gap = finding.shown.gap
        k = gap.names.index("all")
        exact += (
            f" The linear answer before was off by {number(float(gap.pure_m[k]), 3)} m "
            f"({percent(float(gap.pure_share[k]))}) for the INS alone and "
            f"{number(float(gap.aided_m[k]), 3)} m ({percent(float(gap.aided_share[k]))}) with it."
        )
    frames = int(study.used.sum())
    images = "star images" if finding.settings["camera.frames"] == "star images" else "a perfect camera"
    return (
        Answer("What the star tracker did and did not repair", "open", (explain(study),)),
        Text(f"{sensors} {exact} {frames} frames from {images}."),
    )


def _table(table: tables.Table, key: str) -> ReportTable:
    """A table of the page as a table of the report: the same rows, the same digits."""

    def cell(value: tables.Cell) -> Cell:
        if value is None:
            return Cell("–", tone="quiet")
        return Cell(value if isinstance(value, str) else tables.number(value, table.digits))

    first = max(1.9, 0.28 * len(table.heads))  # the more columns of numbers, the narrower each
    return ReportTable(
        f"{key}-suborbital-{table.key}",
        table.title,
        (Column(table.heads[0], width=first), *(Column(head, numeric=True, width=1) for head in table.heads[1:])),
        tuple(tuple(cell(value) for value in row) for row in table.rows),
        table.knowledge,
    )


def _paper_tables(shown: Shown, key: str) -> tuple[ReportTable, ...]:
    """The four tables; what all have under them stands under the last."""
    *first, last = (_table(table, key) for table in tables.paper_tables(shown))
    return (*(replace(table, note="") if table.note == last.note else table for table in first), last)


def _inputs(finding: Finding, key: str) -> ReportTable:
    rows: list[tuple[Cell, ...]] = []
    for title, group in GROUPS.items():
        rows.append((Cell(title),))
        rows += [
            (
                Cell(str(declared.label)),
                Cell(finding.settings.show(declared.key) or "none"),
                Cell(finding.settings.origin[declared.key]),
            )
            for declared in group
        ]
    return ReportTable(
        f"{key}-suborbital-inputs-table",
        "Every input of the suborbital study, with its origin",
        (Column("Input", width=1.3), Column("Value", width=1.2), Column("Origin", width=1.2)),
        tuple(rows),
    )
