"""Controls without a browser: what is typed, slid and chosen reaches the design; what is refused does not."""

from __future__ import annotations

import pytest

from app.dashboard.controls import section_controls
from app.dashboard.controls.choice import ChoiceControl
from app.dashboard.controls.preset import PresetControl
from app.dashboard.controls.quantity import QuantityControl
from app.dashboard.controls.rows import RowsControl
from app.session import Session
from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.units import parse_quantity
from nav_model.design import Design
from nav_model.design.declaration import BaseQuantity
from nav_model.design.parts import INPUTS, all_keys, declaration_of
from nav_model.design.rows import Rows

QUANTITIES = [key for key in all_keys() if isinstance(declaration_of(key), BaseQuantity)]
_BAD = [
    "5 kg", "-1", "nan", "inf", "1e400", "1e99", "abc", "--1", "1 2", "1,500", "0x10", "=1+1", "½", "1e", ".",
    "1 m m", "<script>alert(1)</script>", "1 °/√h/√h", "\x00", "∞", "1" * 5000,
]  # fmt: skip
_SIGNED = {  # -1 is right
    key
    for key in QUANTITIES
    if declaration_of(key).limits[0] < 0 or declaration_of(key).dimension == "level"  # type: ignore[union-attr]
}
TABLES = [key for key in all_keys() if isinstance(declaration_of(key), Rows)]


@pytest.fixture
def session() -> Session:
    return Session(Design())


def test_an_empty_box_says_what_holds_instead(session: Session) -> None:
    """Only a requirement that is left empty is not checked."""
    said = {
        key: QuantityControl(session, key).box.placeholder for key in QUANTITIES if declaration_of(key).allow_None
    }
    assert {key.partition(".")[0] for key, text in said.items() if text == "not checked"} == {"requirements"}
    assert all(said.values())


@pytest.mark.parametrize("key", QUANTITIES)
def test_refused_text_is_said_at_the_field_and_changes_nothing(session: Session, key: str) -> None:
    control = QuantityControl(session, key)
    budget = session.budget
    for text in _BAD:
        if key in _SIGNED and text == "-1":
            continue
        control.box.param.update(error_state=False, helper_text="")  # of the text before
        control.box.value = text
        assert session.budget is budget, text
        assert control.box.error_state, text
        assert control.box.helper_text, text
        assert len(control.box.helper_text) < 400, text


@pytest.mark.parametrize("key", QUANTITIES)
def test_good_text_reaches_the_design_and_clears_the_message(session: Session, key: str) -> None:
    control = QuantityControl(session, key)
    declaration = declaration_of(key)
    assert isinstance(declaration, BaseQuantity)
    control.box.value = "rubbish"
    low, high = declaration.softbounds  # type: ignore[misc]
    wanted = declaration.show((low * high) ** 0.5 if low > 0 else high / 2)
    control.box.value = wanted
    assert not control.box.error_state, control.box.helper_text
    expected = parse_quantity(wanted, declaration.dimension).value if declaration.dimension else float(wanted)
    assert session.design[key] == expected


@pytest.mark.parametrize("key", TABLES)
def test_a_table_is_typed_refused_and_taken_away(session: Session, key: str) -> None:
    control, declaration = RowsControl(session, key), declaration_of(key)
    assert isinstance(declaration, Rows)
    control.box.value = declaration.example
    assert session.design[key] == declaration.read(declaration.example)
    assert session.design[key]
    budget = session.budget
    for text in ("20 Hz", "20 Hz 1 s", "0 Hz 1 g; 5 Hz 1 g", "rubbish", "20 Hz nan g", "20 Hz 1 g;" * 61):
        control.box.value = text
        assert session.budget is budget, text
        assert control.box.error_state, text
        assert len(control.box.helper_text) < 400, text
    control.box.value = ""
    assert session.design[key] == ()
    assert not control.box.error_state
    control.explained = True
    assert str(declaration.doc) in control.box.helper_text
    session.change({key: declaration.read(declaration.example)})
    control.show(session.design)
    assert declaration.read(control.box.value) == session.design[key]


def test_an_empty_box_takes_a_requirement_away(session: Session) -> None:
    control = QuantityControl(session, "requirements.quadratic_phase")
    control.box.value = "45°"
    assert len(session.budget.verdict.checks) == 2  # the along-track term is held against the same limit
    control.box.value = ""
    assert session.budget.verdict.checks == ()


@pytest.mark.parametrize("key", [key for key in QUANTITIES if declaration_of(key).dimension])  # type: ignore[union-attr]
def test_every_unit_converts_and_leaves_the_value(session: Session, key: str) -> None:
    control = QuantityControl(session, key)
    declaration = declaration_of(key)
    assert isinstance(declaration, BaseQuantity)
    assert control.unit is not None
    value = session.design[key]
    for unit in DIMENSIONS[declaration.dimension].units:
        control.unit.value = unit
        assert session.design[key] == value
        assert session.design.unit(key) == unit
        if value is not None:
            assert parse_quantity(control.box.value, declaration.dimension).value == value


def test_a_slider_sets_a_value_of_three_digits_and_zero_at_its_end(session: Session) -> None:
    control = QuantityControl(session, "imu.gyro_bias")
    assert control.slider is not None
    control.slider.value = control.slider.end - 1.0
    assert session.design.imu.gyro_bias > 0
    assert len(control.box.value.split()[0].replace(".", "").lstrip("0")) <= 3
    control.slider.value = control.slider.start
    assert session.design.imu.gyro_bias == 0.0


def test_a_preset_fills_and_what_deviates_can_be_taken_back(session: Session) -> None:
    control = PresetControl(session, "imu")
    control.select.value = "STIM300"
    assert session.design.imu.preset == "STIM300"
    assert session.design.imu.angle_random_walk == parse_quantity("0.15 °/√h", "angle random walk").value
    assert not control.restore.visible
    session.change({"imu.angle_random_walk": 1e-4})
    control.show(session.design)
    assert control.restore.visible
    control.restore.clicks += 1
    assert session.design.imu.angle_random_walk == parse_quantity("0.15 °/√h", "angle random walk").value


def test_a_radar_brings_its_platform(session: Session) -> None:
    PresetControl(session, "radar").select.value = "UAVSAR"
    assert session.design.flight.speed == 220.0
    assert session.design.flight.altitude == 13800.0


def test_every_input_has_a_control() -> None:
    session = Session(Design())
    shown = {control.key for section in INPUTS for control in section_controls(session, section)}
    assert set(all_keys()) <= shown


def test_a_choice_reaches_the_design(session: Session) -> None:
    ChoiceControl(session, "radar.window").widget.value = "taylor"
    ChoiceControl(session, "gnss.correlated").widget.value = True
    assert session.design.radar.window == "taylor"
    assert session.design.gnss.correlated is True


def test_an_explained_input_says_where_its_value_came_from(session: Session) -> None:
    control = QuantityControl(session, "imu.rate")
    control.explained = True
    before, origin = session.design, "data sheet, page 3"
    session.change({"imu.rate": 250.0}, origins={"imu.rate": origin})
    assert control.differs(before.replace({"imu.rate": 250.0}), session.design)
    control.show(session.design)
    assert control.box.helper_text.startswith(f"From: {origin}.")
    session.change({"imu.rate": 200.0})
    control.show(session.design)
    assert origin not in control.box.helper_text
