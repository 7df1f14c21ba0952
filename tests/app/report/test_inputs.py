"""The table of inputs."""

from __future__ import annotations

from app.report.inputs import input_table
from nav_model.design import Design
from nav_model.design.parts import INPUTS


def test_only_an_absent_requirement_is_not_checked() -> None:
    rows = input_table(Design(), 5.0, "d").rows
    absent = [(row[0].text, row[2].text) for row in rows if len(row) == 3 and row[1].text == "not given"]
    limits = {str(limit.label) for limit in INPUTS["requirements"].values()}
    assert {label for label, holds in absent if holds == "not checked"} <= limits
    assert dict(absent)["Velocity noise"] == "no velocity"
