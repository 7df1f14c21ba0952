"""Lines of a chart are told apart in grey and by colour-blind eyes; each stands out from a light and a dark page."""

import itertools

import numpy as np
import pytest

from app.charts.kinds import Chart
from app.charts.styles import DASHES, STYLES
from app.examples import EXAMPLES, example
from app.report.comparison import phase_comparison, position_comparison
from app.subjects.budget import charts as budget_charts
from app.ui.theme import DARK, LIGHT
from nav_model.budget import analyse

# What stands in one chart together: the budget's and the comparison's charts say it themselves below.
TOGETHER = {
    "simulation": ("simulated", "simulated, second axis", "filter", "formula", "formula, second axis"),
    "attitude": ("simulated, tilt", "simulated, yaw", "filter", "formula", "formula, second axis"),
    "outage": ("simulated", "simulated, second axis", "filter", "formula", "refined", "worst run",
               "worst run, second axis"),
    "consistency": ("x", "y", "initial tilt", "z", "reference"),
    "ensemble": ("simulated", "filter, second axis", "worst run, second axis", "formula"),
    "flight": ("simulated", "simulated, second axis", "third axis"),
    "along a flight": ("horizontal", "horizontal refined", "vertical", "vertical refined"),
    "along a flight, attitude": ("tilt", "tilt refined", "simulated, yaw", "yaw"),
    "along a flight, figure": ("exact", "asymptote", "limit"),
    "along a flight, map": ("reference", "closes", "this design", "does not close"),
    "strategies, INS": ("strategy 1", "strategy 2", "strategy 3", "strategy 5", "strategy 5w"),
    "strategies, filters": ("strategy 1", "strategy 4", "strategy 6", "strategy 7", "strategy 8",
                            "strategy 9"),
    "margins": ("limit", "exact", "reference"),
    "suborbital sources": ("accelerometers", "gyros", "initial position and velocity", "initial attitude",
                           "everything"),
    "suborbital channel": ("INS alone", "INS with tracker", "decoupled, holds", "decoupled, fails",
                           "formula, holds", "formula, fails", "reference"),
    "suborbital axes": ("axis x", "axis y", "axis z", "axis x, tracker", "axis y, tracker", "axis z, tracker"),
    "Allan, three axes": ("x", "y", "z", "fit x", "fit y", "fit z"),
    "Allan, one axis": ("measured", "quantization", "random_walk", "bias_instability", "rate_random_walk", "ramp",
                        "fit"),
    "point target": ("reference", "quadratic", "with cubic", "compared"),
    "timelines, post-processed": ("horizontal", "horizontal refined", "vertical", "vertical refined", "limit"),
    "timelines, attitude": ("tilt", "tilt, real time", "yaw", "limit"),
    "designs": tuple(f"design {i}" for i in range(1, 8)),
}  # fmt: skip
POINTS = {"path", "mark", "star", "measured star", "this design"}  # drawn as points, or alone


EYES = {
    "common": np.eye(3),
    "protanopia": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
    "deuteranopia": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    ),
    "tritanopia": np.array(
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]
    ),
}
"""What an eye makes of linear RGB: Machado, Oliveira and Fernandes, IEEE TVCG 15(6), 2009, table for severity 1.0."""


def luminance(colour, eye="common"):
    """Relative luminance of WCAG 2.1, as an eye sees the colour."""
    part = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    linear = np.where(part <= 0.04045, part / 12.92, ((part + 0.055) / 1.055) ** 2.4)
    return float(np.clip(EYES[eye] @ linear, 0.0, 1.0) @ (0.2126, 0.7152, 0.0722))


def lightness(colour, eye):
    """L* of CIE 1976: equal steps look equal; what is left of a colour in grey."""
    return 116 * luminance(colour, eye) ** (1 / 3) - 16


def separable(a, b):
    wider, thinner = max(a.width, b.width), min(a.width, b.width)
    if a.dash != b.dash or wider >= 1.5 * thinner:
        return True
    return all(abs(lightness(a.colour, eye) - lightness(b.colour, eye)) >= 12 for eye in EYES)


def confused(names):
    return [(a, b) for a, b in itertools.combinations(sorted(set(names)), 2) if not separable(STYLES[a], STYLES[b])]


@pytest.mark.parametrize("chart", TOGETHER)
def test_lines_of_a_chart_differ_in_grey_and_for_every_eye(chart):
    assert confused(TOGETHER[chart]) == []


def test_lines_of_the_budgets_charts_differ_in_grey():
    budget = analyse(example(EXAMPLES[0]))
    charts = [draw(budget) for draw in budget_charts.BUDGET_CHARTS]
    charts += [draw([budget] * 6, [f"D{i}" for i in range(6)]) for draw in (position_comparison, phase_comparison)]
    seen = set()
    for chart in charts:
        if isinstance(chart, Chart):
            names = [line.style for line in chart.lines] + (["limit"] if chart.limits else [])
            assert confused(names) == [], chart.key
            seen |= set(names)
    keys = seen.union(*TOGETHER.values()) | POINTS | {"limit", "tilt", "yaw", "turn"}
    assert set(STYLES) <= keys | {"reference", "exact", "asymptote", "quadratic", "with cubic", "mark"}


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("name", STYLES)
def test_a_line_stands_out_from_the_page(name, eye):
    """Contrast of at least 3 to white and to the dark page (WCAG 2.1, 1.4.11); nine tenths of it for other eyes."""
    brightness = luminance(STYLES[name].colour, eye)
    for theme in (LIGHT, DARK):
        page = luminance(theme["palette"]["background"]["paper"], eye)
        high, low = max(brightness, page), min(brightness, page)
        assert (high + 0.05) / (low + 0.05) >= (3.0 if eye == "common" else 2.7)


def test_dashes_are_not_each_other_shifted():
    """A pattern repeats, so one that is another begun later looks the same."""

    def turns(pattern):
        parts = pattern.split()
        return {" ".join(parts[i:] + parts[:i]) for i in range(0, max(len(parts), 1), 2)} | {
            " ".join(parts[i:] + parts[:i]) for i in range(max(len(parts), 1))
        }

    for a, b in itertools.combinations(DASHES.values(), 2):
        assert b not in turns(a)
