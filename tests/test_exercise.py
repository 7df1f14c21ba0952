"""The exercises of CONTRIBUTING.md, step by step on a copy of the tree: what it prints is what happens."""

import ast
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.long

ROOT = Path(__file__).parents[1]
PROGRAMS = {"navbudget": f"{sys.executable} -m app", "python": sys.executable}
WALKING = (
    "tests/nav_model/budget/test_figures.py",
    "tests/nav_model/budget/test_shares.py",
    "tests/nav_model/design/test_help.py",
    "tests/nav_model/trajectory/test_every_source.py",
    "tests/app/subjects/budget/test_tables.py",
    "tests/test_docs.py::test_the_contract_names_every_figure",
)
"""Tests that walk the declarations of figures and inputs."""


def _steps(title: str) -> list[str]:
    text = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
    exercise = re.search(rf"^## {title}.*?^## ", text, re.M | re.S)
    assert exercise
    return re.split(r"^(?=\*\*\d\. )", exercise[0], flags=re.M)[1:]


def _copy(tree: Path) -> None:
    away = shutil.ignore_patterns("__pycache__")
    for folder in ("nav_model", "app", "tests", "docs", "examples"):
        shutil.copytree(ROOT / folder, tree / folder, symlinks=True, ignore=away)
    for name in ("pyproject.toml", "README.md", "CONTRIBUTING.md", "CHANGELOG.md"):
        shutil.copy(ROOT / name, tree / name)


def _insert(file: Path, text: str, code: str) -> None:
    """Put a block of code where the step says: after a declaration, or at the end."""
    source = file.read_text("utf-8")
    if "at the end of" in text:
        file.write_text(f"{source}\n\n{code}", "utf-8")
        return
    (name,) = re.findall(r"after `(\w+)`", text)
    (end,) = (
        node.end_lineno
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == name
    )
    lines = source.splitlines(keepends=True)
    file.write_text("".join([*lines[:end], code, *lines[end:]]), "utf-8")


def _replace(file: Path, diff: str) -> None:
    """Change a file as the hunks of a diff say."""
    for hunk in re.split(r"^@@.*\n", diff, flags=re.M):
        lines = hunk.splitlines(keepends=True)
        old, new = ("".join(line[1:] for line in lines if line[0] in signs) for signs in (" -", " +"))
        source = file.read_text("utf-8")
        assert source.count(old) == 1, old
        file.write_text(source.replace(old, new), "utf-8")


def _call(tree: Path, *command: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(tree)}
    return subprocess.run(command, cwd=tree, env=environment, capture_output=True, text=True, check=False)


def _run(tree: Path, block: str) -> None:
    """Each command of a block, with what it prints; without that it must succeed, or fail where the block says so."""
    for command, printed in re.findall(r"^\$ (.+)\n((?:[^$\n].*\n)*)", block, re.M):
        if command.startswith("make run"):
            continue
        script = re.sub(r"\.venv/bin/(\w+)", lambda match: PROGRAMS[match[1]], command)
        done = _call(tree, "bash", "-c", script)
        output = done.stdout + done.stderr
        if printed:
            assert output == printed, command
        else:
            assert bool(done.returncode) == command.endswith("# fails"), f"{command}\n{output}"


@pytest.fixture(scope="module")
def exercised(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[set[str]]]:
    """A copy with the three exercises done, one after another, and the files that each touched."""
    tree, touched = tmp_path_factory.mktemp("tree"), []
    _copy(tree)
    for title in ("A first change", "A second change", "A third change"):
        files = set()
        for step in _steps(title):
            for text, kind, block in re.findall(r"(.*?)^```(\w+)\n(.*?)^```", step, re.M | re.S):
                if kind == "console":
                    _run(tree, block)
                    continue
                name = re.findall(r"`([\w/]+\.(?:py|md))`", text)[0]
                files.add(name)
                if kind == "diff":
                    _replace(tree / name, block)
                else:
                    _insert(tree / name, text, block)
        touched.append(files)
    return tree, touched


def test_the_exercises_go_as_printed_in_three_files_each(exercised: tuple[Path, list[set[str]]]) -> None:
    tree, touched = exercised
    assert [len(files) for files in touched] == [3, 3, 3]
    code = sorted(name for files in touched for name in files if name.endswith(".py"))
    for check in (("check",), ("format", "--check")):
        done = _call(tree, sys.executable, "-m", "ruff", *check, *code)
        assert done.returncode == 0, done.stdout


def test_the_tests_that_walk_declarations_stay_green(exercised: tuple[Path, list[set[str]]]) -> None:
    tree, _ = exercised
    done = _call(tree, sys.executable, "-m", "pytest", "-p", "no:benchmark", "-q", *WALKING)
    assert done.returncode == 0, done.stdout


EVERYWHERE = r"""
import io
import openpyxl
from app.report.comparison import difference_tables
from app.report.spreadsheet import workbook_bytes
from app.subjects.budget.key_figures import key_figures
from app.subjects.budget.tables import processing_table, requirement_table
from nav_model import analyse
from nav_model.budget.allocation import allocate
from nav_model.budget.json import to_json
from nav_model.design.file import parse_design
from nav_model.explore.rank import rank
from nav_model.explore.solve import solve
from nav_model.explore.sweep import whole_sweep
from nav_model.explore.sweep_plan import parse_plan
from nav_model.explore.trade_map import trade_map

NAME, LABEL = "ground_range_shift", "Ground range shift"
FILE = '''
[requirements]
ground_range_shift = "5 m"
[[limits]]
name = "tighter"
on = "ground_range_shift"
limit = "2 m"
confidence = 2
[[contributors]]
name = "map"
value = "0.4 m"
enters = "ground_range_shift"
[processing]
mode = "MODE"
'''
SWEEP = '''
design = { processing = { mode = "MODE" } }
results = ["ground_range_shift"]
[vary]
gnss.position_noise = ["1 cm", "1 m"]
'''


def labels(table):
    return [getattr(row[0], "text", row[0]) for row in table.rows]


for mode in ("real time", "post-processed"):
    design = parse_design(FILE.replace("MODE", mode).encode(), "design")
    budget, plain = analyse(design), analyse(design.replace({}, entries=type(design.entries)()))
    figure = budget.figure(NAME)
    assert abs(figure.sigma - (plain.figure(NAME).sigma ** 2 + 0.4**2) ** 0.5) < 1e-12  # the contributor enters
    assert abs(sum(figure.shares.values()) - 1) < 1e-9 and figure.shares["map"] > 0
    checks = {check.name: check for check in budget.verdict.checks}
    assert checks[NAME].value == figure.sigma and checks["tighter"].value == 2 * figure.sigma
    assert LABEL in [tile.label for tile in key_figures(budget).items]
    assert LABEL in labels(processing_table(budget))
    assert LABEL in labels(requirement_table(budget))
    assert LABEL in labels(difference_tables([budget, plain], ["A", "B"])[1])
    book = openpyxl.load_workbook(io.BytesIO(workbook_bytes(budget)), data_only=True)
    assert LABEL in [row[0].value for row in book["Budget"].iter_rows()]
    key = mode.replace(" ", "_").replace("-", "_")
    assert to_json(budget)["figures"][key][NAME + "_sigma_m"] == figure.sigma
    assert {entry.source for entry in allocate(budget, NAME).entries} >= {"GNSS noise", "map"}
    assert any(item.key == "gnss.position_noise" and item.slope > 0 for item in rank(design, NAME))
    assert {answer.requirement for answer in solve(design)[0].each} == {NAME, "tighter"}
    assert trade_map(design, "imu.angle_random_walk", "gnss.position_noise", NAME, size=4).z.shape == (4, 4)
    assert len(whole_sweep(parse_plan(SWEEP.replace("MODE", mode).encode()))[NAME + "_sigma_m"]) == 2
print("everywhere")
"""


def test_a_figure_is_in_everything_that_reads_figures(exercised: tuple[Path, list[set[str]]]) -> None:
    tree, _ = exercised
    done = _call(tree, sys.executable, "-c", EVERYWHERE)
    assert done.stdout == "everywhere\n", done.stderr
