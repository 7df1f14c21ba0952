"""Names of edited presets."""

from app.document.wording import preset_name
from app.report.inputs import input_table
from app.serving.server import first_design
from app.subjects.budget.closing import ways
from nav_model.budget import analyse


def test_an_edited_preset_is_custom_in_every_place() -> None:
    design = first_design()
    assert preset_name(design, "imu") == "STIM300"
    edited = design.replace({"imu.angle_random_walk": 2 * design.imu.angle_random_walk})
    assert preset_name(edited, "imu") == "Custom, based on STIM300"
    assert preset_name(edited, "gnss") == "own values"
    budget = analyse(edited)
    heads = [row[0].text for row in input_table(edited, budget.sar.aperture_time, "d").rows if len(row) == 1]
    assert any(head.endswith(": Custom, based on STIM300") for head in heads)
    assert {way.now for way in ways(edited) if way.what == "IMU"} == {"Custom, based on STIM300"}
