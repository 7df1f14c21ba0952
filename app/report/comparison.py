"""The chapter that sets several designs side by side."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from app.charts.kinds import Bar, BarChart, Chart, Line
from app.document.blocks import (
    Cell,
    CellLike,
    Chapter,
    ChartBlock,
    Column,
    Row,
    Section,
    TableBlock,
    chart_block,
    numbers,
    table,
)
from app.document.display import AS_REQUIRED, ONE_SIGMA, Display
from app.document.numbers import NONE, percent, show_in
from app.document.verdict import check_words, verdict_of
from app.document.wording import labelled, printable, title_of
from app.report.inputs import input_text, sourced_value
from nav_model.aperture.geometry import phase_to_metres
from nav_model.budget import Budget
from nav_model.budget.figures import figures
from nav_model.budget.inputs import inputs_of
from nav_model.budget.verdict import limit_on
from nav_model.design import Design
from nav_model.design.figures import FIGURES, REQUIRED, label_of, of_kind
from nav_model.design.parts import INPUTS

_COLUMNS = 5  # designs that fit side by side on a page
_LINES = 7  # curves a reader can tell apart
_COMPARED = tuple(REQUIRED)


def comparison_chapter(
    budgets: Sequence[Budget],
    labels: Sequence[str],
    facts: tuple[tuple[str, str], ...],
    display: Display = AS_REQUIRED,
) -> Chapter:
    """The comparison: verdicts, figures with the better one marked, inputs that differ, charts."""
    display = display.of(*(budget.design for budget in budgets))
    return Chapter(
        key="c",
        kind="Comparison of navigation error budgets",
        title=closing_words(budgets),
        running=f"Comparison of {len(budgets)} designs",
        facts=facts,
        sections=(
            Section("c-verdicts", "Verdicts", (_verdicts(budgets, labels),)),
            Section("c-figures", "Values side by side", _figures(budgets, labels, display)),
            Section("c-inputs", "Inputs that differ", _inputs(budgets, labels)),
            Section("c-charts", "Charts", _charts(budgets, labels, display)),
        ),
    )


def closing_words(budgets: Sequence[Budget]) -> str:
    """A title with the number of two or more designs that close."""
    count, closing = len(budgets), sum(budget.verdict.closes for budget in budgets)
    if unknown := sum(budget.verdict.state == "open" for budget in budgets):
        return f"{closing} of {count} designs close, {unknown} open"
    if closing == count:
        return f"{'Both' if count == 2 else f'All {count}'} designs meet their requirements"
    if not closing:
        return f"{'Neither design' if count == 2 else f'None of {count} designs'} meets its requirements"
    return f"{closing} of {count} designs {'meets its' if closing == 1 else 'meet their'} requirements"


def difference_tables(
    budgets: Sequence[Budget], labels: Sequence[str], display: Display = AS_REQUIRED
) -> tuple[TableBlock, TableBlock, TableBlock]:
    """Verdicts, figures and inputs that differ, each as one table of any width; for the screen."""
    wide = len(budgets)
    display = display.of(*(budget.design for budget in budgets))
    (figures,), (inputs,) = _figures(budgets, labels, display, wide), _inputs(budgets, labels, wide)
    return _verdicts(budgets, labels), figures, inputs


def _verdicts(budgets: Sequence[Budget], labels: Sequence[str]) -> TableBlock:
    def row(budget: Budget, label: str) -> Row:
        answer = verdict_of(budget)
        tightest_words = (NONE, NONE, NONE)
        if tightest := budget.verdict.tightest:
            words = check_words(budget.design, tightest)
            tightest_words = (tightest.label, words.margin, f"{tightest.dominant}, {words.share}")
        design, word = budget.design, Cell(answer.word, tone=answer.tone)
        name = labelled(label, title_of(design))
        return name, design.content_hash[:12], word, budget.verdict.processing, *tightest_words

    return table(
        "c-verdicts-table",
        "Verdicts",
        (
            ("Design", 1.6),
            ("Hash", 1.1),
            ("Verdict", 1.1),
            ("Processing", 1.1),
            ("Tightest requirement", 1.2),
            *numbers("Margin", width=0.9),
            ("Main error source", 1.2),
        ),
        (row(budget, label) for budget, label in zip(budgets, labels, strict=True)),
    )


def _sigmas(budget: Budget) -> dict[str, float]:
    """Each figure at one sigma, of the design's processing; while fixes come in, before a fix."""
    sigmas = figures(replace(inputs_of(budget.design), steady_state="prior"), _COMPARED)
    return {name: float(sigmas[name]) for name in _COMPARED}


def _figures(
    budgets: Sequence[Budget], labels: Sequence[str], display: Display, wide: int = _COLUMNS
) -> tuple[TableBlock, ...]:
    by_design = [_sigmas(budget) for budget in budgets]
    sigmas = {name: [sigma[name] for sigma in by_design] for name in _COMPARED}

    def cell(name: str, design: int) -> CellLike:
        limit, pair, sigma = limit_on(name), FIGURES[name].pair, sigmas[name][design]
        text = (
            show_in(sigma, limit.unit, limit.dimension)
            if display == ONE_SIGMA or limit.dimension == "level"
            else display.show(sigma, limit.dimension, pair=pair)
        )
        best = min(sigmas[name]) < max(sigmas[name]) and sigma == min(sigmas[name])
        return Cell(text, "best", "good") if best else text

    def label_for(name: str) -> str:
        label = label_of(name)
        return label if display == ONE_SIGMA else f"{label}, {display.named(pair=FIGURES[name].pair)}"

    def values(columns: range, part: str) -> TableBlock:
        return table(
            f"c-figures-{columns.start}",
            f"Errors, {display.spread}{part}; the smallest of all designs is marked best",
            _head("Quantity", columns, labels, numeric=True),
            ((label_for(name), *(cell(name, design) for design in columns)) for name in _COMPARED),
            "Each design has its own outage, radar, aperture and processing. In real time: before a fix [T-8], "
            "phases [S-5], [S-2], [T-15], [S-6]. Post-processed: smoothed [P-3], [P-5]. Outage: in real time [T-17].",
        )

    return _in_parts(len(budgets), labels, values, wide)


def _inputs(budgets: Sequence[Budget], labels: Sequence[str], wide: int = _COLUMNS) -> tuple[TableBlock, ...]:
    designs = [budget.design for budget in budgets]
    keys = [
        (section, name)
        for section, names in INPUTS.items()
        for name in names
        if len({design[f"{section}.{name}"] for design in designs}) > 1
    ]

    differing = entry_differences(designs)

    def cell(design: int, section: str, name: str) -> CellLike:
        text = input_text(designs[design], section, name) or "not given"
        sourced = sourced_value(designs[design], section, name)
        return text if sourced is None or sourced.confirmed else Cell(text, sourced.status, "warn")

    def inputs(columns: range, part: str) -> TableBlock:
        return table(
            f"c-inputs-{columns.start}",
            f"Inputs that differ{part}",
            _head("Input", columns, labels),
            (
                *(
                    (str(INPUTS[section][name].label), *(cell(design, section, name) for design in columns))
                    for section, name in keys
                ),
                *((name, *(texts[design] for design in columns)) for name, texts in differing.items()),
            ),
            "" if keys or differing else "The designs have the same inputs.",
        )

    return _in_parts(len(budgets), labels, inputs, wide)


def entry_differences(designs: Sequence[Design]) -> dict[str, list[str]]:
    """Contributors, requirements of the user's own and allocation that differ: what each is in every design."""
    by_design = [_entry_texts(design) for design in designs]
    names = dict.fromkeys(name for words in by_design for name in words)
    texts_of = {name: [words.get(name, "not given") for words in by_design] for name in names}
    return {name: texts for name, texts in texts_of.items() if len(set(texts)) > 1}


def _entry_texts(design: Design) -> dict[str, str]:
    """Each contributor, limit and the allocation of a design in words."""
    texts_of = {}
    for part in design.contributors:
        allowance = f" + {percent(part.allowance)}" if part.allowance else ""
        texts = (f"{part.show(6)}{allowance} in {label_of(part.enters)}", part.kind, part.processing,
                 part.owner and f"owner {part.owner}", part.source)  # fmt: skip
        texts_of[f"Contributor {printable(part.name)}"] = printable(", ".join(filter(None, texts)))
    for limit in design.limits:
        record = limit.record()
        asked = [label_of(limit.on), *list(record.values())[2:]]
        texts_of[f"Requirement {printable(limit.name)}"] = printable(", ".join(asked))
    if design.allocation:
        plan = design.allocation
        locks = (f"{lock.name} {lock.show(6)} of {label_of(lock.requirement)}" for lock in plan.locks)
        texts_of["Allocation"] = printable(", ".join((plan.split, f"reserve {percent(plan.reserve)}", *locks)))
    return texts_of


def _in_parts(
    count: int, labels: Sequence[str], table: Callable[[range, str], TableBlock], wide: int
) -> tuple[TableBlock, ...]:
    """As many tables as it takes for no more than `wide` designs in each."""
    parts = [range(start, min(start + wide, count)) for start in range(0, count, wide)]
    return tuple(
        table(part, "" if len(parts) == 1 else f", {labels[part.start]} to {labels[part.stop - 1]}") for part in parts
    )


def _head(title: str, columns: range, labels: Sequence[str], *, numeric: bool = False) -> tuple[Column, ...]:
    return (Column(title, width=1.6), *(Column(labels[design], numeric=numeric, width=1) for design in columns))


def _charts(budgets: Sequence[Budget], labels: Sequence[str], display: Display) -> tuple[ChartBlock, ...]:
    blocks = []
    for start in range(0, len(budgets), _LINES):
        part = slice(start, start + _LINES)
        choice = budgets[part], labels[part]
        for chart in (display.timeline(position_comparison(*choice)), display.bars(phase_comparison(*choice))):
            blocks.append(chart_block(chart, f"c-{start}"))
    return tuple(blocks)


def position_comparison(budgets: Sequence[Budget], labels: Sequence[str]) -> Chart:
    """Horizontal position against time since the last fix, with all terms. Designs go by short labels: names may be
    long."""
    return Chart(
        key="position",
        title="Horizontal position after the last fix",
        x_label="time since the last fix [s]",
        y_label="horizontal position, 1σ [m]",
        lines=tuple(
            Line(label, label, budget.coast.time, budget.coast.refined_horizontal, f"design {i}",
                 "linear covariance propagation [T-17]")
            for i, (budget, label) in enumerate(zip(budgets, labels, strict=True), start=1)
        ),
        y_log=True,
        knowledge="In real time, with Schuler and Coriolis terms [T-17].",
    )  # fmt: skip


def phase_comparison(budgets: Sequence[Budget], labels: Sequence[str]) -> BarChart:
    """Quadratic and detrended phase of some budgets."""

    def bar(budget: Budget, label: str) -> Bar:
        phases = np.array([budget.figure(name).sigma for name in of_kind("phase") if FIGURES[name].tile])
        first, second = map(float, np.degrees(phases))
        first_mm, second_mm = map(float, 1000 * phase_to_metres(phases, budget.sar.wavelength))
        marks = "[P-5]" if budget.post_processed else "[S-5], [T-15], [S-6]"
        return Bar(label, first, second, first_mm, second_mm, marks)

    return BarChart(
        key="phase",
        title="Phase over the aperture",
        x_label="line-of-sight phase over the aperture, 1σ [°]",
        first_label="quadratic",
        second_label="detrended phase",
        bars=tuple(bar(budget, label) for budget, label in zip(budgets, labels, strict=True)),
        first_limit=math.nan,
        second_limit=math.nan,
        knowledge="Totals in quadrature, in real time [S-5], [T-15], [S-6], post-processed [P-5]; each with its own "
        "radar, aperture, autofocus and processing.",
    )
