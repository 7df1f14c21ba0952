"""The Explore page without a browser: what the search adopts, whose sensors it takes, what it refuses."""

from __future__ import annotations

import csv
import io
import re

import pytest

from app.serving.server import first_design
from app.session import Session
from app.subjects.explore.page import ExplorePage
from app.subjects.explore.search import EXAMPLE
from nav_model.explore import solve as solving

pytestmark = pytest.mark.filterwarnings("ignore:Both 'variant' and 'button_style':PendingDeprecationWarning")

OWN = """
[[imu]]
name = "Our <b>unit</b>"
angle_random_walk = { value = "0.01 °/√h", status = "confirmed", source = "our bench" }
velocity_random_walk = { value = "0.005 m/s/√h", status = "assumed", source = "our bench" }

[[gnss]]
name = "Our receiver"
position_noise = { value = "3 cm", status = "confirmed", source = "our bench" }
interval = { value = "0.2 s", status = "confirmed", source = "our bench" }
"""


@pytest.fixture
def explore() -> ExplorePage:
    session = Session(first_design())
    made = ExplorePage(session)
    session.param.watch(lambda event: made.show(event.new), "budget")
    return made


def _open(explore: ExplorePage, content: bytes) -> str:
    search = explore._parts[2]
    search._file.value = content
    return str(search._said.object)


def test_own_units_and_receivers_are_judged_and_adopted(explore: ExplorePage) -> None:
    search = explore._parts[2]
    before = search._table.html.count("<tr>")
    assert "Added Our &lt;b&gt;unit&lt;/b&gt;, Our receiver" in _open(explore, OWN.encode())
    assert search._table.html.count("<tr>") > before
    assert "<b>unit" not in search._table.html
    search._table.chosen = "Our <b>unit</b> with Our receiver"
    search._adopt_selected()
    design = search.session.design
    assert design["imu.preset"] is None
    assert design.imu.angle_random_walk == pytest.approx(0.01 * 3.14159265 / 180 / 60)
    assert design.gnss.position_noise == 0.03
    assert design.gnss.interval == 0.2
    assert design.gnss.vertical_position_noise is None
    assert design.unit("gnss.position_noise") == "cm"
    assert "You can undo" in search._said.object
    search.session.undo()
    assert search.session.design == first_design()


def test_the_example_offered_is_such_a_file(explore: ExplorePage) -> None:
    assert "Added Our inertial unit, Our receiver." in _open(explore, EXAMPLE.encode())


def test_a_pair_that_is_no_longer_there_adopts_nothing(explore: ExplorePage) -> None:
    search = explore._parts[2]
    search._table.chosen = "LN-200 with a kite"
    search._adopt_selected()
    assert search.session.design == first_design()


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"\xff\xfe", "not UTF-8"),
        (b"[[imu]\n", "not TOML"),
        (b"[[radars]]\nname = 'x'\n", "neither"),
        (b"[[imu]]\nname = 'x'\nangle_random_walk = '1 m'\n", "must be a table"),
        (b"a = " + b"[" * 5000, "not TOML"),
        (b"imu = 3", "tables"),
    ],
)
def test_files_that_hold_no_sensors_are_refused_and_change_nothing(
    explore: ExplorePage, content: bytes, said: str
) -> None:
    before = explore._parts[2]._table.html
    answer = _open(explore, content)
    assert "Not opened" in answer
    assert said in answer
    assert explore._parts[2]._table.html == before


def test_the_table_and_its_csv_say_the_same(explore: ExplorePage) -> None:
    search = explore._parts[2]
    rows = list(csv.DictReader(io.StringIO(search._csv().read().decode())))
    shown = re.findall(r'type="radio" name="row" value="(.*?)"', search._table.html)
    assert [f"{row['IMU']} with {row['Receiver']}" for row in rows] == shown
    assert search._table.html.count("✓ closes") == sum(row["Closes"] == "True" for row in rows) > 0


def test_an_answer_that_fails_its_check_is_not_shown(explore: ExplorePage, monkeypatch: pytest.MonkeyPatch) -> None:
    assert "Largest allowed value" in explore._answer.object
    monkeypatch.setattr(solving, "_CLOSE", 0.1)  # roots stop far from the limit
    explore.show(explore._parts[2].session.budget)
    assert "Not solved" in explore._answer.object
    assert "Largest allowed value" not in explore._answer.object
