"""What long studies found, as sections of a design's report: simulation, SAR, suborbital flight.

A finding is what a page or a command has once its study is finished; the module of its kind says whether it
belongs to a design (`belongs`) and makes its sections (`sections`), which are plain data and travel to a worker.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

from app.document.blocks import Bullets, Section
from nav_model.design import Design

KINDS: dict[str, tuple[str, str]] = {
    "simulation": ("Simulation", "app.subjects.simulation.report"),
    "sar": ("SAR", "app.subjects.sar.report"),
    "suborbital": ("Suborbital flight", "app.subjects.suborbital.report"),
}
"""Kinds of finding: title, and the module that knows them, imported when there is one to tell."""


def study_sections(findings: Mapping[str, Any], design: Design, key: str) -> tuple[Section, ...]:
    """The sections of the findings that belong to a design, and a word on those that do not.

    findings: kind -> finding. key: what the keys of the design's sections begin with.
    """
    told: list[Section] = []
    left = []
    for kind, (title, module) in KINDS.items():
        if kind not in findings:
            continue
        study = import_module(module)
        if study.belongs(findings[kind], design):
            told += study.sections(findings[kind], key)
        else:
            left.append(f"{title}: the study at hand is of another design, {study.of_design(findings[kind])}.")
    if left:
        left.append("Run them again for this design to have them here.")
        told.append(Section(f"{key}-left-out", "Studies left out", (Bullets(tuple(left)),)))
    return tuple(told)


def belonging(findings: Mapping[str, Any], design: Design) -> dict[str, bool]:
    """Title of each finding at hand, and whether the report of a design would tell it."""
    return {
        title: import_module(module).belongs(findings[kind], design)
        for kind, (title, module) in KINDS.items()
        if kind in findings
    }
