"""`navbudget simulate`: what it writes, where, and what it refuses."""

import csv
import io
import json
import math

import numpy as np
import pytest
from commanded import reply
from known_designs import MEMS
from waiting import refusing_port

from app.cli import main
from nav_model.design.parts import Accelerometer, Filter, Gyro

pytestmark = pytest.mark.long

SHORT = ["--runs", "6", "--seed", "4", "--duration", "40", "--outage", "30,40", "--every", "2", "--workers", "1"]


def _simulate(*arguments: str) -> int:
    return main(["simulate", MEMS, *SHORT, *arguments])


def test_standard_output_holds_the_contracts_document(capsys) -> None:
    assert _simulate() == 0
    out, err = capsys.readouterr()
    document = json.loads(out)
    assert (document["runs"], document["seed"], document["simulated_s"]) == (6, 4, 240.0)
    assert document["wall_s"] > 0
    assert isinstance(document["consistent"], bool)
    assert document["nees"].keys() == {"mean", "low", "high", "states"}
    assert document["nees"]["states"] == 9
    assert document["time_s"] == pytest.approx(list(range(0, 41, 2)))
    for group, unit, axes in (
        ("position", "m", ("north", "east", "down")),
        ("velocity", "m_s", ("north", "east", "down")),
        ("attitude", "rad", ("roll", "pitch", "yaw")),
    ):
        for axis in axes:
            for kind in ("rms", "filter_sigma", "closed_form_sigma"):
                curve = document[group][axis][f"{kind}_{unit}"]
                assert len(curve) == 21
                assert all(value > 0 and math.isfinite(value) for value in curve)
    assert "6 of 6 runs" in err
    assert document["verdict"] in err


def test_the_same_seed_gives_the_same_numbers_and_another_does_not(capsys) -> None:
    documents = [reply(capsys, "simulate", MEMS, *SHORT, *extra) for extra in ([], [], ["--seed", "5"])]
    same, also, other = (document["position"]["north"]["rms_m"] for document in documents)
    assert same == also
    assert same != other


def test_files_of_each_kind(tmp_path, capsys) -> None:
    for suffix in ("json", "npz", "csv"):
        assert _simulate("-o", str(tmp_path / f"a.{suffix}")) == 0
        out, err = capsys.readouterr()
        assert out == ""
        assert f"wrote {tmp_path / f'a.{suffix}'}" in err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv", "a.json", "a.npz"]
    document = json.loads((tmp_path / "a.json").read_text("utf-8"))
    arrays = np.load(tmp_path / "a.npz")
    assert arrays["run_errors"].shape == (6, 21, 9)
    north = np.sqrt(np.mean(arrays["run_errors"][:, :, 0] ** 2, axis=0))
    assert north == pytest.approx(document["position"]["north"]["rms_m"], rel=1e-12)
    rows = list(csv.DictReader(io.StringIO((tmp_path / "a.csv").read_text("utf-8"))))
    assert [float(row["position_north_rms_m"]) for row in rows] == pytest.approx(list(north), rel=1e-12)


def test_fifteen_states_and_a_flight_from_a_file(tmp_path, capsys) -> None:
    flight = tmp_path / "flight.csv"
    lines = ["time_s,latitude_deg,longitude_deg,height_m,roll_deg,pitch_deg,yaw_deg"]
    lines += [f"{t},{45 + 9e-6 * 60 * t},7,2000,0,0,0" for t in range(0, 36)]
    flight.write_text("\n".join(lines))
    arguments = [MEMS, "--runs", "2", "--trajectory", str(flight), "--states", "15", "--workers", "1"]
    document = reply(capsys, "simulate", *arguments)
    assert document["nees"]["states"] == 15
    assert document["time_s"][-1] == 35.0  # the file's length, as none was given
    assert "The flight comes from the file" in document["conditions"][0]


def test_what_is_added_to_the_design_is_flown_and_said(capsys) -> None:
    added = ["gyro.bias_instability=300 °/h", "gyro.correlation_time=2 min", "gyro.quantization=1 arcsec"]
    document = reply(capsys, "simulate", MEMS, *SHORT, "--set", *added)
    instability = {"gyro.bias_instability": "300 °/h", "gyro.correlation_time": "120 s"}
    assert document["added"] == {**instability, "gyro.quantization": "1 arcsec"}
    assert "Simulated and not in the formulas: gyro quantization 1 arcsec." in document["conditions"]
    assert main(["simulate", "--inputs"]) == 0
    listed = capsys.readouterr().out
    keys = [f"{part.section}.{name}" for part in (Gyro, Accelerometer, Filter) for name in part.inputs()]
    assert all(f"{key} " in listed for key in keys)


def test_a_scheduler_that_is_not_there_is_one_line(capsys, monkeypatch) -> None:
    from nav_model.simulation import cluster

    pytest.importorskip("distributed")
    answer = cluster.cluster_pool
    monkeypatch.setattr(cluster, "cluster_pool", lambda address: answer(address, 1.0))
    with refusing_port() as port:
        assert _simulate("--scheduler", f"tcp://127.0.0.1:{port}") == 2
    assert f"--scheduler: no Dask scheduler answers at 'tcp://127.0.0.1:{port}'" in capsys.readouterr().err


def test_a_failure_leaves_the_old_file(tmp_path, capsys) -> None:
    target = tmp_path / "a.json"
    target.write_text("old")
    assert _simulate("--trajectory", "turns", "-o", str(target)) == 2
    assert target.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]


def test_a_flight_beyond_this_machines_memory_is_refused_before_it_is_flown(capsys, monkeypatch) -> None:
    monkeypatch.setattr("app.subjects.simulation.console.os.sysconf", lambda _: 1000)  # a megabyte
    assert main(["simulate", MEMS, "--runs", "2", "--duration", "100", "--workers", "1"]) == 2
    message = "--duration: 10,000 IMU samples take 0.0013 GB a process, 1 in all, and this machine has 0.001 GB."
    assert f"{message} Give at most 77 s" in capsys.readouterr().err
