"""Results of long studies, as sections of a design's report.

A finding is the result of a finished study, from a page or a command. The report module of its subject
(`app.subjects.STUDIES`) says whether it belongs to a design and makes its sections, which are plain data and travel
to a worker.
"""

from collections.abc import Mapping
from typing import Any

from app.document.blocks import Bullets, Section
from app.subjects import STUDIES
from nav_model.design import Design


def study_sections(findings: Mapping[str, Any], design: Design, key: str) -> tuple[Section, ...]:
    """The sections of the findings that belong to a design, and a note on those that do not.

    findings: subject's key -> finding. key: what the keys of the design's sections begin with.
    """
    sections: list[Section] = []
    others = []
    for kind, subject in STUDIES.items():
        if kind not in findings:
            continue
        report = subject.load("report")
        if other := report.another_design(findings[kind], design):
            others.append(f"{subject.study}: the last study belongs to another design, {other}.")
        else:
            sections += report.sections(findings[kind], key)
    if others:
        others.append("Run them again for this design to include them.")
        sections.append(Section(f"{key}-left-out", "Studies left out", (Bullets(tuple(others)),)))
    return tuple(sections)


def belonging(findings: Mapping[str, Any], design: Design) -> dict[str, bool]:
    """Key of each finding, and whether the report of a design would include it."""
    return {
        kind: not subject.load("report").another_design(findings[kind], design)
        for kind, subject in STUDIES.items()
        if kind in findings
    }
