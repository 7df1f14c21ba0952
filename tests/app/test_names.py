"""One quantity has one name in every text that a user reads."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

import app
import nav_model
from app.charts.words import in_words
from app.serving.server import first_design
from app.subjects.budget.charts import response_curves
from app.subjects.budget.timelines import all_timelines
from nav_model.budget import analyse

_SECOND_NAMES = {
    "Detrended phase": r"(?i)residual (phase|rms)|detrended(, rms| residual)",
    "Along-track quadratic phase": r"(?i)along track quadratic",
    "Horizontal position": r"(?i)(position|velocity), (horizontal|vertical)",
    "Horizontal position after the outage": r"(?i)coast (horizontal )?position|^position after|at end of outage",
    "formula": r"(?i)\bclosed[ -]form",
    "IMU": r"(?i)\binertial units?\b",
    "before a fix, after a fix": r"\((prior|closed|posterior)[;)]|(?i:prior to posterior|fix cycle)",
    "value, quantity": r"^Figures? (to|side|stated|of(?! eight)|as)\b|^Figures?$|Where figures",
}
"""Names that a text must not give each of these."""


@cache
def _texts() -> list[tuple[str, str]]:
    """Where, and what: every string of the sources but documentation, and the lines of the tables."""
    texts = []
    for package in (app, nav_model):
        for path in sorted(Path(str(package.__file__)).parent.rglob("*.py")):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            silent = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
            for node in ast.walk(tree):
                if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in silent:
                    texts.append((f"{path.name}:{node.lineno}", node.value))
        for path in sorted(Path(str(package.__file__)).parent.rglob("*.toml")):
            lines = enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
            texts += [(f"{path.name}:{number}", line) for number, line in lines]
    return texts


@pytest.mark.parametrize("name", _SECOND_NAMES)
def test_no_text_has_a_second_name_for_a_quantity(name: str) -> None:
    wrong = [entry for entry in _texts() if re.search(_SECOND_NAMES[name], entry[1])]
    assert not wrong, f"say {name!r}"


def test_no_description_of_a_chart_has_a_second_name() -> None:
    """Such texts are put together, in part from keys."""
    text = " ".join(in_words(chart) for chart in all_timelines(analyse(first_design())))
    assert "imit on horizontal position after the outage" in text
    assert [name for name, second in _SECOND_NAMES.items() if re.search(second, text)] == []


def test_what_rounding_leaves_of_zero_is_told_as_zero() -> None:
    """The error-free target's peak is 0 dB, and lies at 0 m."""
    text = in_words(response_curves(analyse(first_design())))
    assert "highest 0 at 0." in text
    assert "e−" not in text
