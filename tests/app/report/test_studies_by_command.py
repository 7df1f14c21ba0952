"""Studies run by the command `report`."""

import argparse

import numpy as np
import pytest
from known_designs import MEMS

from app import cli
from app.examples import example
from app.subjects.simulation import console as simulate_command
from app.subjects.simulation import report as simulation_report
from nav_model.sar.design_study import image_study
from nav_model.sar.strategies import STRATEGIES

pytestmark = [pytest.mark.usefixtures("charts_drawn_once"), pytest.mark.long]


def test_the_command_runs_the_studies_and_tells_them(tmp_path, capsys):
    target = tmp_path / "r.html"
    arguments = ["report", MEMS, "-o", str(target), "--with", "sar", "--runs", "20"]
    assert cli.main([*arguments, "--seed", "5"]) == 0
    page = target.read_text(encoding="utf-8")
    study = image_study(example("mems_x_band"), 20, 5)
    for strategy in STRATEGIES:
        assert strategy.key in page
    assert "".join(study.sentence.split()) in "".join(page.split())
    assert "20 runs of the error model, seed 5" in page
    assert "SAR: 20 of 20 runs" in capsys.readouterr().err


def test_the_default_simulation_of_a_report_flies_the_designs_own_outage(monkeypatch):
    design = example("mems_x_band")
    asked: list[argparse.Namespace] = []
    monkeypatch.setattr(simulate_command, "fly_design", lambda _, options: asked.append(options))
    options = argparse.Namespace(runs=None, seed=1, duration=None, outages=[], trajectory="wandering", workers=None)
    simulation_report.study(design, options)
    (flown,) = asked
    spec = simulate_command._specification(design, flown, keep_runs=False)
    assert spec.outages == ((400.0, 400.0 + design.coast.duration),)
    assert np.isclose(spec.duration, 400.0 + design.coast.duration)
