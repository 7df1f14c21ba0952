"""The exercise of CONTRIBUTING.md, step by step on a copy of the tree: what it prints is what happens."""

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
EXERCISE = re.search(r"^## A first change.*?^## ", (ROOT / "CONTRIBUTING.md").read_text("utf-8"), re.M | re.S)


def _steps() -> list[str]:
    assert EXERCISE
    return re.split(r"^(?=\*\*\d\. )", EXERCISE[0], flags=re.M)[1:]


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
    old, new = ("".join(line[1:] for line in diff.splitlines(True) if line[0] == sign) for sign in "-+")
    source = file.read_text("utf-8")
    assert source.count(old) == 1
    file.write_text(source.replace(old, new), "utf-8")


def _run(tree: Path, block: str) -> None:
    """Each command of a block, with what it prints; without that it must succeed, or fail where the block says so."""
    for command, printed in re.findall(r"^\$ (.+)\n((?:[^$\n].*\n)*)", block, re.M):
        if command.startswith("make run"):
            continue
        own = re.sub(r"\.venv/bin/(\w+)", lambda found: PROGRAMS[found[1]], command)
        done = subprocess.run(
            ["bash", "-c", own],
            cwd=tree, env={**os.environ, "PYTHONPATH": str(tree)}, capture_output=True, text=True, check=False,
        )  # fmt: skip
        said = done.stdout + done.stderr
        if printed:
            assert said == printed, command
        else:
            assert bool(done.returncode) == command.endswith("# fails"), f"{command}\n{said}"


def test_the_exercise_goes_as_printed(tmp_path: Path) -> None:
    away = shutil.ignore_patterns("__pycache__")
    for folder in ("nav_model", "app", "tests/nav_model", "tests/support", "examples"):
        shutil.copytree(ROOT / folder, tmp_path / folder, symlinks=True, ignore=away)
    for name in ("pyproject.toml", "tests/conftest.py"):
        shutil.copy(ROOT / name, tmp_path / name)
    changed = set()
    for step in _steps():
        for text, kind, block in re.findall(r"(.*?)^```(\w+)\n(.*?)^```", step, re.M | re.S):
            if kind == "console":
                _run(tmp_path, block)
                continue
            file = tmp_path / re.findall(r"`([\w/]+\.py)`", text)[0]
            changed.add(file)
            if kind == "diff":
                _replace(file, block)
            else:
                _insert(file, text, block)
    assert len(changed) == 3
    subprocess.run([sys.executable, "-m", "ruff", "check", *changed], cwd=tmp_path, check=True)
    subprocess.run([sys.executable, "-m", "ruff", "format", "--check", *changed], cwd=tmp_path, check=True)
