"""The content of a report, the same for HTML and PDF. Each subject supplies its sections (`app.subjects`)."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import fields, is_dataclass
from datetime import UTC, datetime
from importlib.metadata import version
from typing import Any

from app.document.blocks import MARK, Approval, Bullets, Chapter, ChartBlock, Equations, Report, Section, Symbols
from app.document.display import AS_REQUIRED, ONE_SIGMA, Display
from app.document.verdict import verdict_of
from app.document.wording import chapter_key, design_labels, labelled, printable, shortened, title_of
from app.examples import description_of
from app.report.cautions import assumption_list, caution_list
from app.report.comparison import comparison_chapter
from app.report.inputs import input_table
from app.subjects import BY_KEY
from nav_model.budget import Budget
from nav_model.design.file import format_design
from nav_model.equations import with_cited
from nav_model.equations.literature import references_of

_REPORT = "Navigation error budget"


def report_of(
    budgets: Sequence[Budget],
    now: datetime | None = None,
    added: Sequence[Section] = (),
    studies: Sequence[Sequence[Section]] = (),
    front: Chapter | None = None,
    display: Display = AS_REQUIRED,
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
    front : Chapter, optional
        The first page, such as the outcome of a review; its title becomes the report's.
    display : Display
        How figures of budgets and of their comparison are told; studies stay at 1σ.
    """
    studies = studies or [()] * len(budgets)
    now = (now or datetime.now(UTC)).astimezone(UTC)
    facts = (("Written", f"{now:%d %B %Y, %H:%M} UTC"), ("Program", f"NavBudget {version('navbudget')}"))
    labels = design_labels(len(budgets))
    chapters = tuple(
        _chapter(budget, label, facts, findings, display)
        for budget, label, findings in zip(budgets, labels, studies, strict=True)
    )
    if len(budgets) > 1:
        chapters = (comparison_chapter(budgets, labels, facts, display), *chapters)
        title = f"Comparison of {len(budgets)} navigation error budgets"
    else:
        title = f"{_REPORT}: {title_of(budgets[0].design)}"
    if front is not None:
        chapters, title = (front, *chapters), f"{front.kind}: {printable(front.title)}"
    sections = [section for chapter in chapters for section in chapter.sections] + [*added]
    shared = (*added, *_shared(budgets, labels, sections))
    return Report(title, now.isoformat(timespec="seconds"), version("navbudget"), chapters, shared)


def _chapter(
    budget: Budget, label: str, facts: tuple[tuple[str, str], ...], studies: Sequence[Section], display: Display
) -> Chapter:
    design, display = budget.design, display.of(budget.design)
    name = labelled(label, title_of(design))
    key = chapter_key(label)
    spread = () if display == ONE_SIGMA else (("Values of the budget", f"{display.in_words}; all others 1σ"),)
    return Chapter(
        key=key,
        kind=_REPORT,
        title=name,
        running=f"{shortened(name)} · {design.content_hash[:12]}",
        description=printable(description_of(design)),
        verdict=verdict_of(budget),
        facts=(
            ("Design", design.content_hash[:12]),
            *facts,
            ("Content hash (SHA-256)", design.content_hash),
            *spread,
        ),
        sections=(
            *BY_KEY["budget"].load("report").sections(budget, key, display),
            *studies,
            Section(f"{key}-inputs", "Inputs", (input_table(design, budget.sar.aperture_time, key),)),
            Section(f"{key}-cautions", "Assumptions and cautions", (caution_list(budget), assumption_list(budget))),
        ),
        source=format_design(design),
    )


def _shared(budgets: Sequence[Budget], labels: Sequence[str], sections: Sequence[Section]) -> tuple[Section, ...]:
    subjects = tuple(
        f"{labelled(label, title_of(budget.design))}, content hash {budget.design.content_hash}"
        for budget, label in zip(budgets, labels, strict=True)
    )
    equations, symbols = with_cited(_marks_in(sections))
    added = (text for section in sections for text in section.references)
    references = dict.fromkeys((*references_of(equations), *added))
    return (
        Section("equations", "Equations", (Equations(equations),)),
        Section("symbols", "Symbols", (Symbols(symbols),)),
        Section("references", "References", (Bullets(tuple(references)),)),
        Section("approval", "Approval", (Approval(("Prepared", "Checked", "Approved"), subjects),)),
    )


def _marks_in(sections: Iterable[Section]) -> set[str]:
    """Marks of the equations named in any text of some sections, captions and sources of curves included."""
    return {mark for section in sections for text in _texts(section) for mark in MARK.findall(text)}


def _texts(thing: Any) -> Iterator[str]:
    """Every string in a tree of dataclasses and tuples; arrays are skipped."""
    if isinstance(thing, str):
        yield thing
    elif isinstance(thing, ChartBlock):
        yield thing.alt
        yield from (getattr(line, "source", "") for line in getattr(thing.chart, "lines", ()))
    elif isinstance(thing, tuple):
        for part in thing:
            yield from _texts(part)
    elif is_dataclass(thing):
        for field in fields(thing):
            yield from _texts(getattr(thing, field.name))
