"""A figure has one formula: what it says, every reader says."""

from collections.abc import Callable
from typing import Any

import pytest

from app.report.workings import Traces
from nav_model import analyse, read_design
from nav_model.budget.figures import figures
from nav_model.budget.filter_figures import FilterFigures
from nav_model.budget.inputs import inputs_of
from nav_model.budget.json import to_json
from nav_model.budget.real_time import RealTime
from nav_model.budget.smoothed import Smoothed
from nav_model.design import Design
from nav_model.design.figures import FIGURES, OF_BUDGET
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.explore.sweep import whole_sweep
from nav_model.explore.sweep_plan import parse_plan

DESIGN = read_design("examples/mems_x_band.toml").replace(
    {
        "motion.unsensed_lines": ((20.0, 1e-4, "length"),),
        "imu.gyro_bias": 1e-6,
        "processing.scene_height_error": 1.0,
    }
)


def doubled(formula: Any) -> Any:
    """A formula, of a property or of a method, that gives twice as much."""
    if callable(formula):
        return lambda self, *arguments: 2 * formula(self, *arguments)
    read: Callable[[Any], Any] = formula.__get__
    return property(lambda self: 2 * read(self))


def readings(design: Design, name: str) -> dict[str, float]:
    """The figure as each reader has it, 1σ in SI."""
    column, mode = FIGURES[name].column, design.processing.mode
    table = to_json(analyse(design))["figures"]
    plan = (
        f'results = ["{name}"]\ndesign = {{ processing = {{ mode = "{mode}" }} }}\n[vary]\ngnss.interval = ["1 s"]\n'
    )
    swept = whole_sweep(parse_plan(plan.encode())) if FIGURES[name].kind != "level" else {column: [0.0]}
    read = {
        "page": analyse(design).figure(name).sigma,
        "JSON": table[mode.replace(" ", "_").replace("-", "_")][column],
        "map and solve": float(figures(inputs_of(design), [name])[name]),
        "sweep": float(swept[column][0]),
    }
    # The workbook has no cell of the orders of autofocus, of the response, nor of smoothed parts of phases.
    smoothed = mode == POST_PROCESSED and FIGURES[name].smoothed_mark
    cell = Traces(design).workings.named.get(f"{'post_processed' if smoothed else 'real_time'}_{name}")
    return read if cell is None else read | {"workbook": cell.value}


@pytest.mark.parametrize("mode", [REAL_TIME, POST_PROCESSED])
@pytest.mark.parametrize("name", OF_BUDGET)
def test_twice_a_formula_is_twice_the_figure_everywhere(
    name: str, mode: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    design = DESIGN.replace({"processing.mode": mode})
    before = readings(design, name)
    assert before["page"] == pytest.approx(before["JSON"]) == pytest.approx(before["map and solve"])
    assert before.get("workbook", before["page"]) == pytest.approx(before["page"])
    for model in (FilterFigures, RealTime, Smoothed):
        if name in vars(model):
            monkeypatch.setattr(model, name, doubled(vars(model)[name]))
    after = readings(design, name)
    for reader, value in after.items():
        assert value == pytest.approx(2 * before[reader], rel=1e-9), reader
