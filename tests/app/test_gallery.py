"""The examples of the product are those of the repository, and each teaches something."""

from pathlib import Path

import pytest

from app.gallery import EXAMPLES, example, gallery
from nav_model.budget import analyse

ROOT = Path(__file__).parents[2]


def test_the_package_carries_the_repositorys_examples():
    ours, theirs = (sorted(folder.glob("*.toml")) for folder in (ROOT / "app" / "examples", ROOT / "examples"))
    assert [path.name for path in ours] == [path.name for path in theirs]
    assert [path.read_bytes() for path in ours] == [path.read_bytes() for path in theirs]
    assert {f"{name}.toml" for name in EXAMPLES} == {path.name for path in ours}


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_says_how_it_stands(name):
    """What its description claims is what the analysis says."""
    design = example(name)
    verdict = analyse(design).verdict
    assert verdict.tightest is not None
    assert ("does not close" in design.description) == (not verdict.closes)


def test_a_press_puts_an_example_in_force():
    adopted = []
    view = gallery(adopted.append)
    buttons = list(view.select(lambda part: type(part).__name__ == "Button"))
    assert [button.label for button in buttons] == [f"Open {example(name).name}" for name in EXAMPLES]
    buttons[2].clicks += 1
    assert adopted == [example(EXAMPLES[2])]
