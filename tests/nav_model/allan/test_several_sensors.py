"""Tables with rows of several sensors: read apart, never as one."""

import io

import numpy as np
import pytest

from nav_model.allan.imu_log import ImuLog
from nav_model.allan.log_content import LogOptions
from nav_model.allan.log_file import read_log
from nav_model.allan.warnings import log_warnings
from nav_model.base.errors import InputError

HEADER = "gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s]"
SAMPLES = 2000


def table(names: list[str], column: str, later: float = 0.0, end: str = "\n") -> bytes:
    """Rows of 100 Hz, those of the k-th sensor around k rad/s and `later` seconds behind the sensor before."""
    rng = np.random.default_rng(5)
    rows = [f"time [s],{column},{HEADER}"]
    for row in range(SAMPLES):
        for k, name in enumerate(names):
            x, y, z = k + 1e-3 * rng.standard_normal(3)
            rows.append(f"{row / 100 + k * later:.6f},{name},{x:.6f},{y:.6f},{z:.6f}")
    return (end.join(rows) + end).encode()


@pytest.mark.parametrize("column", ["I", "imu", "IMU.I", "imu_id", "sensorId", "device no", "field.header.frame_id"])
@pytest.mark.parametrize("later", [0.0, 2e-5, 4e-3])
def test_sensors_are_named_and_one_is_read(column: str, later: float):
    content = table(["0", "1"], column, later)
    with pytest.raises(InputError) as refusal:
        read_log(content)
    assert refusal.value.key == "sensor"
    assert refusal.value.reason == f"The column {column!r} tells 2 sensors apart: 0 and 1. Choose one of them."
    for k, sensor in enumerate(refusal.value.value):
        log = read_log(content, LogOptions(sensor=sensor))
        assert (log.samples, log.rate_hz) == (SAMPLES, pytest.approx(100.0))
        assert log.gyro.mean(axis=0) == pytest.approx([k, k, k], abs=2e-4)
        assert f"rows with {sensor} under {column}, which has 0 and 1" in log.reading
        assert not log_warnings(ImuLog(log.gyro - k, None, 100.0, rows_of_time=log.rows_of_time))


def test_names_may_be_texts_and_lines_may_need_a_closer_look():
    content = table(["front left", '"rear"', "imu_link"], "sensor name", end="\r\n")
    content += b"\r\n20.00,front left,,0.1,0.2\r\n20.01,rear,0.1"
    log = read_log(content, LogOptions(sensor="rear"))
    assert log.samples == SAMPLES
    assert log.gyro.mean() == pytest.approx(1.0, abs=2e-4)
    bad = table(["a", "b"], "imu").replace(b"b,1.00", b"b,x1.00", 1)
    assert read_log(bad, LogOptions(sensor="a")).samples == SAMPLES
    with pytest.raises(InputError, match=r"line \d+, column 3: 'x1.00"):
        read_log(bad, LogOptions(sensor="b"))


def test_a_sensor_that_is_not_there_is_refused():
    with pytest.raises(InputError, match="sensor: '2' is not in the column 'imu', which has 0 and 1"):
        read_log(table(["0", "1"], "imu"), LogOptions(sensor="2"))
    assert read_log(table(["0", "1"], "imu"), LogOptions(sensor="1.0")).samples == SAMPLES
    with pytest.raises(InputError, match="no column of the file tells several sensors apart"):
        read_log(table(["0"], "imu"), LogOptions(sensor="0"))


def rows_with(values: np.ndarray, column: str) -> bytes:
    text = io.StringIO()
    signal = 1e-3 * np.random.default_rng(2).standard_normal((SAMPLES, 3))
    stacked = np.column_stack([np.arange(SAMPLES) / 100, values, signal])
    np.savetxt(text, stacked, delimiter=",", header=f"time [s],{column},{HEADER}", comments="", fmt="%.9g")
    return text.getvalue().encode()


@pytest.mark.parametrize(
    ("column", "values"),
    [
        ("imu", np.ones(SAMPLES)),
        ("frame", np.arange(SAMPLES)),  # a counter
        ("id", np.arange(SAMPLES) % 100),  # a counter that wraps
        ("mode", np.arange(SAMPLES) // 500),
        ("imu_status", np.arange(SAMPLES) % 2),
        ("device", np.arange(SAMPLES) == 7),  # one odd row
    ],
)
def test_other_columns_change_nothing(column: str, values: np.ndarray):
    log, plain = (read_log(rows_with(values, name)) for name in (column, "remark"))
    np.testing.assert_array_equal(log.gyro, plain.gyro)
    assert log.reading == tuple(note.replace("remark", column) for note in plain.reading)
    assert (log.rate_hz, log.rows_of_time) == (plain.rate_hz, 1)


@pytest.mark.parametrize("count", [2, 3])
@pytest.mark.parametrize("later", [0.0, 2e-5])
def test_rows_that_share_a_time_are_named_without_such_a_column(count: int, later: float):
    log = read_log(table([str(k) for k in range(count)], "remark", later))
    assert log.rows_of_time == count
    assert f"each time is on {count} rows" in log.reading
    assert any(f"each time is on {count} rows: if they are of {count} sensors" in line for line in log_warnings(log))


def test_the_columns_of_a_table_without_a_header_may_have_the_sensor():
    content = table(["0", "1"], "x").split(b"\n", 1)[1]
    names = ["time", "sensor", "gyro_x", "gyro_y", "gyro_z"]
    with pytest.raises(InputError, match="'sensor' tells 2 sensors apart"):
        read_log(content, LogOptions(gyro_unit="rad/s", columns=names))
    log = read_log(content, LogOptions(gyro_unit="rad/s", columns=names, sensor="1"))
    assert log.samples == SAMPLES


def test_an_archive_with_several_sensors_is_asked_for_one():
    stream = io.BytesIO()
    number = np.arange(SAMPLES) % 2
    np.savez(
        stream, gyro_rad_s=number[:, None] + np.zeros((SAMPLES, 3)) + np.arange(SAMPLES)[:, None] * 1e-6, imu=number
    )
    options = LogOptions(rate_hz=100.0, gyro_unit="rad/s")
    with pytest.raises(InputError, match="'imu' tells 2 sensors apart: 0 and 1"):
        read_log(stream.getvalue(), options)
    log = read_log(stream.getvalue(), LogOptions(rate_hz=100.0, gyro_unit="rad/s", sensor="1"))
    assert log.samples == SAMPLES // 2
    assert log.gyro.min() >= 1.0


DUMP = """FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns
FMT, 176, 53, IMU, QBffffff, TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ
PARM, 91200000, INS_GYRO_RATE, 0, 0
"""


def dump(sensors: int) -> bytes:
    """Messages of IMUs at 100 Hz among those of attitude."""
    rows = [
        f"IMU, {91_000_000 + 10_000 * k}, {n}, {n}, {n}, {n}, 0.1, 0.2, -9.8\nATT, {91_000_000 + 10_000 * k}, 1, 2"
        for k in range(SAMPLES)
        for n in range(sensors)
    ]
    return (DUMP + "\n".join(rows) + "\n").encode()


def test_messages_of_an_imu_are_read_from_a_text_dump() -> None:
    log = read_log(dump(1))
    assert (log.samples, log.rate_hz) == (SAMPLES, pytest.approx(100.0))
    assert log.accelerometer is not None
    assert log.accelerometer.mean(axis=0) == pytest.approx([0.1, 0.2, -9.8])
    assert f"{SAMPLES} IMU messages of {2 * SAMPLES + 3} lines" in log.reading
    with pytest.raises(InputError, match="The column 'I' tells 2 sensors apart"):
        read_log(dump(2))
    assert read_log(dump(2), LogOptions(sensor="1")).gyro.mean() == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (DUMP.encode() + b"ATT, 1, 2\n" * 20, "without IMU or IMU2 or IMU3 messages; it has ATT"),
        (b"2026-05-04 10:00:00.00: IMU {TimeUS : 1, GyrX : 0.1}\n" * 9, "text dump of a flight log.*mavlogdump.py"),
    ],
)
def test_a_dump_without_an_imu_says_how_to_get_one(content: bytes, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_log(content)
