"""The design's inputs without a browser: what is typed, slid and chosen reaches the design; what is refused does
not."""

import pytest

from app.dashboard.controls import design_groups, input_of
from app.session import Session
from app.ui.input_sheet import Group, InputSheet, Row
from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.units import parse_quantity
from nav_model.design import Design
from nav_model.design.declaration import BaseQuantity, Choice
from nav_model.design.parts import PRESET_KEYS, all_keys, declaration_of
from nav_model.design.table import Table

QUANTITIES = [key for key in all_keys() if isinstance(declaration_of(key), BaseQuantity)]
_BAD = [
    "5 kg", "-1", "nan", "inf", "1e400", "1e99", "abc", "--1", "1 2", "1,500", "0x10", "=1+1", "½", "1e", ".",
    "1 m m", "<script>alert(1)</script>", "1 °/√h/h/h", "\x00", "∞", "1" * 5000,
]  # fmt: skip
_SIGNED = {  # -1 is right
    key for key in QUANTITIES if declaration_of(key).limits[0] < 0 or declaration_of(key).dimension == "level"
}
TABLES = [key for key in all_keys() if isinstance(declaration_of(key), Table)]


@pytest.fixture
def session() -> Session:
    return Session(Design())


class Sheet(InputSheet):
    """A sheet of some inputs, which follows the session as the sidebar has it follow."""

    def __init__(self, session: Session, *keys: str) -> None:
        super().__init__([Group("", [input_of(session, key) for key in keys])])
        session.param.watch(lambda _: self.follow(), "budget")

    def row(self, key: str) -> Row:
        """All that the browser has of a row."""
        (fixed,) = (row for row in self.groups[0]["rows"] if row["key"] == key)
        return {**fixed, **self.news.get(key, {})}


def test_an_empty_box_says_what_holds_instead(session: Session) -> None:
    """Only a requirement that is left empty is not checked."""
    defaults = {key: input_of(session, key).row()["empty"] for key in QUANTITIES if declaration_of(key).allow_None}
    assert {key.partition(".")[0] for key, text in defaults.items() if text == "not checked"} == {"requirements"}
    assert all(defaults.values())


@pytest.mark.parametrize("key", QUANTITIES)
def test_refused_text_is_said_at_the_field_and_changes_nothing(session: Session, key: str) -> None:
    sheet = Sheet(session, key)
    budget = session.budget
    for text in _BAD:
        if key in _SIGNED and text == "-1":
            continue
        sheet.forget_refusals()
        assert sheet.invalid == 0
        sheet.enter(key, text)
        assert session.budget is budget, text
        assert 0 < len(sheet.row(key)["error"]) < 400, text
        assert sheet.invalid == 1


@pytest.mark.parametrize("key", QUANTITIES)
def test_good_text_reaches_the_design_and_clears_the_message(session: Session, key: str) -> None:
    sheet, declaration = Sheet(session, key), declaration_of(key)
    sheet.enter(key, "rubbish")
    low, high = declaration.softbounds
    wanted = declaration.show((low * high) ** 0.5 if low > 0 else high / 2)
    sheet.enter(key, wanted)
    assert sheet.row(key)["error"] == ""
    expected = parse_quantity(wanted, declaration.dimension).value if declaration.dimension else float(wanted)
    assert session.design[key] == expected


def test_a_refused_text_goes_when_the_value_becomes_another(session: Session) -> None:
    sheet = Sheet(session, "gnss.interval", "gnss.position_noise")
    sheet.enter("gnss.interval", "5 kg")
    session.change({"gnss.position_noise": 2.0})
    assert sheet.row("gnss.interval")["error"]
    session.change({"gnss.interval": 2.0})
    assert sheet.row("gnss.interval")["error"] == ""
    assert sheet.row("gnss.interval")["text"] == "2 s"


def test_a_box_says_what_was_made_of_a_number_as_printed(session: Session) -> None:
    key = "gnss.position_noise"
    sheet = Sheet(session, key, "gnss.baseline")
    sheet.enter(key, "±0.2 m (CEP)")
    assert session.design[key] == pytest.approx(0.2 / 1.17741, rel=1e-6)
    assert sheet.row(key)["text"] == "0.2 m CEP"
    assert sheet.row(key)["note"] == "0.2 m CEP = 0.170 m, 1σ per axis."
    sheet.enter(key, "0.4")  # a bare number is one more of what the box shows
    assert sheet.row(key)["text"] == "0.4 m CEP"
    sheet.enter(key, "1 cm + 1 ppm")
    assert "Give gnss.baseline" in sheet.row(key)["error"]
    sheet.enter("gnss.baseline", "10 km")
    sheet.enter(key, "1 cm + 1 ppm")
    assert session.design[key] == 0.02
    sheet.enter("gnss.baseline", "30 km")
    assert sheet.row(key)["note"] == "1 cm + 1 ppm = 4.00 cm, 1σ per axis."
    sheet.enter("gnss.baseline", "")
    assert "grows with the baseline" in sheet.row("gnss.baseline")["error"]
    sheet._handle_msg({"key": key, "place": -1.0, "number": 1})  # the slider moves a plain number
    assert sheet.row(key)["text"] == "10 cm"
    assert sheet.row(key)["note"] == ""


@pytest.mark.parametrize("key", TABLES)
def test_a_table_is_typed_refused_and_taken_away(session: Session, key: str) -> None:
    sheet, declaration = Sheet(session, key), declaration_of(key)
    sheet.enter(key, declaration.example)
    assert session.design[key] == declaration.read(declaration.example)
    assert session.design[key]
    budget = session.budget
    for text in ("20 Hz", "20 Hz 1 s", "0 Hz 1 g; 5 Hz 1 g", "rubbish", "20 Hz nan g", "20 Hz 1 g;" * 61):
        sheet.enter(key, text)
        assert session.budget is budget, text
        assert 0 < len(sheet.row(key)["error"]) < 400, text
    sheet.enter(key, "")
    assert session.design[key] == ()
    assert sheet.row(key)["error"] == ""
    assert sheet.row(key)["help"] == str(declaration.doc)
    session.change({key: declaration.read(declaration.example)})
    assert declaration.read(sheet.row(key)["text"]) == session.design[key]


def test_an_empty_box_takes_a_requirement_away(session: Session) -> None:
    sheet = Sheet(session, "requirements.quadratic_phase")
    sheet.enter("requirements.quadratic_phase", "45°")
    assert len(session.budget.verdict.checks) == 1
    sheet.enter("requirements.quadratic_phase", "")
    assert session.budget.verdict.checks == ()


@pytest.mark.parametrize("key", [key for key in QUANTITIES if declaration_of(key).dimension])
def test_every_unit_converts_and_leaves_the_value(session: Session, key: str) -> None:
    sheet, declaration = Sheet(session, key), declaration_of(key)
    value, kind = session.design[key], DIMENSIONS[declaration.dimension]
    assert [unit for unit, _ in sheet.row(key)["units"]] == ([] if kind.decibels else list(kind.units))
    for unit, factor in sheet.row(key)["units"]:
        sheet._handle_msg({"key": key, "unit": unit, "number": 1})
        assert session.design[key] == value
        assert session.design.unit(key) == sheet.row(key)["unit"] == unit
        if value is not None:
            number = float(sheet.row(key)["text"].removesuffix(unit))
            assert [number, number * factor] == pytest.approx([value / factor, value], rel=1e-11)
    assert not session.can_undo


def test_a_sum_of_floats_reads_as_it_was_meant(session: Session) -> None:
    sheet = Sheet(session, "imu.angle_random_walk")
    session.change({"imu.angle_random_walk": 0.036 * 2.908882086657216e-4})
    assert sheet.row("imu.angle_random_walk")["text"] == "0.036 °/√h"


def test_a_slider_sets_a_value_of_three_digits_and_zero_at_its_end(session: Session) -> None:
    sheet, key = Sheet(session, "imu.gyro_bias", "gnss.velocity_noise"), "imu.gyro_bias"
    slider = sheet.row(key)["slider"]
    sheet._handle_msg({"key": key, "place": slider["end"] - 1.0, "number": 1})
    assert session.design.imu.gyro_bias > 0
    assert len(sheet.row(key)["text"].split()[0].replace(".", "").lstrip("0")) <= 3
    sheet._handle_msg({"key": key, "place": slider["start"], "number": 1})
    assert session.design.imu.gyro_bias == 0.0
    assert sheet.row(key)["place"] == slider["start"]
    sheet._handle_msg({"key": key, "place": 1e9, "number": 1})  # no slider goes there
    assert session.design.imu.gyro_bias == pytest.approx(10 ** slider["end"], rel=0.01)
    given = sheet.row("gnss.velocity_noise")
    assert (given["size"], given["place"]) == (None, given["slider"]["end"])


@pytest.mark.parametrize("start", ["0.05 °/√h", "3 m", "5 km"])
def test_a_step_of_a_slider_is_no_step_back(session: Session, start: str) -> None:
    """What comes back is within half a step of where the person is, so the thumb stays under the finger."""
    key = {"°": "imu.angle_random_walk", "m": "gnss.position_noise", "k": "radar.slant_range"}[start.split()[1][0]]
    sheet = Sheet(session, key)
    sheet.enter(key, start)
    place = sheet.row(key)["place"]
    for _ in range(20):
        place += 0.02
        sheet._handle_msg({"key": key, "place": place, "number": 1})
        assert sheet.row(key)["place"] == pytest.approx(place, abs=0.01)


def test_a_preset_fills_and_what_deviates_can_be_taken_back(session: Session) -> None:
    sheet = Sheet(session, "imu.preset", "imu.angle_random_walk")
    sheet.enter("imu.preset", "STIM300")
    assert session.design.imu.preset == "STIM300"
    assert session.design.imu.angle_random_walk == parse_quantity("0.15 °/√h", "angle random walk").value
    assert sheet.row("imu.preset")["said"] == ""
    assert sheet.row("imu.angle_random_walk")["mark"] == "⚠"
    session.change({"imu.angle_random_walk": 1e-4})
    assert sheet.row("imu.preset")["said"] == "1 value changed."
    assert sheet.row("imu.preset")["named"] == "Custom, based on STIM300"
    assert sheet.row("imu.angle_random_walk")["mark"] == "≠"
    assert sheet.row("imu.angle_random_walk")["note"] == "≠ STIM300: 0.15 °/√h"
    sheet.enter("imu.preset", "STIM300")  # as the button does
    assert session.design.imu.angle_random_walk == parse_quantity("0.15 °/√h", "angle random walk").value
    sheet.enter("imu.preset", "")
    assert session.design.imu.preset is None
    sheet.enter("imu.preset", "no such unit")
    assert sheet.row("imu.preset")["error"]


def test_a_radar_brings_its_platform(session: Session) -> None:
    Sheet(session, "radar.preset").enter("radar.preset", "UAVSAR")
    assert session.design.flight.speed == 220.0
    assert session.design.flight.altitude == 13800.0


def test_a_class_of_receivers_follows_its_base_line(session: Session) -> None:
    sheet = Sheet(session, "gnss.preset", "gnss.position_noise", "gnss.baseline")
    sheet.enter("gnss.preset", "RTK")
    assert sheet.row("gnss.position_noise")["note"].startswith("8 mm + 1 ppm DRMS = 12.7 mm, 1σ per axis. Leica")
    sheet.enter("gnss.baseline", "20 km")
    assert sheet.row("gnss.position_noise")["note"].startswith("8 mm + 1 ppm DRMS = 19.8 mm, 1σ per axis. Leica")
    sheet._handle_msg({"key": "gnss.baseline", "place": 4.0, "number": 1})  # the slider, decades of a metre
    assert sheet.row("gnss.position_noise")["note"].startswith("8 mm + 1 ppm DRMS = 12.7 mm")
    sheet.enter("gnss.baseline", "20 km")
    assert not sheet.row("gnss.preset")["said"]
    sheet.enter("gnss.position_noise", "3 cm")
    assert sheet.row("gnss.position_noise")["note"] == "≠ RTK: 8 mm + 1 ppm DRMS"
    assert sheet.row("gnss.preset")["named"] == "Custom, based on RTK class, 20 km base"


def test_a_class_of_receivers_leaves_with_all_it_filled(session: Session) -> None:
    sheet, before = Sheet(session, "gnss.preset", "gnss.position_noise", "gnss.baseline"), session.design
    sheet.enter("gnss.preset", "PPK")
    assert session.design.gnss.correlated
    sheet.enter("gnss.preset", "")
    assert session.design == before.replace({"gnss.position_noise": 1.0})
    assert sheet.row("gnss.position_noise")["text"] == "1 m"
    assert (sheet.row("gnss.baseline")["text"], sheet.row("gnss.preset")["text"]) == ("", "")


def test_every_input_has_a_row_with_help() -> None:
    rows = {each.key: each.row() for group in design_groups(Session(Design()), ()) for each in group.inputs}
    assert set(all_keys()) <= rows.keys()
    assert {key for key, row in rows.items() if not row["help"]} == set(PRESET_KEYS)


def test_the_whole_sheet_comes_with_the_unit_and_goes_with_the_switch(session: Session) -> None:
    sheet = Sheet(session, "imu.preset", "imu.sheet", "gyro.bias_instability", "gyro.turn_on_bias")
    sheet.enter("imu.sheet", "true")
    assert "choose an IMU from the catalogue first" in sheet.row("imu.sheet")["error"]
    sheet.enter("imu.preset", "STIM300")
    assert sheet.row("imu.sheet")["text"] == "true"
    assert sheet.row("gyro.bias_instability")["text"].startswith("0.5")
    assert "TS1524" in sheet.row("gyro.bias_instability")["note"]
    sheet.enter("imu.preset", "HG1700")
    assert sheet.row("gyro.bias_instability")["text"].startswith("0 ")
    assert sheet.row("gyro.turn_on_bias")["text"].startswith("1 ")
    sheet.enter("imu.sheet", "false")
    assert session.design.gyro.turn_on_bias == 0.0
    assert "gyro.turn_on_bias" not in session.design.origins
    sheet.enter("imu.preset", "HG1700")  # as the button does that restores its values
    assert not session.design.imu.sheet
    assert session.design.gyro.turn_on_bias == 0.0
    session.change({"imu.preset": "LN-200"})  # as a file may name one
    sheet.enter("imu.sheet", "true")
    assert session.design.imu.sheet
    sheet.enter("imu.sheet", "false")
    sheet.enter("imu.preset", "STIM300")
    assert session.design.imu.sheet
    assert session.design.gyro.bias_instability > 0.0


def test_every_option_of_a_choice_reaches_the_design(session: Session) -> None:
    session.change({"imu.preset": "STIM300"})  # without a unit there is no sheet
    for key in (key for key in all_keys() if isinstance(declaration_of(key), Choice)):
        sheet = Sheet(session, key)
        for text, label in sheet.row(key)["options"] or [("true", "on"), ("false", "off")]:
            assert label
            sheet.enter(key, text)
            assert sheet.row(key)["text"] == text
            assert str(session.design[key]).lower() == text.lower()
        sheet.enter(key, "something else")
        assert sheet.row(key)["error"]


def test_a_row_says_where_its_value_came_from(session: Session) -> None:
    sheet, origin = Sheet(session, "imu.rate"), "data sheet, page 3"
    session.change({"imu.rate": 250.0}, origins={"imu.rate": origin})
    assert sheet.row("imu.rate")["note"] == f"From: {origin}."
    session.change({"imu.rate": 200.0})
    assert sheet.row("imu.rate")["note"] == ""


def test_each_message_is_answered_and_none_does_harm(session: Session) -> None:
    """The browser waits for an answer before it tells more, whatever became of what it told."""
    key = "imu.angle_random_walk"
    sheet, before = Sheet(session, key, "radar.window"), session.design
    for number, done in enumerate(
        ({"place": "far"}, {"place": float("nan")}, {"unit": "kg"}, {"text": 5}, {}, {"text": "5 kg"}), 1
    ):
        sheet._handle_msg({"key": key, "number": number, **done})
        assert session.design == before
        assert sheet.heard == number
    for message in (
        None,
        [],
        {"key": "no.such"},
        {"key": "no.such", "number": 9, "text": ""},
        {"key": [], "number": 9},
    ):
        sheet._handle_msg(message)
    sheet._handle_msg({"key": "radar.window", "number": 7, "place": 1.0})  # it has no slider
    assert (session.design, sheet.heard) == (before, 7)
    sheet._handle_msg({"key": key, "number": 8, "place": -4.0})
    assert session.design.imu.angle_random_walk == pytest.approx(1e-4, rel=0.01)
    assert sheet.heard == 8
