"""The one registry of subjects: what it names is there, and reading it costs nothing."""

import argparse
import asyncio
import subprocess
import sys
from pathlib import Path

import pytest

import app.subjects
from app.subjects import STUDIES, SUBJECTS, Subject


@pytest.mark.parametrize("subject", SUBJECTS, ids=lambda subject: subject.key)
def test_what_a_subject_names_is_there(subject: Subject) -> None:
    assert callable(subject.load("page").show)
    if subject.command:
        commands = argparse.ArgumentParser().add_subparsers()
        subject.load("command").add_to(commands)
        assert commands.choices
    if subject.ahead:
        assert asyncio.iscoroutinefunction(subject.load("ahead"))
    if subject.report:
        named = ("sections", "another_design", "study") if subject.study else ("sections",)
        assert all(callable(getattr(subject.load("report"), name)) for name in named)


def test_every_room_is_registered_and_no_other() -> None:
    rooms = {path.parent.name for path in Path(app.subjects.__file__).parent.glob("*/__init__.py")}
    assert {subject.key for subject in SUBJECTS} == rooms
    assert list(STUDIES) == ["simulation", "trajectory", "sar", "suborbital"]  # what `navbudget report --with` takes


def test_addresses_of_the_pages_stay() -> None:
    addresses = [subject.title.lower() for subject in SUBJECTS]
    assert addresses == (
        ["budget", "simulate", "trajectory", "sar", "suborbital", "explore", "sensors", "review", "theory"]
    )


def test_reading_the_registry_loads_no_subject() -> None:
    script = (
        "import sys, app.subjects; "
        "print([name for name in sys.modules if name.startswith(('app.subjects.', 'numpy', 'panel'))])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
