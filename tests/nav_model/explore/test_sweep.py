"""Sweeps: every row an analysis, nothing lost or repeated when killed, the same file for any number of workers."""

import csv

import pyarrow.parquet
import pytest

from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.design.file import format_design
from nav_model.design.presets import preset_fill
from nav_model.explore import sweep
from nav_model.explore.sweep import least_demanding, run_sweep, sweep_ratios, whole_sweep
from nav_model.explore.sweep_plan import parse_plan, read_plan

pytestmark = pytest.mark.long

VARY = """
design = "design.toml"
rows_per_part = 7

[vary]
imu.preset = ["LN-200", "STIM300"]
imu.angle_random_walk = { from = "0.01 °/√h", to = "1 °/√h", points = 4, spacing = "log" }
gnss.position_noise = ["2 cm", "1 m"]
radar.window = ["uniform", "taylor"]
requirements.quadratic_phase = ["45°", "90°"]
"""


@pytest.fixture
def plan_file(write_plan):
    return write_plan(VARY)


def test_rows_are_analysed_designs(plan_file, tmp_path, open_design):
    plan = read_plan(plan_file)
    assert plan.rows == 2 * 4 * 2 * 2 * 2
    out = tmp_path / "out.csv"
    assert run_sweep(plan, out) == 0
    with out.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [int(row["row"]) for row in rows] == list(range(plan.rows))
    for row in rows[::5]:
        changes = preset_fill("imu", row["imu.preset"])[0] | {
            "imu.angle_random_walk": float(row["imu.angle_random_walk"]),
            "gnss.position_noise": float(row["gnss.position_noise"]),
            "radar.window": row["radar.window"],
            "requirements.quadratic_phase": float(row["requirements.quadratic_phase"]),
        }
        budget = analyse(open_design.replace(changes))
        assert float(row["quadratic_phase_sigma_rad"]) == pytest.approx(
            budget["quadratic_phase", "real time"].sigma, rel=1e-12
        )
        assert row["closes"] == str(budget.verdict.closes)
        assert row["processing.mode"] == "real time"
        for check in budget.verdict.checks:
            assert float(row[f"{check.name}_margin"]) == pytest.approx(check.margin, rel=1e-9, abs=1e-12)
    assert not out.with_name("out.csv.parts").exists()


def test_parquet_and_two_processes_say_the_same(plan_file, tmp_path):
    plan = read_plan(plan_file)
    run_sweep(plan, tmp_path / "one.csv")
    run_sweep(plan, tmp_path / "two.csv", workers=2)
    assert (tmp_path / "one.csv").read_bytes() == (tmp_path / "two.csv").read_bytes()
    run_sweep(plan, tmp_path / "all.parquet")
    table = pyarrow.parquet.read_table(tmp_path / "all.parquet")
    with (tmp_path / "one.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    assert table.column_names == rows[0]
    assert [repr(x) for x in table["tilt_sigma_rad"].to_pylist()] == [
        r[rows[0].index("tilt_sigma_rad")] for r in rows[1:]
    ]


def test_killed_midway_it_goes_on_where_it_was(plan_file, tmp_path, kill_during_sweep):
    """kill -9 while parts are being written; then nothing is computed twice, and the file is the same."""
    plan_file.write_text(
        VARY.replace("points = 4", "points = 100").replace("rows_per_part = 7", "rows_per_part = 50"),
        encoding="utf-8",
    )
    plan = read_plan(plan_file)
    out, parts = tmp_path / "out.csv", tmp_path / "out.csv.parts"
    kill_during_sweep(plan_file, out, 5)
    assert not out.exists()
    done = {path: path.stat().st_mtime_ns for path in parts.glob("*.csv")}
    assert 5 <= len(done) < plan.parts

    seen = []
    result = run_sweep(plan, out, progress=lambda done, total: seen.append(done))
    assert result == 50 * len(done)
    assert seen[0] == result
    assert len(seen) - 1 == plan.parts - len(done)
    whole = tmp_path / "whole.csv"
    run_sweep(plan, whole)
    assert out.read_bytes() == whole.read_bytes()


@pytest.mark.parametrize("stated", ['{"identity": "another"}', "", '{"identity": ', "["])
def test_parts_of_another_sweep_are_not_taken(plan_file, tmp_path, stated):
    out = tmp_path / "out.csv"
    parts = tmp_path / "out.csv.parts"
    parts.mkdir()
    (parts / "plan.json").write_text(stated)
    with pytest.raises(InputError, match="another sweep"):
        run_sweep(read_plan(plan_file), out)


class Stop(Exception):
    """A run ends."""


def _stop_after(rows):
    def progress(done, total):
        if done >= rows:
            raise Stop

    return progress


@pytest.mark.parametrize("moment", [0, 7, 21, "end"])
def test_a_second_sweep_onto_the_same_output_is_refused_and_harms_nothing(plan_file, tmp_path, moment):
    plan, out = read_plan(plan_file), tmp_path / "out.csv"
    refusals = []

    def progress(done, total):
        if done == (total if moment == "end" else moment):
            with pytest.raises(InputError, match="another sweep is writing it") as refusal:
                run_sweep(plan, out)
            refusals.append(refusal)

    run_sweep(plan, out, progress=progress)
    assert len(refusals) == 1
    run_sweep(plan, tmp_path / "whole.csv")
    assert out.read_bytes() == (tmp_path / "whole.csv").read_bytes()
    assert sorted(path.name for path in tmp_path.glob("*.parts")) == []
    assert run_sweep(plan, out) == 0  # and again, once the first has ended


def _halve(part, other):
    part.write_bytes(part.read_bytes()[: part.stat().st_size // 2])


def _change(part, other):
    content = bytearray(part.read_bytes())
    content[len(content) // 2] ^= 1
    part.write_bytes(content)


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
@pytest.mark.parametrize(
    "damage",
    [
        lambda part, other: part.write_bytes(b""),
        _halve,
        _change,
        lambda part, other: part.write_bytes(other.read_bytes()),
        lambda part, other: part.unlink(),
    ],
)
def test_a_damaged_part_is_computed_again(plan_file, tmp_path, suffix, damage):
    plan = read_plan(plan_file)
    run_sweep(plan, tmp_path / f"whole{suffix}")
    out = tmp_path / f"out{suffix}"
    with pytest.raises(Stop):
        run_sweep(plan, out, progress=_stop_after(28))
    part, other = sorted(out.with_name(out.name + ".parts").glob(f"*{suffix}"))[1:3]
    damage(part, other)
    assert run_sweep(plan, out) == 3 * plan.rows_per_part
    assert out.read_bytes() == (tmp_path / f"whole{suffix}").read_bytes()


def test_a_part_that_is_a_link_is_refused_by_its_name(plan_file, tmp_path):
    plan, out = read_plan(plan_file), tmp_path / "out.csv"
    with pytest.raises(Stop):
        run_sweep(plan, out, progress=_stop_after(28))
    part = sorted((tmp_path / "out.csv.parts").glob("*.csv"))[1]
    part.rename(tmp_path / "elsewhere")
    part.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(InputError, match=rf"{part.name}.*link"):
        run_sweep(plan, out)
    assert not out.exists()


def test_a_part_changed_while_the_sweep_runs_is_not_joined(plan_file, tmp_path):
    plan, out = read_plan(plan_file), tmp_path / "out.csv"
    parts = tmp_path / "out.csv.parts"

    def progress(done, total):
        if done == total:
            _change(sorted(parts.glob("*.csv"))[1], None)

    with pytest.raises(InputError, match=r"00000001.* was changed"):
        run_sweep(plan, out, progress=progress)
    assert not out.exists()
    assert run_sweep(plan, out) == plan.rows - plan.rows_per_part


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_a_part_that_lacks_rows_is_not_joined(plan_file, tmp_path, suffix, monkeypatch):
    whole = sweep.evaluate
    monkeypatch.setattr(
        sweep, "evaluate", lambda plan, start, stop: whole(plan, start, stop - (start == plan.rows_per_part))
    )
    with pytest.raises(InputError, match=r"00000001.* holds 6 rows instead of 7"):
        run_sweep(read_plan(plan_file), tmp_path / f"out{suffix}")
    assert not (tmp_path / f"out{suffix}").exists()


def test_the_same_file_from_a_cluster_of_two_processes(plan_file, tmp_path):
    distributed = pytest.importorskip("distributed")
    plan = read_plan(plan_file)
    run_sweep(plan, tmp_path / "here.csv")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
    ) as cluster:
        run_sweep(plan, tmp_path / "there.csv", scheduler=cluster.scheduler_address)
    assert (tmp_path / "here.csv").read_bytes() == (tmp_path / "there.csv").read_bytes()


def test_requirements_that_only_a_flight_judges_are_named_in_each_row():
    text = b"""design = { requirements = { %s = "0.1 deg", tilt = "1 deg" } }
    [vary]
    %s = ["1 deg", "2 deg"]"""
    for given, varied in ((b"heading", b"requirements.tilt"), (b"quadratic_phase", b"requirements.heading")):
        columns = whole_sweep(parse_plan(text % (given, varied)))
        assert columns["before_flight"] == ["heading"] * 2
    assert "before_flight" not in whole_sweep(parse_plan(text % (b"quadratic_phase", b"requirements.tilt")))


LIMITED = """
results = ["%s"]
[vary]
gnss.position_noise = ["1 cm", "1 m"]
[[design.limits]]
name = "early tilt"
on = "coast_tilt"
at = "10 s"
limit = "1 deg"
[[design.limits]]
name = "width"
on = "response_width"
limit = "1 m"
[[design.limits]]
name = "yaw"
on = "heading"
limit = "1 deg"
"""


@pytest.mark.parametrize(("name", "column"), [("early tilt", "early tilt_sigma_rad"), ("width", "width_m")])
def test_a_limit_of_the_users_own_is_a_result(name, column):
    """One on what only a flight tells is none, and is left to the flight."""
    plan = parse_plan((LIMITED % name).encode())
    columns = whole_sweep(plan)
    for noise, value in zip(columns["gnss.position_noise"], columns[column], strict=True):
        checks = {
            each.name: each for each in analyse(plan.design.replace({"gnss.position_noise": noise})).verdict.checks
        }
        assert value == pytest.approx(checks[name].sigma, rel=1e-12)
    assert columns["before_flight"] == ["yaw"] * 2
    with pytest.raises(InputError, match="results"):
        parse_plan((LIMITED % "yaw").encode())


def test_an_input_is_varied_under_its_name_of_before():
    plan = parse_plan(b'design = {name = "x"}\n[vary]\nmotion.imu_bandwidth = ["50 Hz", "100 Hz"]\n')
    assert [(axis.key, axis.values) for axis in plan.axes] == [("imu.bandwidth", (50.0, 100.0))]


def test_side_by_side_and_inline_designs():
    plan = parse_plan(
        b"""
combine = "together"
results = ["tilt"]
[design]
name = "inline"
[vary]
"gnss.interval" = ["1 s", "2 s", "5 s"]
"gnss.position_noise" = { from = "1 m", to = "3 m", points = 3 }
"""
    )
    assert plan.rows == 3
    assert plan.results == ("tilt",)
    assert plan.design.name == "inline"
    assert [list(i) for i in plan.indices(0, 3)] == [[0, 1, 2], [0, 1, 2]]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x = [", "not a sweep file"),
        ("other = 1", "unknown key"),
        ("[design]\nname='x'", "gives no input"),
        ("[design]\nname='x'\n[vary]\nimu.wings = ['1']", "unknown key"),
        ("[design]\nname='x'\n[vary]\ngnss.interval = []", "must be a list"),
        ("[design]\nname='x'\n[vary]\ngnss.interval = ['-1 s']", "at least"),
        ("[design]\nname='x'\n[vary]\ngnss.interval = {from='1 s', to='2 s'}", "a range is"),
        ("[design]\nname='x'\n[vary]\nimu.gyro_bias = {from='0 °/h', to='2 °/h', points=3, spacing='log'}",
         "above zero"),
        ("[design]\nname='x'\n[vary]\nimu.preset = ['nothing']", "not in the catalogue"),
        ("results=['weight']\n[design]\nname='x'\n[vary]\ngnss.interval=['1 s']", "Choose "),
        ("rows_per_part=0\n[design]\nname='x'\n[vary]\ngnss.interval=['1 s']", "whole number"),
        ("combine='together'\n[design]\nname='x'\n[vary]\ngnss.interval=['1 s']\ngnss.position_noise=['1 m','2 m']",
         "one length"),
        ("[design]\nname='x'\n[vary]\ngnss.interval={from='1 s', to='2 s', points=50000}\n"
         "gnss.position_noise={from='1 m', to='2 m', points=50000}", "asks for 2500000000 designs; at most"),
        ("combine='together'\n[design]\nname='x'\n[vary]\ngnss.interval={from='1 s', to='2 s', points=100000}\n"
         "gnss.position_noise=['1 m']", "gnss.position_noise: more than 100000 values"),
    ],
)  # fmt: skip
def test_refused_plans(text, message):
    with pytest.raises(InputError, match=message):
        parse_plan(text.encode())


def test_refused_outputs_and_schedulers(plan_file, tmp_path):
    plan = read_plan(plan_file)
    with pytest.raises(InputError, match=r"must end in \.csv or \.parquet"):
        run_sweep(plan, tmp_path / "out.xls")
    with pytest.raises(InputError, match="cannot be written"):
        run_sweep(plan, tmp_path / "no" / "out.csv")


def test_the_least_demanding_are_those_that_no_easier_design_passes(open_design):
    """By comparing every pair of designs; an easier design has noisier sensors, of the same radar window."""
    changes = {"requirements.quadratic_phase": 1.5, "requirements.horizontal_position": 0.5}
    text = format_design(open_design.replace(changes))
    plan = parse_plan(
        f"""
[design]
{text.replace("[", "[design.")}
[vary]
gnss.position_noise = ["3 m", "2 cm", "50 cm", "1 m"]
radar.window = ["uniform", "taylor"]
imu.angle_random_walk = {{ from = "0.001 °/√h", to = "1 °/√h", points = 12, spacing = "log" }}
""".encode()
    )
    columns = whole_sweep(plan)
    places = list(zip(*plan.indices(0, plan.rows), strict=True))
    noises = [(axis.values[place] for axis, place in zip(plan.axes, row, strict=True)) for row in places]
    rows = [dict(zip((axis.key for axis in plan.axes), values, strict=True)) for values in noises]
    passes = sweep_ratios(columns) <= 1

    def easier(candidate, other):
        keys = ("gnss.position_noise", "imu.angle_random_walk")
        alike = candidate["radar.window"] == other["radar.window"]
        return candidate != other and alike and all(candidate[key] >= other[key] for key in keys)

    expected = [
        bool(met) and not any(passes[i] and easier(candidate, row) for i, candidate in enumerate(rows))
        for row, met in zip(rows, passes, strict=True)
    ]
    assert list(least_demanding(plan, columns)) == expected
    assert 1 < sum(expected) < sum(passes) < plan.rows
