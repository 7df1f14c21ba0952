"""Names of edited presets, and what a line keeps together."""

import re

from app.document.pane import prose
from app.document.verdict import verdict_of, verdict_strip
from app.document.wording import preset_name
from app.report.inputs import input_table
from app.serving.server import first_design
from app.subjects.explore.charts import rank_chart
from nav_model.budget import analyse
from nav_model.design.presets import preset_fill
from nav_model.design.user_entries import read_entries


def test_an_edited_preset_is_custom_in_every_place() -> None:
    design = first_design()
    assert preset_name(design, "imu") == "STIM300"
    edited = design.replace({"imu.angle_random_walk": 2 * design.imu.angle_random_walk})
    assert preset_name(edited, "imu") == "Custom, based on STIM300"
    assert preset_name(edited, "gnss") == "own values"
    budget = analyse(edited)
    heads = [row[0].text for row in input_table(edited, budget.sar.aperture_time, "d").rows if len(row) == 1]
    assert any(head.endswith(": Custom, based on STIM300") for head in heads)


def test_a_report_names_the_class_of_the_receiver_and_its_base() -> None:
    """Values of the class with their sources; a typed one says what the class has."""
    values, written = preset_fill("gnss", "RTK", 20e3)
    design = first_design().replace({**values, "gnss.baseline": 20e3}, written)
    edited = design.replace({"gnss.correlation_time": 60.0})
    for each, head in (
        (design, "GNSS: RTK class, 20 km base"),
        (edited, "GNSS: Custom, based on RTK class, 20 km base"),
    ):
        rows = input_table(each, 1.0, "d").rows
        table = {str(getattr(row[0], "text", row[0])): row for row in rows}
        assert head in table
        noise, time = table["Position noise"], table["Correlation time"]
        assert "= 19.8 mm, 1σ per axis" in str(noise[1])
        assert "Leica GS25" in str(noise[2])
        assert ("the preset has 115 s (assumed)" in str(time[2])) == (each is edited)


def test_no_line_ends_between_a_number_and_its_unit_or_within_the_unit() -> None:
    """Browsers end lines at blanks and after strokes."""
    for text in ("at most 0.036 °/√h, or less", "0.06 m/s/√h", "30 µg/√Hz (secondary)", "3 cm/s"):
        html = prose(text)
        free = re.sub('<span class="nw">.*?</span>', "", html)
        assert "/" not in free
        assert not re.search(r"\d [°µm]", free)
        assert re.sub("<.*?>", "", html).replace("\N{NO-BREAK SPACE}", " ") == text


def test_an_abbreviation_and_a_name_of_ones_own_stay_as_they_are_in_a_sentence() -> None:
    entries = read_entries({"limits": [{"name": "lever arm, GNSS to IMU", "on": "tilt", "limit": "0.0001°"}]})
    design = first_design()
    changed = {
        "lever arm, GNSS to IMU": design.replace({}, entries=entries),
        "CE90": design.replace({"requirements.ce90": 1e-3}),
    }
    for name, budget in ((name, analyse(variant)) for name, variant in changed.items()):
        assert verdict_strip(budget).sentences[0].startswith(f"{name} ")
        assert f"Tightest: {name}, " in verdict_of(budget).sentences[1]
    assert rank_chart(design, "ce90").title == "What reduces CE90 most"
