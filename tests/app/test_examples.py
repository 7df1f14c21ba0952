"""The examples are those of the package, and each teaches something."""

import pytest
from known_designs import ROOT

from app.examples import EXAMPLES, description_of, example
from nav_model.budget import analyse


def test_the_repositorys_examples_are_links_to_the_packages():
    ours = sorted((ROOT / "app" / "examples").glob("*.toml"))
    assert {f"{name}.toml" for name in EXAMPLES} == {path.name for path in ours}
    assert [path.resolve() for path in sorted((ROOT / "examples").glob("*.toml"))] == ours


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_says_how_it_stands(name):
    """What its description claims is what the analysis says."""
    design = example(name)
    verdict = analyse(design).verdict
    assert verdict.tightest is not None
    assert ("does not close" in design.description) == (not verdict.closes)


def test_an_examples_words_are_not_said_of_another_design() -> None:
    known = example(EXAMPLES[0])
    assert description_of(known) == known.description
    assert description_of(known.replace({"name": "Ours"})) == known.description
    changed = known.replace({"imu.angle_random_walk": 1e-6})
    assert description_of(changed) == ""
    assert description_of(changed.replace({"description": "It closes."})) == "It closes."
