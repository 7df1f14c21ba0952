"""Sweeps through the simulator: rows are the studies `simulate` makes, and agree with the closed forms."""

import csv
from pathlib import Path

import pytest

from nav_model.base.errors import InputError
from nav_model.design.file import format_design
from nav_model.explore.sweep import run_sweep
from nav_model.explore.sweep_plan import parse_plan, read_plan
from nav_model.simulation.design_study import specification, study_of, to_document
from nav_model.simulation.monte_carlo import simulate

pytestmark = pytest.mark.long

EXAMPLE = Path(__file__).parents[3] / "examples" / "sweeps" / "gyro_and_fixes.toml"
FLOWN = """
design = "design.toml"
results = ["quadratic_phase"]

[simulate]
runs = 60
seed = 3
duration = "90 s"
outages = [["60 s", "90 s"]]
every = "10 s"

[vary]
imu.angle_random_walk = ["0.05 °/√h", "0.5 °/√h"]
gnss.position_noise = ["5 cm", "1 m"]
"""


@pytest.fixture
def plan_file(write_plan):
    return write_plan(FLOWN)


def _rows(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_rows_are_studies_and_agree_with_the_closed_forms(plan_file, tmp_path, open_design):
    out = tmp_path / "out.csv"
    run_sweep(read_plan(plan_file), out)
    rows = _rows(out)
    assert [int(row["row"]) for row in rows] == [0, 1, 2, 3]
    for row in rows:
        # 60 runs: the rms lies within 31 % of a true sigma with 99.9 % probability; the closed form is the cycle
        # rms and the outage starts just after a fix, some per cent lower.
        for axis in ("north", "east"):
            rms, sigma = (float(row[f"simulated_position_{axis}_{kind}_m"]) for kind in ("rms", "closed_form_sigma"))
            assert rms == pytest.approx(sigma, rel=0.37)
        assert row["not_flown"] == ""
        assert float(row["quadratic_phase_sigma_rad"]) > 0
    changes = {"imu.angle_random_walk": float(rows[2]["imu.angle_random_walk"]),
               "gnss.position_noise": float(rows[2]["gnss.position_noise"])}  # fmt: skip
    design = open_design.replace(changes)
    spec = specification(design, runs=60, seed=3, duration=90.0, outages=[(60.0, 90.0)], every=10.0)
    study = to_document(study_of(design, simulate(spec)))
    assert float(rows[2]["simulated_position_down_rms_m"]) == study["position"]["down"]["rms_m"][-1]
    assert (
        float(rows[2]["simulated_attitude_yaw_filter_sigma_rad"]) == study["attitude"]["yaw"]["filter_sigma_rad"][-1]
    )
    assert float(rows[2]["nees_mean"]) == study["nees"]["mean"]
    assert study["verdict"].startswith(rows[2]["filter_verdict"])


@pytest.mark.slow
def test_killed_and_finished_by_a_cluster_it_is_the_file_of_one_process(plan_file, tmp_path, kill_during_sweep):
    distributed = pytest.importorskip("distributed")
    text = FLOWN.replace("runs = 60", "runs = 20").replace(
        '["5 cm", "1 m"]', '["1 cm", "5 cm", "20 cm", "1 m", "5 m"]'
    )
    plan_file.write_text(text, "utf-8")
    plan = read_plan(plan_file)
    out, parts = tmp_path / "out.csv", tmp_path / "out.csv.parts"
    kill_during_sweep(plan_file, out, 2)
    done = len(list(parts.glob("*.csv")))
    assert 2 <= done < plan.parts
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
    ) as cluster:
        assert run_sweep(plan, out, scheduler=cluster.scheduler_address) == done
    run_sweep(plan, tmp_path / "here.csv")
    assert out.read_bytes() == (tmp_path / "here.csv").read_bytes()
    assert [int(row["row"]) for row in _rows(out)] == list(range(plan.rows))


def test_a_design_that_cannot_be_flown_keeps_its_row(plan_file, tmp_path):
    """No fix can come faster than the inertial unit samples: said in its row, the others are flown."""
    plan_file.write_text(
        FLOWN.partition("[vary]")[0].replace("runs = 60", "runs = 2") + '[vary]\nimu.rate = ["100 Hz", "20 kHz"]\n',
        encoding="utf-8",
    )
    run_sweep(read_plan(plan_file), tmp_path / "out.parquet")
    import pyarrow.parquet

    good, bad = pyarrow.parquet.read_table(tmp_path / "out.parquet").to_pylist()
    assert good["simulated_attitude_roll_rms_rad"] > 0
    assert "imu.rate" in bad["not_flown"]
    assert bad["filter_verdict"] == ""
    assert bad["nees_mean"] != bad["nees_mean"]
    assert bad["quadratic_phase_sigma_rad"] == good["quadratic_phase_sigma_rad"]


def test_the_example_that_ships_is_a_sweep():
    plan = read_plan(EXAMPLE)
    assert plan.rows == 30
    assert plan.flight.outages == ((350.0, 400.0),)


def test_a_trajectory_file_is_part_of_the_sweep(tmp_path, open_design):
    (tmp_path / "design.toml").write_text(format_design(open_design), encoding="utf-8")
    text = FLOWN.replace("[simulate]", '[simulate]\ntrajectory = "flight.csv"')
    with pytest.raises(InputError, match="not a file that can be read"):
        parse_plan(text.encode(), folder=tmp_path)
    lines = ["time_s,latitude_deg,longitude_deg,height_m,roll_deg,pitch_deg,yaw_deg"]
    lines += [f"{t / 10},45,{t / 10 * 80 / 78846.8:.9f},3000,0,0,90" for t in range(1000)]
    (tmp_path / "flight.csv").write_text("\n".join(lines), encoding="utf-8")
    plan = parse_plan(text.encode(), folder=tmp_path)
    assert plan.flight.trajectory.kind == "file"
    assert plan.identity != parse_plan(FLOWN.encode(), folder=tmp_path).identity
    (tmp_path / "link.csv").symlink_to("flight.csv")
    for output in ("flight.csv", "link.csv"):
        with pytest.raises(InputError, match="a file that the sweep reads"):
            run_sweep(plan, tmp_path / output)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("runs = 1.5", "simulate.runs.*whole number"),
        ("runs = 0", "simulate.runs"),
        ("wings = 2", "simulate.wings.*unknown key"),
        ("duration = 500", "simulate.duration.*with its unit"),
        ('duration = "500 m"', "simulate.duration"),
        ('outages = ["400 s", "500 s"]', "list of pairs"),
        ('outages = [["80 s", "70 s"]]', "simulate.outages|simulate.outage"),
        ("states = 12", "simulate.states"),
        ('trajectory = "loop"', "not a file that can be read"),
        ('every = "600 s"', "simulate.every"),
    ],
)
def test_refused_flights(line, message):
    text = f"[design]\nname='x'\n[simulate]\n{line}\n[vary]\ngnss.interval=['1 s']"
    with pytest.raises(InputError, match=message):
        parse_plan(text.encode())
