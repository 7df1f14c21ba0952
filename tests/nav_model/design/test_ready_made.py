"""Ready-made contributors, against their formulas written out."""

import math

import pytest

from nav_model import Design, InputError
from nav_model.design.figures import FIGURES
from nav_model.design.ready_made import READY_MADE, ready_made
from nav_model.design.user_entries import UserEntries, read_entries

_DESIGN = Design({"radar.slant_range": 7000.0, "radar.grazing_angle": 0.6, "flight.speed": 120.0})
_CASES = {
    "lever arm, measured": (("2 mm", "1°"), 2e-3 * math.pi / 180),
    "lever arm, flexure": (("1 mm", "2 °/s"), 1e-3 * 2 * math.pi / 180),
    "time tag, offset": (("0.1 ms",), 1e-4 * 120),
    "time tag, jitter": (("10 ms", "0.1 g"), 1e-2 * 0.980665),
    "boresight": (("3 mrad", "4 mrad"), 5e-3),
    "antenna phase centre": (("0.5 mm", "1.2 mm"), 1.3e-3),
    "atmospheric path": (("5 mm",), 5e-3 / math.sin(0.6)),
    "scene height": (("10 m", "0.5 m"), 10 * 0.5 / (7000 * math.cos(0.6))),
}  # fmt: skip


@pytest.mark.parametrize("name", READY_MADE)
def test_each_is_its_formula_and_an_ordinary_contributor(name: str) -> None:
    texts, expected = _CASES[name]
    contributor = ready_made(name, texts, _DESIGN)
    assert contributor.value == pytest.approx(expected, rel=5e-4)  # as it is shown
    assert (contributor.name, contributor.enters) == (name, READY_MADE[name].enters)
    assert all(text in contributor.source for text in texts)
    assert "[P-16]" in contributor.source
    assert read_entries({"contributors": [contributor.record()]}).contributors == (contributor,)
    again = ready_made(name, texts, _DESIGN.replace({}, entries=UserEntries((contributor,))))
    assert again.name == f"{name} 2"


def test_the_list_enters_figures_that_there_are() -> None:
    assert set(_CASES) == set(READY_MADE)
    assert {made.enters for made in READY_MADE.values()} <= set(FIGURES)


@pytest.mark.parametrize(
    ("given", "named"),
    [
        (("lever arm", ["1 mm", "1°"]), "contributor"),
        (("boresight", ["1 mm", "1°"]), "Calibration error"),
        (("boresight", ["1°", ""]), "Drift since calibration"),
        (("time tag, offset", ["-1 ms"]), "contributors[time tag, offset].value"),
        (("atmospheric path", ["1 mm"]), "contributors[atmospheric path].value"),
    ],
)
def test_what_is_wrong_is_refused_by_name(given: tuple[str, list[str]], named: str) -> None:
    with pytest.raises(InputError) as refused:
        ready_made(*given, _DESIGN.replace({"radar.grazing_angle": 0.0}))
    assert refused.value.key == named
