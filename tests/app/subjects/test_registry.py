"""The one registry of subjects: what it names is there, and reading it costs nothing."""

import argparse
import asyncio
import subprocess
import sys
from pathlib import Path

import pytest

import app.subjects
from app.subjects import OF_DESIGNS, STUDIES, SUBJECTS, TABS, Subject, Tab, tab_index


@pytest.mark.parametrize("subject", SUBJECTS, ids=lambda subject: subject.key)
def test_what_a_subject_names_is_there(subject: Subject) -> None:
    if subject.command:
        commands = argparse.ArgumentParser().add_subparsers()
        subject.load("command").add_to(commands)
        assert commands.choices
    if subject.ahead:
        assert asyncio.iscoroutinefunction(subject.load("ahead"))
    if subject.report:
        named = ("sections", "another_design", "study") if subject.key in OF_DESIGNS else ("sections",)
        assert all(callable(getattr(subject.load("report"), name)) for name in named)


def test_every_room_is_registered_and_no_other() -> None:
    rooms = {path.parent.name for path in Path(app.subjects.__file__).parent.glob("*/__init__.py")}
    assert {subject.key for subject in SUBJECTS} == rooms
    assert list(STUDIES) == ["simulation", "trajectory", "flown", "sar", "suborbital"]
    assert list(OF_DESIGNS) == [
        "simulation",
        "trajectory",
        "sar",
        "suborbital",
    ]  # what `navbudget report --with` takes


@pytest.mark.parametrize("tab", TABS, ids=lambda tab: tab.address)
def test_every_tab_has_its_page(tab: Tab) -> None:
    assert callable(tab.load().show)


def test_addresses_of_before_lead_to_their_new_place() -> None:
    before = ["budget", "simulate", "trajectory", "sar", "suborbital", "explore", "sensors", "review", "theory"]
    places = [tab_index(address) for address in before]
    assert [TABS[place].title for place in places if place is not None] == (
        ["Budget", "Simulate", "Flight", "Image", "Suborbital", "Close it", "Sensors", "Review", "Theory"]
    )
    assert tab_index("nonsense") is None


def test_reading_the_registry_loads_no_subject() -> None:
    script = (
        "import sys, app.subjects; "
        "print([name for name in sys.modules if name.startswith(('app.subjects.', 'numpy', 'panel'))])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
