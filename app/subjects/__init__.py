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
    of_files : bool
        True for a study of files that a person brings: it has no ``study`` and `navbudget report` runs none.
    """

    key: str
    command: str = ""
    report: str = ""
    study: str = ""
    ahead: str = ""
    of_files: bool = False

    def load(self, part: str) -> Any:
        """A part of the subject, such as "report", imported: a module, or what is in it behind a colon."""
        return _loaded(f"{self.key}.{getattr(self, part)}")


@dataclass(frozen=True)
class Tab:
    """A page of the dashboard and its tab.

    Attributes
    ----------
    group : str
        The question it answers. Only the first tab of a group is in view until the group is opened; it bears the
        group's name until then.
    title : str
    address : str
        Name behind #, in small letters.
    page : str
        ``module:Class`` of the page, made from a session when its tab is first opened.
    """

    group: str
    title: str
    address: str
    page: str

    def load(self) -> Any:
        """The page's class, imported."""
        return _loaded(self.page)


def _loaded(reference: str) -> Any:
    module, _, attribute = reference.partition(":")
    loaded = import_module(f"{__name__}.{module}")
    return getattr(loaded, attribute) if attribute else loaded


SUBJECTS: tuple[Subject, ...] = (
    Subject("budget", "command", "report"),
    Subject("simulation", "command", "report", "Simulation"),
    Subject("trajectory", "command", "report", "Trajectory", ahead="run:follow_ahead"),
    Subject("flown", "command", "report", "As flown", of_files=True),
    Subject("sar", "command", "report", "SAR"),
    Subject("suborbital", "command", "report", "Suborbital flight", ahead="studies:fly_ahead"),
    Subject("explore", "command"),
    Subject("sensors", "command"),
    Subject("review"),
    Subject("theory"),
)
"""Every subject, in the order of the commands and of a report's sections."""

TABS: tuple[Tab, ...] = (
    Tab("Budget", "Budget", "budget", "budget.page:BudgetPage"),
    Tab("Budget", "Allocate", "allocate", "budget.allocate:AllocatePage"),
    Tab("Close it", "Close it", "close", "explore.page:ExplorePage"),
    Tab("Flight", "Flight", "flight", "trajectory.page:TrajectoryPage"),
    Tab("Flight", "Simulate", "simulate", "simulation.page:SimulatePage"),
    Tab("Flight", "As flown", "flown", "flown.page:FlownPage"),
    Tab("Image", "Image", "image", "sar.page:SarPage"),
    Tab("Sensors", "Sensors", "sensors", "sensors.page:SensorsPage"),
    Tab("Review", "Review", "review", "review.page:ReviewPage"),
    Tab("More", "Theory", "theory", "theory.page:TheoryPage"),
    Tab("More", "Suborbital", "suborbital", "suborbital.page:SuborbitalPage"),
)
"""Every page, in the order of the tabs: by the question that a visitor has."""

MOVED = {"explore": "close", "trajectory": "flight", "sar": "image"}
"""Earlier name of a page in an address -> its name now."""

BY_KEY: dict[str, Subject] = {subject.key: subject for subject in SUBJECTS}
STUDIES: dict[str, Subject] = {subject.key: subject for subject in SUBJECTS if subject.study}
"""The subjects with a study."""
OF_DESIGNS: dict[str, Subject] = {key: subject for key, subject in STUDIES.items() if not subject.of_files}
"""The subjects whose study a design alone can run."""


def tab_index(address: str) -> int | None:
    """Index of the tab with this address, of now or of before; None: there is none."""
    name = MOVED.get(address.lower(), address.lower())
    return next((index for index, tab in enumerate(TABS) if tab.address == name), None)
