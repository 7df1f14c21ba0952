"""`navbudget allan`: JSON of the contract on standard output, progress on standard error, refusals in one line."""

import io
import json
from pathlib import Path

import numpy as np
import pytest
from bench_log import log, table
from commanded import reply

from app.cli import main

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "bench.csv"
    path.write_bytes(log())
    return path


def test_static_log_gives_the_contract(bench: Path, capsys: pytest.CaptureFixture[str]):
    assert main(["allan", str(bench), "--rate", "100"]) == 0
    out, err = capsys.readouterr()
    data = json.loads(out)
    assert [axis["name"] for axis in data["axes"]] == [f"{s}_{a}" for s in ("gyro", "accelerometer") for a in "xyz"]
    for axis in data["axes"]:
        truth, unit = (0.3, "°/√h") if axis["name"].startswith("gyro") else (0.05, "m/s/√h")
        walk = axis["random_walk"]
        # 8000 samples fix a random walk within 0.8 % (1 sigma).
        assert walk["value"] == pytest.approx(truth, rel=0.04)
        assert walk["unit"] == unit
        assert walk["interval"] == "95 % confidence"
        assert axis["bias_instability"] is None
        assert axis["not_resolved"]["bias_instability"].startswith("not resolved")
        assert "a log of" in axis["would_resolve"]["bias_instability"]
    assert data["provenance"]["file"] == "bench.csv"
    assert err.startswith("reading")
    assert err.rstrip().endswith("done")


def test_a_bandwidth_narrows_the_fit(bench: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    design = tmp_path / "design.toml"
    tactical = Path("examples/tactical_x_band.toml").read_text(encoding="utf-8")
    design.write_text(tactical.replace("[imu]", '[imu]\nbandwidth = "200 Hz"'), encoding="utf-8")
    command = ["allan", str(bench), "--rate", "100"]
    for options, top in ((["--bandwidth", "100"], 10.0), (["--bandwidth", "100 Hz"], 10.0), ([], 50.0)):
        data = reply(capsys, *command, *options)
        assert [axis["band_hz"] for axis in data["axes"]] == pytest.approx([top] * 6)
        walk = data["axes"][0]["random_walk"]
        assert walk["low"] <= 0.3 * 1.01
        assert walk["high"] >= 0.3 / 1.01
    main([*command, "--against", str(design)])
    assert [axis["band_hz"] for axis in json.loads(capsys.readouterr().out)["axes"]] == pytest.approx([20.0] * 6)
    main([*command, "--against", str(design), "--bandwidth", "100"])
    assert [axis["band_hz"] for axis in json.loads(capsys.readouterr().out)["axes"]] == pytest.approx([10.0] * 6)
    assert main([*command, "--bandwidth", "2 Hz"]) == 2
    assert "with a bandwidth of 2 Hz at least 640 s are needed" in capsys.readouterr().err
    assert main([*command, "--bandwidth", "-3"]) == 2
    assert "bandwidth: " in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main([*command, "--motion", "--bandwidth", "20"])


def test_output_goes_to_a_file(bench: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    target = tmp_path / "noise.json"
    assert main(["allan", str(bench), "--rate", "100", "-o", str(target)]) == 0
    assert capsys.readouterr().out == ""
    assert len(json.loads(target.read_text(encoding="utf-8"))["axes"]) == 6
    assert main(["allan", str(bench), "--rate", "100", "-o", str(tmp_path / "no" / "such.json")]) == 2
    assert "cannot be written" in capsys.readouterr().err


def test_archive_of_counts_with_named_arrays(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = tmp_path / "counts.npz"
    np.savez(path, first=np.round(table()[:, :3] / 1e-6), second=table()[:, 3:])
    command = ["allan", str(path), "--rate", "100", "--arrays", "gyro=first,accelerometer=second"]
    gyro = reply(capsys, *command, "--gyro-unit", "1e-6 rad/s", "--accelerometer-unit", "m/s2")["axes"][0]
    assert gyro["random_walk"]["value"] == pytest.approx(0.3, rel=0.04)
    assert main([*command, "--accelerometer-unit", "m/s2"]) == 2
    assert "--gyro-unit: The file does not give the gyro unit" in capsys.readouterr().err


def test_motion_gives_a_qualified_factor(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = tmp_path / "flight.csv"
    path.write_bytes(log(8000, 4.0, 4.0))
    sheet = ["--bench-arw", "0.3 °/√h", "--bench-vrw", "0.05 m/s/√h"]
    data = reply(capsys, "allan", str(path), "--rate", "100", "--motion", *sheet)
    assert data["vibration_factor"] == pytest.approx(4.0, rel=0.05)
    assert "as white noise" in data["qualification"]


def test_standard_input_and_its_bad_row(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    class Standard:
        buffer = io.BytesIO(log(1) + b"1,2,3,4,5,6\n1,2,x,4,5,6\n")

    monkeypatch.setattr("sys.stdin", Standard)
    assert main(["allan", "-", "--rate", "100"]) == 2
    assert "navbudget: standard input: line 4, column 3: 'x'" in capsys.readouterr().err


def test_columns_may_begin_with_one_that_is_skipped(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    rows = np.column_stack([np.arange(3000), np.arange(3000) / 100.0, table()[:3000]])
    path = tmp_path / "bare.csv"
    np.savetxt(path, rows, delimiter=",", fmt="%.9g")
    names = "-,time,gyro_x,gyro_y,gyro_z,accelerometer_x,accelerometer_y,accelerometer_z"
    units = ["--gyro-unit", "rad/s", "--accelerometer-unit", "m/s2"]
    for columns in (["--columns", names], [f"--columns={names}"]):
        data = reply(capsys, "allan", str(path), *columns, *units)
        assert len(data["axes"]) == 6
        assert data["provenance"]["reading"][0] == "rate 100 Hz from time"


def test_one_of_several_sensors_is_chosen(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    lines = log(4000).decode().splitlines()
    path = tmp_path / "dump.csv"
    both = [f"{sensor},{line}" for line in lines[1:] for sensor in (0, 1)]
    path.write_text("\n".join([f"I,{lines[0]}", *both]))
    assert main(["allan", str(path), "--rate", "100"]) == 2
    assert "--sensor: The column 'I' tells 2 sensors apart: 0 and 1. Choose one" in capsys.readouterr().err
    data = reply(capsys, "allan", str(path), "--rate", "100", "--sensor", "1")
    assert data["provenance"]["samples"] == 4000
    assert data["axes"][0]["random_walk"]["value"] == pytest.approx(0.3, rel=0.05)
