"""The subjects of the product, one package each, and their registry.

The registry is data: it names parts, which are loaded when needed. So reading it is cheap, and tabs, command line and
report use it without importing a subject. No subject imports another.
"""

from dataclasses import dataclass
from importlib import import_module
from typing import Any


@dataclass(frozen=True)
class Subject:
    """A subject and its parts, named within its package; a missing part is empty.

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
        Module that describes a result in a design's report: ``sections(result, key)``. If the result is that of a
        study, also ``another_design(result, design)``, the one it is of unless that is this design, and
        ``study(design, options)``, which runs one.
    study : str
        What its study is called in a report; empty for a subject whose results follow from the design at once.
    ahead : str
        ``module:function`` that computes what opening the tab asks for with a design. It is awaited once per server,
        for the design that visitors start with, while the first page is at rest.
    """

    key: str
    title: str
    page: str
    command: str = ""
    report: str = ""
    study: str = ""
    ahead: str = ""

    def load(self, part: str) -> Any:
        """A part of the subject, such as "report", imported: a module, or what is in it behind a colon."""
        module, _, attribute = getattr(self, part).partition(":")
        loaded = import_module(f"{__name__}.{self.key}.{module}")
        return getattr(loaded, attribute) if attribute else loaded


SUBJECTS: tuple[Subject, ...] = (
    Subject("budget", "Budget", "page:BudgetPage", "command", "report"),
    Subject("simulation", "Simulate", "page:SimulatePage", "command", "report", "Simulation"),
    Subject("trajectory", "Trajectory", "page:TrajectoryPage", "command", "report", "Trajectory"),
    Subject("sar", "SAR", "page:SarPage", "command", "report", "SAR"),
    Subject(
        "suborbital",
        "Suborbital",
        "page:SuborbitalPage",
        "command",
        "report",
        "Suborbital flight",
        ahead="studies:fly_ahead",
    ),
    Subject("explore", "Explore", "page:ExplorePage", "command"),
    Subject("sensors", "Sensors", "page:SensorsPage", "command"),
    Subject("review", "Review", "page:ReviewPage"),
    Subject("theory", "Theory", "page:TheoryPage"),
)
"""Every subject, in the order of the tabs, of the commands and of a report's sections."""

BY_KEY: dict[str, Subject] = {subject.key: subject for subject in SUBJECTS}
STUDIES: dict[str, Subject] = {subject.key: subject for subject in SUBJECTS if subject.study}
"""The subjects with a study to run."""
