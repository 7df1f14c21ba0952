"""`from nav_model import ...`: what it offers, what it loads, and that its examples are true."""

import doctest
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import nav_model
import nav_model.base.errors
import nav_model.base.frozen
import nav_model.budget
from nav_model.budget import Budget

ROOT = Path(nav_model.__file__).parent.parent


def test_every_name_of_the_door_is_there_and_no_other():
    assert {getattr(nav_model, name) for name in nav_model.__all__} >= {Budget, nav_model.budget.analyse}
    with pytest.raises(AttributeError, match="no attribute 'bogus'"):
        nav_model.bogus  # noqa: B018
    budget = nav_model.analyse(nav_model.read_design(ROOT / "examples" / "tactical_x_band.toml"))
    assert isinstance(budget, Budget)
    with pytest.raises(nav_model.InputError):
        nav_model.parse_design("[imu]\nbogus = 1\n")


def test_the_door_loads_nothing_before_it_is_asked():
    code = "import sys, nav_model; print([m for m in sys.modules if m.startswith('nav_model.') or m == 'numpy'])"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


MODULES = [nav_model, nav_model.budget, nav_model.base.errors, nav_model.base.frozen]


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__)
def test_the_examples_in_docstrings_are_true(module):
    result = doctest.testmod(module)
    assert result.attempted > 0
    assert result.failed == 0


QUESTIONS = sorted(
    name
    for name in nav_model.__all__
    if not isinstance(getattr(nav_model, name), type) and not name.startswith(("format_", "parse_", "read_"))
)


@pytest.mark.parametrize("name", QUESTIONS)
def test_every_function_of_the_door_has_an_example_that_is_true(name, monkeypatch):
    monkeypatch.chdir(ROOT)
    function = getattr(nav_model, name)
    (example,) = doctest.DocTestFinder(recurse=False).find(inspect.unwrap(function), name)
    assert example.examples
    assert doctest.DocTestRunner().run(example).failed == 0


def test_the_guide_to_the_library_prints_what_it_says(monkeypatch):
    monkeypatch.chdir(ROOT)
    result = doctest.testfile(str(ROOT / "docs" / "library.md"), module_relative=False)
    assert result.attempted > 10
    assert result.failed == 0
