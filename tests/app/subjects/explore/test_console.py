"""`navbudget explore` and `navbudget sweep` as scripts use them."""

import csv
import io
import json

import pytest
from commanded import reply
from known_designs import MEMS

from app.cli import main
from nav_model.base.text.csv_text import csv_text
from nav_model.budget import analyse
from nav_model.design.file import read_design


@pytest.mark.parametrize("question", ["solve", "rank", "map", "search", "uncertainty"])
def test_every_question_answers_in_json_and_csv(question, capsys):
    extra = {"map": ["--size", "4"], "uncertainty": ["--vary", "gnss.position_noise=0.5 m .. 2 m"]}.get(question, [])
    assert reply(capsys, "explore", question, MEMS, *extra)["processing"] == {"mode": "real time"}
    assert main(["explore", question, MEMS, "--csv", *extra]) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert {row["processing.mode"] for row in rows} == {"real time"}
    if question != "rank":  # what only a flight judges is named beside what it has no part in
        heading = ["--set", "requirements.heading=0.01 deg", *extra]
        whole = reply(capsys, "explore", question, MEMS, *heading)
        assert whole.pop("before_flight") == ["heading"]
        assert whole == reply(capsys, "explore", question, MEMS, *extra)
        assert main(["explore", question, MEMS, "--csv", *heading]) == 0
        rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
        assert {row["before_flight"] for row in rows} == {"heading"}


def test_solve_says_what_would_help(capsys):
    rows = reply(capsys, "explore", "solve", MEMS)["solved"]
    row = next(r for r in rows if r["input"] == "gnss.position_noise" and r["requirement"] == "all requirements")
    assert row["outcome"] == "no value"
    assert row["largest"] is None
    most = row["what_would"]["imu.angle_random_walk"]
    tightest = analyse(read_design(MEMS).replace({"imu.angle_random_walk": most})).verdict.tightest
    assert tightest.margin == pytest.approx(0, abs=1e-6)


def test_a_name_from_a_catalogue_is_no_formula(tmp_path, capsys):
    path, name = tmp_path / "own.toml", '=HYPERLINK("http://evil.example")'
    path.write_text(
        f"[[imu]]\nname = '{name}'\n"
        'angle_random_walk = { value = "9 °/√h", status = "confirmed", source = "bench" }\n'
        'velocity_random_walk = { value = "9 m/s/√h", status = "confirmed", source = "bench" }\n',
        encoding="utf-8",
    )
    assert main(["explore", "search", MEMS, "--csv", "--imus", str(path)]) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    named = [row for row in rows if name in row["imu"]]
    assert {row["imu"] for row in named} == {f"'{name}"}
    assert all(float(row["margin"]) < 0 for row in named)  # a negative number is one
    assert main(["explore", "search", MEMS, "--receivers", str(path)]) == 2
    assert "own.toml: has no [[gnss]] entries" in capsys.readouterr().err


def test_every_csv_of_ours_marks_what_a_spreadsheet_would_compute():
    rows = [["=1", "+a", "-a", "@a", "\ta", "a\r=1", "a=1", ""], ["-1.5", "+2", "-inf", -3.0, 4, None, True, "nan"]]
    rows.append(["\r=1", "\n=1", " =1", "\u00a0+a", "\uff1d1", " \uff20a", " a", "\uff41"])
    marked, unmarked, hidden = csv.reader(io.StringIO(csv_text(rows), newline=""))
    assert marked == ["'=1", "'+a", "'-a", "'@a", "'\ta", "a =1", "a=1", ""]
    assert hidden == ["' =1", "'\n=1", "' =1", "'\u00a0+a", "'\uff1d1", "' \uff20a", " a", "\uff41"]
    assert unmarked == ["-1.5", "+2", "-inf", "-3.0", "4", "", "True", "nan"]


@pytest.mark.long
def test_a_manoeuvre_for_the_lines_that_fail(capsys):
    plan = ["trajectory.flight=lines", "trajectory.lines=2", "trajectory.length=9 km", "trajectory.spacing=3 km"]
    ask = ["explore", "manoeuvre", MEMS, "--set", "requirements.heading=0.08°", *plan]
    ask += [f"requirements.{name}=1e3 {unit}" for name, unit in (("quadratic_phase", "°"), ("detrended_phase", "°"))]
    answer = reply(capsys, *ask)
    assert (answer["line"], answer["lines"], answer["closes"]) == ("line 1", ["line 1"], False)
    first = answer["options"][0]
    assert (first["closes"], first["kind"]) == (True, "manoeuvre")
    assert first["figures"]["heading"]["worst"] < first["figures"]["heading"]["limit"]
    assert first["changes"]["trajectory.waypoints"][-1] == pytest.approx(
        answer["options"][1]["changes"]["trajectory.waypoints"][-1]
    )
    assert reply(capsys, *ask, "--line", "line 2")["closes"]
    assert main([*ask, "--line", "line 7"]) == 2
    assert "--line: the flight has no line 'line 7'; its lines: line 1, line 2" in capsys.readouterr().err
    assert main([*ask, "requirements.heading=0.0001°"]) == 1
    assert not any(option["closes"] for option in json.loads(capsys.readouterr().out)["options"])


def test_rows_of_a_vendors_table_are_inverted_or_contradicted(capsys):
    good = "60 s: horizontal 6.59 m, vertical 0.628 m, velocity 0.1997 m/s, roll and pitch 0.02327°, heading 0.01937°"
    answer = reply(capsys, "explore", "invert", MEMS, "--row", good)
    assert (answer["agree"], answer["contradictions"], answer["processing"]) == (True, [], {"mode": "real time"})
    walk = next(row for row in answer["implied"] if row["input"] == "imu.angle_random_walk")
    design = read_design(MEMS)
    assert walk["value"] == pytest.approx(design.imu.angle_random_walk * design.imu.vibration_factor, rel=0.05)
    assert main(["explore", "invert", MEMS, "--row", good.replace("0.02327", "0.2327")]) == 1
    (wrong, *_) = json.loads(capsys.readouterr().out)["contradictions"]
    assert (wrong["entry"], wrong["outage_s"]) == ("roll and pitch", 60.0)
    assert main(["explore", "invert", MEMS]) == 2
    assert "--row: Give from one to 10 rows" in capsys.readouterr().err
