"""The subjects a person comes for, a room each, and the one registry of them.

The registry is data: modules are named in it and loaded when somebody needs them, so that reading it costs nothing
and whoever goes by it (tabs, command line, report) imports no subject. No subject imports another.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import Any


@dataclass(frozen=True)
class Subject:
    """A subject and where its parts are; a part that it does not have is empty.

    Attributes
    ----------
    key : str
        Name of its room, and of its finished study in a session and after ``navbudget report --with``.
    title : str
        Label of its tab; in lower case the page's address behind #.
    page : str
        ``module:Class`` of the page, made from a session when its tab is first opened.
    command : str
        Module whose ``add_to(commands)`` declares its commands.
    report : str
        Module that tells a result in a design's report: ``sections(result, key)``. If the result is that of a study,
        also ``belongs(result, design)``, ``of_design(result)`` and ``study(design, options)``, which runs one.
    study : str
        What its study is called in a report; empty for a subject whose results follow from the design at once.
    """

    key: str
    title: str
    page: str
    command: str = ""
    report: str = ""
    study: str = ""


SUBJECTS: tuple[Subject, ...] = (
    Subject(
        "budget",
        "Budget",
        "app.subjects.budget.page:BudgetPage",
        "app.subjects.budget.command",
        "app.subjects.budget.report",
    ),
    Subject(
        "simulation",
        "Simulate",
        "app.subjects.simulation.page:SimulatePage",
        "app.subjects.simulation.command",
        "app.subjects.simulation.report",
        "Simulation",
    ),
    Subject(
        "sar",
        "SAR",
        "app.subjects.sar.page:SarPage",
        "app.subjects.sar.command",
        "app.subjects.sar.report",
        "SAR",
    ),
    Subject(
        "suborbital",
        "Suborbital",
        "app.subjects.suborbital.page:SuborbitalPage",
        "app.subjects.suborbital.command",
        "app.subjects.suborbital.report",
        "Suborbital flight",
    ),
    Subject("explore", "Explore", "app.subjects.explore.page:ExplorePage", "app.subjects.explore.command"),
    Subject("sensors", "Sensors", "app.subjects.sensors.page:SensorsPage", "app.subjects.sensors.command"),
    Subject("review", "Review", "app.subjects.review.page:ReviewPage"),
    Subject("theory", "Theory", "app.subjects.theory.page:TheoryPage"),
)
"""Every subject, in the order of the tabs, of the commands and of a report's sections."""

STUDIES: dict[str, Subject] = {subject.key: subject for subject in SUBJECTS if subject.study}
"""The subjects with a study to run, by key."""


def load(name: str) -> Any:
    """What a dotted name of the registry names: a module, or ``module:attribute``."""
    module, _, attribute = name.partition(":")
    loaded = import_module(module)
    return getattr(loaded, attribute) if attribute else loaded


def part(key: str, name: str) -> Any:
    """A part of a subject, loaded.

    >>> part("budget", "report").__name__
    'app.subjects.budget.report'
    """
    return load(getattr(next(subject for subject in SUBJECTS if subject.key == key), name))
