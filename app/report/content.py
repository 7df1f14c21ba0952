"""A report's content: one source for HTML and PDF. Numbers come from budgets; nothing is computed here."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from importlib.metadata import version

import numpy as np

from app.document.blocks import (
    Approval,
    Bullets,
    Cell,
    Chapter,
    ChartBlock,
    Column,
    Equations,
    Report,
    Section,
    Symbols,
    Table,
    Text,
)
from app.document.chart_block import chart_block
from app.document.citations import marks_in
from app.document.numbers import degrees, millimetres, number, percent, signed_percent
from app.document.wording import (
    best_of,
    chapter_key,
    design_labels,
    labelled,
    printable,
    requirement_quantity,
    shortened,
    title_of,
    verdict_of,
)
from app.report.inputs import MARKS_EXPLAINED, doubtful_inputs, input_rows
from app.subjects.budget.charts import BUDGET_CHARTS
from app.subjects.review.comparison import comparison_chapter
from nav_model.budget import Budget, analyse
from nav_model.budget.json import to_json
from nav_model.budget.provenance import cautions, provenance
from nav_model.budget.result import Sigmas
from nav_model.design.file import format_design
from nav_model.equations import REFERENCES, with_cited

_FRACTIONS = (0.0, 0.1, 0.2, 0.5, 1.0)  # of the outage, in its table
_REPORT = "Navigation error budget"


def report_of(
    budgets: Sequence[Budget],
    now: datetime | None = None,
    added: Sequence[Section] = (),
    studies: Sequence[Sequence[Section]] = (),
) -> Report:
    """The report of some budgets; several make a comparison and a chapter each.

    Parameters
    ----------
    budgets : sequence of Budget
        At least one.
    now : datetime, optional
        Date of the report, with its time zone; by default this moment.
    added : sequence of Section
        What else belongs before the shared sections, such as the record of a review.
    studies : sequence of sequences of Section
        What `app.report.studies` found for each budget, in order; empty for none.
    """
    studies = studies or [()] * len(budgets)
    now = (now or datetime.now(UTC)).astimezone(UTC)
    facts = (("Written", f"{now:%d %B %Y, %H:%M} UTC"), ("Program", f"NavBudget {version('navbudget')}"))
    labels = design_labels(len(budgets))
    chapters = tuple(
        _chapter(budget, label, facts, found) for budget, label, found in zip(budgets, labels, studies, strict=True)
    )
    if len(budgets) > 1:
        chapters = (comparison_chapter(budgets, labels, facts), *chapters)
        title = f"Comparison of {len(budgets)} navigation error budgets"
    else:
        title = f"{_REPORT}: {title_of(budgets[0].design)}"
    told = [section for chapter in chapters for section in chapter.sections] + [*added]
    shared = (*added, *_shared(budgets, labels, told))
    return Report(title, now.isoformat(timespec="seconds"), version("navbudget"), chapters, shared)


def _chapter(budget: Budget, label: str, facts: tuple[tuple[str, str], ...], studies: Sequence[Section]) -> Chapter:
    design = budget.design
    name = labelled(label, title_of(design))
    key = chapter_key(label)
    return Chapter(
        key=key,
        kind=_REPORT,
        title=name,
        running=f"{shortened(name)} · {design.content_hash[:12]}",
        description=printable(design.description),
        verdict=verdict_of(budget),
        facts=(
            ("Design", design.content_hash[:12]),
            *facts,
            ("Content hash (SHA-256)", design.content_hash),
        ),
        sections=(
            Section(f"{key}-requirements", "Requirements", (_requirements(budget, key),)),
            Section(f"{key}-steady", "Steady state", (_steady(budget, key),)),
            Section(f"{key}-growth", "Errors against time", _growth(budget, key)),
            Section(f"{key}-phase", "Phase and image", _phase(budget, key)),
            Section(f"{key}-regime", "Which sensor rules", _regime(budget, key)),
            *studies,
            Section(
                f"{key}-inputs",
                "Inputs",
                (
                    Table(
                        f"{key}-inputs-table",
                        "Every input, with its origin",
                        (Column("Input", width=1.25), Column("Value", width=1), Column("Origin", width=1.9)),
                        input_rows(design, budget.sar.aperture_time),
                        MARKS_EXPLAINED,
                    ),
                ),
            ),
            Section(f"{key}-cautions", "Assumptions and cautions", (_cautions(budget), _assumptions(budget))),
        ),
        source=format_design(design),
    )


def _requirements(budget: Budget, key: str) -> Table | Text:
    verdict = budget.verdict
    if not verdict.checks:
        return Text("The design states no requirement; nothing was checked.")
    rows = tuple(
        (
            Cell(check.label),
            Cell(requirement_quantity(budget.design, check.name, check.value)),
            Cell(requirement_quantity(budget.design, check.name, check.limit)),
            Cell(signed_percent(check.margin)),
            Cell("✓ met", tone="good") if check.met else Cell("✗ not met", tone="bad"),
            Cell(f"{check.basis} {check.equation}"),
            Cell(f"{check.sensor}, {percent(check.sensor_share)}"),
        )
        for check in verdict.checks
    )
    return Table(
        f"{key}-verdict",
        f"Requirements at {verdict.confidence:g}σ",
        (
            Column("Requirement", width=1.5),
            Column(f"{verdict.confidence:g}σ value", numeric=True),
            Column("Limit", numeric=True),
            Column("Margin", numeric=True),
            Column("Verdict"),
            Column("Figure checked", width=1.25),
            Column("Dominant sensor", width=1.25),
        ),
        rows,
        "Margin is the part of the limit left over. The share is of the variance, with an initial tilt charged to "
        "the sensors that cause it [T-18].",
    )


_STEADY = (
    ("position_horizontal", "horizontal_position", "Horizontal position, per axis"),
    ("position_vertical", "vertical_position", "Vertical position"),
    ("velocity_horizontal", "horizontal_velocity", "Horizontal velocity, per axis"),
    ("velocity_vertical", "vertical_velocity", "Vertical velocity"),
    ("tilt", "tilt", "Tilt (roll and pitch, each)"),
)


def _steady(budget: Budget, key: str) -> Table:
    steady, design = budget.steady_state, budget.design
    sources = provenance(budget)

    def shown(sigmas: Sigmas, field: str, requirement: str) -> Cell:
        return Cell(requirement_quantity(design, requirement, getattr(sigmas, field)))

    def row(field: str, requirement: str, label: str) -> tuple[Cell, ...]:
        source, share = best_of(steady.shares[requirement])
        moments = (steady.closed, steady.prior, steady.posterior)
        return (
            Cell(label),
            *(shown(moment, field, requirement) for moment in moments),
            Cell(f"{source}, {percent(share)}"),
        )

    closed = sources["steady_state.position_sigma_m.horizontal"]
    prior = sources["steady_state.discrete.prior"]
    return Table(
        f"{key}-steady-table",
        "Standard deviations while fixes come in, 1σ",
        (
            Column("Error", width=1.5),
            Column("Cycle rms [T-3], [T-4]", numeric=True),
            Column("Before a fix [T-8]", numeric=True),
            Column("After a fix [T-8]", numeric=True),
            Column("Largest share [T-18]", width=1.2),
        ),
        tuple(row(*names) for names in _STEADY),
        f"Cycle rms: {closed.method}, {closed.note}. Before and after a fix: {prior.method}. "
        f"Gyro dominance κ = {number(steady.gyro_dominance)} [T-6]; λ Δt = {number(steady.lambda_dt, 3)} [T-8].",
    )


def _growth(budget: Budget, key: str) -> tuple[ChartBlock | Table, ...]:
    position, velocity, attitude = (chart_block(chart(budget), key) for chart in BUDGET_CHARTS[:3])
    coast = analyse(budget.design, budget.coast.duration * np.array(_FRACTIONS)).coast
    to_degrees = 180 / math.pi
    columns = (
        ("Horizontal [m] [T-9]", coast.position_horizontal),
        ("refined [m] [T-17]", coast.refined_horizontal),
        ("Vertical [m] [T-10]", coast.position_vertical),
        ("refined [m] [T-17]", coast.refined_vertical),
        ("Velocity hor. [m/s]", coast.velocity_horizontal),
        ("Velocity vert. [m/s]", coast.velocity_vertical),
        ("Tilt [°] [T-9]", coast.tilt * to_degrees),
        ("Yaw growth [°] [T-5]", coast.yaw_growth * to_degrees),
    )
    table = Table(
        f"{key}-coast",
        "Standard deviations after the last fix, 1σ",
        (Column("Time [s]", numeric=True), *(Column(title, numeric=True, width=1) for title, _ in columns)),
        tuple(
            (Cell(number(time)), *(Cell(number(curve[i])) for _, curve in columns))
            for i, time in enumerate(coast.time)
        ),
        "Residual biases in quadrature. Requirements after the last fix are held against the refined curve.",
    )
    return position, table, velocity, attitude


def _phase(budget: Budget, key: str) -> tuple[Table | ChartBlock, ...]:
    sar = budget.sar
    left = {1: "a line", 2: "a quadratic", 3: "a cubic"}[sar.autofocus_order]

    def row(label: str, quadratic: float, share: str, detrended: float, left_share: str) -> tuple[Cell, ...]:
        given = not math.isnan(detrended)
        return (
            Cell(label),
            Cell(degrees(quadratic)),
            Cell(millimetres(quadratic, sar.wavelength)),
            Cell(share),
            Cell(degrees(detrended) if given else "–"),
            Cell(millimetres(detrended, sar.wavelength) if given else "–"),
            Cell(left_share),
        )

    makers = ", ".join(f"{source} {percent(share)}" for source, share in sar.tilt_shares.items())
    budget_table = Table(
        f"{key}-phase-table",
        "Phase budget of the aperture by source, 1σ, in phase and in line-of-sight millimetres",
        (
            Column("Source", width=1.7),
            Column("Quadratic [°]", numeric=True, width=1),
            Column("[mm]", numeric=True, width=0.8),
            Column("Share", numeric=True, width=0.8),
            Column(f"Rms after {left} [°]", numeric=True, width=1.15),
            Column("[mm]", numeric=True, width=0.8),
            Column("Share", numeric=True, width=0.8),
        ),
        (
            *(
                row(x.source, x.quadratic, percent(x.share), x.detrended, percent(x.detrended_share))
                for x in sar.lines
            ),
            row("total in quadrature", sar.quadratic, "100 %", sar.detrended, "100 %"),
            row("along-track, of its own", sar.along_track_quadratic, "–", math.nan, "–"),
        ),
        f"Shares are of the variance [S-5], [T-15], [S-6]; along-track [S-2]. The initial tilt is the work of "
        f"{makers} [T-18].",
    )
    phase, response = (chart_block(chart(budget), key) for chart in BUDGET_CHARTS[3:5])
    return phase, budget_table, response, _image(budget, key)


def _image(budget: Budget, key: str) -> Table:
    sar, sources = budget.sar, provenance(budget)
    response = to_json(budget)["sar"]["impulse_response"]
    none = "no image: more than 1000 rad"

    def image(name: str, unit: str) -> str:
        return none if response is None else f"{number(float(response[name]))} {unit}"

    rows = (
        ("Wavelength", f"{number(100 * sar.wavelength)} cm", "sar.wavelength_m"),
        ("Aperture time", f"{number(sar.aperture_time)} s", "sar.aperture_time_s"),
        ("Aperture length", f"{number(sar.aperture_length)} m", "sar.aperture_length_m"),
        ("Quadratic phase, 1σ", f"{degrees(sar.quadratic)}°", "sar.quadratic_phase_sigma_rad"),
        ("Cubic phase, 1σ", f"{degrees(sar.cubic)}°", "sar.cubic_phase_sigma_rad"),
        ("Rms phase after autofocus, 1σ", f"{degrees(sar.detrended)}°", "sar.detrended_phase_sigma_rad"),
        ("Response width", image("width_m", "m"), "sar.impulse_response"),
        ("Peak side-lobe ratio", image("pslr_db", "dB"), "sar.impulse_response"),
        ("Integrated side-lobe ratio", image("islr_db", "dB"), "sar.impulse_response"),
        ("Peak loss", image("peak_loss_db", "dB"), "sar.impulse_response"),
    )

    def origin(name: str) -> str:
        source = sources[name]
        stated = name == "sar.aperture_time_s" and budget.design.radar.aperture_time is not None
        return "stated in the design" if stated else ", ".join(filter(None, (source.method, source.note)))

    return Table(
        f"{key}-image",
        "Aperture and azimuth impulse response",
        (
            Column("Figure", width=1.3),
            Column("Value", numeric=True, width=1),
            Column("Equation", width=0.8),
            Column("Method", width=1.7),
        ),
        tuple(
            (Cell(label), Cell(value), Cell(sources[name].equation), Cell(origin(name)))
            for label, value, name in rows
        ),
        "Width between the outermost half-power points; side lobes outside the error-free main lobe, whole line.",
    )


def _regime(budget: Budget, key: str) -> tuple[ChartBlock, ...]:
    return (chart_block(BUDGET_CHARTS[5](budget), key),)


def _cautions(budget: Budget) -> Bullets:
    doubtful = doubtful_inputs(budget.design)
    first = (f"Not confirmed at the source: {', '.join(doubtful)}.",) if doubtful else ()
    return Bullets((*first, *cautions(budget)))


def _assumptions(budget: Budget) -> Bullets:
    requirements = budget.design.requirements
    figure = {"prior": "just before a fix, the worst of the cycle", "posterior": "just after a fix",
              "closed": "the cycle rms in closed form"}[requirements.steady_state]  # fmt: skip
    items: Iterable[str] = (
        "Straight, level flight at constant velocity, in steady state before the last fix; small errors [T-1].",
        "Random walks are white, Gaussian, alike and independent on the three axes; residual biases are constant "
        "over the outage and the aperture.",
        "GNSS measures position only, per axis"
        + (", with a slow first-order Gauss-Markov error on top of white noise."
           if budget.design.gnss.correlated else ", with white noise from fix to fix [T-2]."),
        f"Requirements in steady state are held against the figure {figure} [T-8]; after the last fix against the "
        f"refined curve [T-17]; each at {requirements.confidence:g}σ.",
        "Broadside strip map; the inertial unit alone carries the aperture, which starts "
        f"{number(budget.design.coast.before_aperture)} s after the last fix [S-1], [S-5].",
        "Lever arm, timing, atmosphere and range migration are not part of the budget.",
    )  # fmt: skip
    return Bullets(tuple(items))


def _shared(budgets: Sequence[Budget], labels: Sequence[str], told: Sequence[Section]) -> tuple[Section, ...]:
    subjects = tuple(
        f"{labelled(label, title_of(budget.design))}, content hash {budget.design.content_hash}"
        for budget, label in zip(budgets, labels, strict=True)
    )
    equations, symbols = with_cited(marks_in(told))
    references = dict.fromkeys((*REFERENCES, *(text for section in told for text in section.references)))
    return (
        Section("equations", "Equations", (Equations(equations),)),
        Section("symbols", "Symbols", (Symbols(symbols),)),
        Section("references", "References", (Bullets(tuple(references)),)),
        Section("approval", "Approval", (Approval(("Prepared", "Checked", "Approved"), subjects),)),
    )
