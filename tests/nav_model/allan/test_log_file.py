"""Reading logs: the layouts of the field, and every malformed upload refused by name."""

import io
import math
import zipfile
from pathlib import Path

import numpy as np
import pytest

from nav_model.allan.imu_log import ImuLog
from nav_model.allan.log_content import Limits, LogOptions
from nav_model.allan.log_file import read_log
from nav_model.allan.log_names import meaning_of, scale_of
from nav_model.base.errors import InputError

RNG = np.random.default_rng(0)
GYRO = RNG.standard_normal((50, 3)) * 0.01
FORCE = RNG.standard_normal((50, 3)) + 9.8
NAMES = [f"{s}_{a}" for s in ("gyro", "accelerometer") for a in "xyz"]


def csv(table: np.ndarray, header: str = "", delimiter: str = ",") -> bytes:
    stream = io.StringIO()
    if header:
        stream.write(header + "\n")
    np.savetxt(stream, table, delimiter=delimiter, fmt="%.17g")
    return stream.getvalue().encode()


def npz(**arrays: np.ndarray | float) -> bytes:
    stream = io.BytesIO()
    np.savez_compressed(stream, **{name: np.asarray(value) for name, value in arrays.items()})
    return stream.getvalue()


def with_member(name: str, content: bytes) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, content)
    return stream.getvalue()


TIME = np.arange(50)[:, None] * 0.01
HEADERS = {
    "SI with units in brackets": (
        "time [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],acc_x [m/s^2],acc_y [m/s^2],acc_z [m/s^2]",
        np.hstack([TIME, GYRO, FORCE]),
    ),
    "degrees and g": (
        "t_ms,gx_dps,gy_dps,gz_dps,ax_g,ay_g,az_g",
        np.hstack([TIME * 1e3, np.degrees(GYRO), FORCE / 9.80665]),
    ),
    "accelerometer first": (
        "time_s,accel_x (m/s²),accel_y (m/s²),accel_z (m/s²),wx (°/s),wy (°/s),wz (°/s)",
        np.hstack([TIME, FORCE, np.degrees(GYRO)]),
    ),
    "EuRoC": (
        "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
        "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]",
        np.hstack([TIME * 1e9, GYRO, FORCE]),
    ),
    "ROS": (
        "time_s,angular_velocity.x,angular_velocity.y,angular_velocity.z,"
        "linear_acceleration.x,linear_acceleration.y,linear_acceleration.z",
        np.hstack([TIME, GYRO, FORCE]),
    ),
    "increments": (
        "time_s,dtheta_x [rad],dtheta_y [rad],dtheta_z [rad],dvel_x [m/s],dvel_y [m/s],dvel_z [m/s]",
        np.hstack([TIME, GYRO * 0.01, FORCE * 0.01]),
    ),
}


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
@pytest.mark.parametrize("layout", HEADERS)
def test_common_layouts(layout: str, delimiter: str):
    header, table = HEADERS[layout]
    log = read_log(csv(table, header.replace(",", delimiter), delimiter))
    np.testing.assert_allclose(log.gyro, GYRO, rtol=1e-9)
    np.testing.assert_allclose(log.accelerometer, FORCE, rtol=1e-9)
    assert log.rate_hz == pytest.approx(100.0)
    assert any("100 Hz from" in note for note in log.reading)


def test_headerless_file_needs_columns_units_and_rate():
    content = csv(np.hstack([GYRO, FORCE]), delimiter=" ")
    with pytest.raises(InputError, match="Give `columns`"):
        read_log(content)
    with pytest.raises(
        InputError, match="does not give the rate or the gyro unit or the accelerometer unit"
    ) as refused:
        read_log(content, LogOptions(columns=NAMES))
    assert refused.value.key == "rate, gyro_unit, accelerometer_unit"  # all that is missing, at once
    with pytest.raises(InputError, match="does not give the gyro unit") as refused:
        read_log(content, LogOptions(columns=NAMES, rate_hz=100.0, accelerometer_unit="g"))
    assert refused.value.key == "gyro_unit"
    log = read_log(content, LogOptions(columns=NAMES, rate_hz=100.0, gyro_unit="rad/s", accelerometer_unit="m/s²"))
    np.testing.assert_allclose(log.accelerometer, FORCE)


def test_rows_that_end_with_a_comma_have_no_column_behind_it():
    given = LogOptions(columns=NAMES[:3], rate_hz=100.0, gyro_unit="rad/s")
    for ending in ("", ","):
        log = read_log(csv(GYRO).replace(b"\n", f"{ending}\n".encode()), given)
        np.testing.assert_allclose(log.gyro, GYRO)


def test_counts_take_a_scale_per_count():
    counts = np.round(GYRO * 1e4)
    options = LogOptions(columns=["-", *NAMES[:3], "-"], rate_hz=200.0, gyro_unit="0.05 deg/s")
    log = read_log(csv(np.hstack([TIME, counts, TIME])), options)
    np.testing.assert_allclose(log.gyro, counts * np.radians(0.05))
    assert log.accelerometer is None
    assert log.rate_hz == 200.0


def test_comment_lines_may_state_the_rate():
    header = "% static log\n% sample rate: 0.1 kHz\n" + ",".join(f"{n} [rad/s]" for n in NAMES[:3])
    assert read_log(csv(GYRO, header)).rate_hz == 100.0


def test_temperature_is_kept():
    header = "temp_c," + ",".join(f"{n} [rad/s]" for n in NAMES[:3])
    log = read_log(csv(np.hstack([TIME + 20.0, GYRO]), header), LogOptions(rate_hz=50.0))
    np.testing.assert_allclose(log.temperature_c, TIME[:, 0] + 20.0)


GOOD_HEADER = HEADERS["SI with units in brackets"][0]
GOOD = csv(HEADERS["SI with units in brackets"][1], GOOD_HEADER).decode().splitlines()


def spoilt(line: int, field: int, text: str) -> bytes:
    """The good file with one field replaced; `line` counts from 1 as an editor does."""
    lines = GOOD.copy()
    fields = lines[line - 1].split(",")
    fields[field] = text
    lines[line - 1] = ",".join(fields)
    return "\n".join(lines).encode()


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        (spoilt(9, 4, "inf"), r"line 9, column 5: 'inf'"),
        (spoilt(12, 1, "0.1x"), r"line 12, column 2: '0.1x' is not a number"),
        (spoilt(20, 6, "1.0,2.0"), r"line 20: 8 columns, 7"),
        (spoilt(20, 6, "=cmd|' /C calc'!A0"), r"line 20, column 7"),
        (b"", "file is empty"),
        (b"\x89PNG\r\n\x1a\n\x00\x00", "The file is a PNG image. Write the inertial data as CSV"),
        (b'{"gyro": [1, 2]}', "The file is JSON. Write the inertial data as CSV"),
        (b"ULog\x01\x12\x35\x01", r"The file is a PX4 log \(ULog\). Run ulog2csv"),
        (b"#ROSBAG V2.0\n", "The file is a ROS bag. Write its IMU topic as CSV: rostopic echo"),
        (b"#RAWIMUSXA,COM1,0,0.0;2250\n", "The file is messages of a NovAtel receiver"),
        (b"MATLAB 5.0 MAT-file, Platform", "The file is a MATLAB file. Write its arrays with numpy.savez"),
        (with_member("imu.csv", b"1,2\n"), "The file is a ZIP archive. Unpack it"),
        (b"hello\nworld\n", "No numbers"),
        (b"hello\n" * 500, "first 250 lines"),
        (b"a" * 150_000, "longer than"),
        (b"x,y\n1,2\n3,4\n", "No gyro or accelerometer columns"),
    ],
)
def test_malformed_text_is_refused_by_name(content: bytes, complaint: str):
    with pytest.raises(InputError, match=complaint) as refusal:
        read_log(content, file_name="flight7.csv")
    assert str(refusal.value).startswith("flight7.csv")


def test_wrong_and_irregular_rates_are_refused():
    with pytest.raises(InputError, match="stated as 200 Hz"):
        read_log("\n".join(GOOD).encode(), LogOptions(rate_hz=200.0))
    with pytest.raises(InputError, match="does not increase"):
        read_log("\n".join([*GOOD[:20], GOOD[19], *GOOD[20:]]).encode())
    for rate in (-1.0, 0.0, 1e-300, 1e300, math.inf, math.nan):
        with pytest.raises(InputError, match=r"A rate of .* Hz is not allowed. It must be 0.001 to 1e\+07 Hz."):
            read_log(csv(GYRO), LogOptions(columns=NAMES[:3], rate_hz=rate, gyro_unit="rad/s"))
    for step in (b"e-300", b"e-315"):
        with pytest.raises(InputError, match=r"It must be 0.001"):
            read_log(b"time [ns],gyro_x [rad/s]\n" + b"".join(b"%d%s,1\n" % (n, step) for n in range(1, 600)))
    with pytest.raises(InputError, match="no likely rate"):
        read_log(b"time,gyro_x [rad/s]\n" + b"".join(b"%de-320,1\n" % n for n in range(1, 600)))


def test_values_no_sensor_has_are_refused_by_line():
    with pytest.raises(InputError, match=r"line 3: gyro_x is larger than 1e\+09 in SI units \(1 such rows\)"):
        read_log(b"gyro_x [rad/s]\n1\n-1e308\n2\n", LogOptions(rate_hz=1.0))


def test_size_limits():
    content = "\n".join(GOOD).encode()
    with pytest.raises(InputError, match="larger than"):
        read_log(content, limits=Limits(file_bytes=1000))
    with pytest.raises(InputError, match="more than 10 rows"):
        read_log(content, limits=Limits(rows=10))
    with pytest.raises(InputError, match="More than 0 MB of numbers"):
        read_log(content, limits=Limits(unpacked_bytes=1000))
    with pytest.raises(InputError, match="1001 columns; a table has at most 1000"):
        read_log(b",".join([b"1"] * 1001))


def test_missing_axis_and_doubled_axis():
    three = csv(GYRO)
    with pytest.raises(InputError, match="x, y and z are needed"):
        read_log(three, LogOptions(columns=["gyro_x", "gyro_y", "-"], rate_hz=1.0, gyro_unit="rad/s"))
    with pytest.raises(InputError, match="several or unclear"):
        read_log(three, LogOptions(columns=["gyro_x", "gyro_y", "gyro_y"], rate_hz=1.0, gyro_unit="rad/s"))
    with pytest.raises(InputError, match="'gyro_q' is not understood"):
        read_log(three, LogOptions(columns=["gyro_x", "gyro_y", "gyro_q"], rate_hz=1.0, gyro_unit="rad/s"))
    with pytest.raises(InputError, match="2 column names are given, but the file has 3 columns"):
        read_log(three, LogOptions(columns=["gyro_x", "gyro_y"], rate_hz=1.0))


def test_npz_layouts():
    plain = read_log(npz(gyro_dps=np.degrees(GYRO), acc_g=FORCE / 9.80665, fs=100.0))
    np.testing.assert_allclose(plain.gyro, GYRO)
    np.testing.assert_allclose(plain.accelerometer, FORCE)
    counts = read_log(npz(gyro_counts=np.round(GYRO * 1e4), gyro_dps_per_count=0.05, dt=0.01))
    np.testing.assert_allclose(counts.gyro, np.round(GYRO * 1e4) * np.radians(0.05))
    increments = read_log(
        npz(dtheta=GYRO * 0.01, dvel=FORCE * 0.01, imu_t=TIME[:, 0]),
        LogOptions(gyro_unit="rad", accelerometer_unit="m/s"),
    )
    np.testing.assert_allclose(increments.gyro, GYRO)
    single = read_log(npz(wx=GYRO[:, 0], wy=GYRO[:, 1], wz=GYRO[:, 2], rate=100.0), LogOptions(gyro_unit="rad/s"))
    np.testing.assert_allclose(single.gyro, GYRO)
    chosen = read_log(
        npz(gyro_raw_a=GYRO, gyro_raw_b=GYRO * 2, fs=100.0),
        LogOptions(arrays={"gyro": "gyro_raw_b"}, gyro_unit="rad/s"),
    )
    np.testing.assert_allclose(chosen.gyro, 2 * GYRO)


class Bomb:
    """Unpickling it would create a file."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> tuple[object, tuple[str]]:
        return Path.touch, (self.path,)


def test_pickles_are_never_opened(tmp_path: Path):
    target = tmp_path / "owned"
    stream = io.BytesIO()
    np.savez(stream, gyro=np.array([Bomb(target)], dtype=object))
    with pytest.raises(InputError, match="'gyro': holds object"):
        read_log(stream.getvalue())
    assert not target.exists()


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        (b"PK\x03\x04 not really", "is a ZIP archive"),
        (b"PK\x03\x04 gyro.npy, but not really", "not a readable NPZ"),
        (npz(gyro=GYRO, fs=100.0)[:-40], "not a readable NPZ"),
        (with_member("evil.npy.py", b"print(1)"), "not a plain .npy"),
        (with_member("gyro.npy", b"garbage"), "not a readable .npy"),
        (npz(gyro=np.array(["a", "b"])), "not numbers"),
        (npz(gyro=GYRO.astype(complex)), "not numbers"),
        (npz(gyro_dps=GYRO[:, :2], fs=100.0), "three for a triad"),
        (npz(gyro_dps=GYRO, acc_g=FORCE[:-1], fs=100.0), "The sensors have 49 and 50 samples"),
        (npz(gyro_dps=np.where(np.arange(50)[:, None] == 17, np.inf, GYRO), fs=100.0), "sample 17: gyro_x"),
        (npz(velocity=GYRO, fs=100.0), "No gyro or accelerometer"),
    ],
)
def test_malformed_archive_is_refused_by_name(content: bytes, complaint: str):
    with pytest.raises(InputError, match=complaint) as refusal:
        read_log(content, file_name="flight7.npz")
    assert str(refusal.value).startswith("flight7.npz")


def test_names_and_units():
    meaning = meaning_of("Gyro Y (mdps)")
    assert (meaning.role, meaning.axis, meaning.unit) == ("gyro", 1, "mdps")
    assert scale_of("gyro", meaning.unit).factor == pytest.approx(np.radians(1e-3))
    assert meaning_of("q [deg/s]")[:3] == ("gyro", 1, "deg/s")
    assert meaning_of("q [m]") is None
    assert meaning_of("latitude") is None
    assert scale_of("accelerometer", "125 ug s").per_sample
    assert scale_of("gyro", "0.1 arcsec").factor == pytest.approx(np.radians(0.1 / 3600))
    for printed in ("0.05 deg/s", "0.05 deg/s a count", "0.05 deg/s per count", "0.05 deg/s/count"):
        assert scale_of("gyro", printed).factor == pytest.approx(np.radians(0.05))
    assert (scale_of("gyro", "rads").factor, scale_of("gyro", "rads").per_sample) == (1.0, False)
    for text in ("furlong", "", "-1 deg/s", "0 deg/s", "1.2.3 deg/s"):
        with pytest.raises(InputError, match="gyro_unit"):
            scale_of("gyro", text)


def test_a_path_and_its_bytes_give_the_same_log(tmp_path: Path):
    content = "\n".join(GOOD).encode()
    path = tmp_path / "static.csv"
    path.write_bytes(content)
    from_path, from_bytes = read_log(path), read_log(content, file_name="static.csv")
    assert from_path.file_name == "static.csv"
    assert from_path.sha256 == from_bytes.sha256
    assert len(from_path.sha256) == 64
    with pytest.raises(InputError, match="No such file"):
        read_log(tmp_path / "missing.csv")


def test_semicolons_with_decimal_commas_and_tabs_with_them_read_as_the_same_log_with_points():
    lines = ["gyro_x [deg/s];gyro_y [deg/s];gyro_z [deg/s]", "0;0;1", "-1,5;2,25e-3;3", "4,0;5;6,125"] + [
        "7,5;8,5;9"
    ] * 20
    wanted = read_log("\n".join(lines).replace(",", ".").encode(), LogOptions(rate_hz=10.0)).gyro
    for delimiter in ";\t":
        text = "\n".join(lines).replace(";", delimiter)
        np.testing.assert_array_equal(read_log(text.encode(), LogOptions(rate_hz=10.0)).gyro, wanted)
    with pytest.raises(InputError, match="line 2: a decimal comma, but line 3 has a decimal point"):
        read_log(b"gyro_x [deg/s];gyro_y [deg/s];gyro_z [deg/s]\n1,5;2,5;3,5\n1.5;2;3", LogOptions(rate_hz=10.0))


def test_a_single_axis_is_a_log():
    values = np.linspace(-1.0, 1.0, 50)
    for label, name in (
        ("gyro_y [rad/s]", "gyro_y"),
        ("gyro [rad/s]", "gyro_x"),
        ("acc_z [m/s2]", "accelerometer_z"),
    ):
        text = "\n".join([label, *(f"{value!r}" for value in values.tolist())])
        (axis,) = read_log(text.encode(), LogOptions(rate_hz=10.0)).axes()
        assert axis.name == name
        np.testing.assert_array_equal(axis.signal, values)


# --- what people bring -------------------------------------------------------------------------------------


def rows_of(table: np.ndarray) -> list[str]:
    """Lines of a table."""
    return [",".join(f"{value:.17g}" for value in row) for row in table]


def reading_of(log: ImuLog) -> str:
    return "; ".join(log.reading)


# Columns before the sensors and what stands there in a row, gyro and accelerometer with % for an axis, the axes, and
# by whose convention their units are, or which they are.
PROGRAMS = {
    "ROS topic as CSV": (
        "%time,field.header.seq,field.header.frame_id", lambda row: f"{1637290175093370803 + row * 10**7},{row},imu",
        "field.angular_velocity.%", "field.linear_acceleration.%", "xyz", "REP 103",
    ),
    "plotting program": (
        "__time", lambda row: f"{1637290175 + row * 0.01:.3f}",
        "/robot/imu/data/angular_velocity/%", "/robot/imu/data/linear_acceleration/%", "xyz", "REP 103",
    ),
    "PX4": ("timestamp", lambda row: 10**4 * (500 + row), "gyro_rad[%]", "accelerometer_m_s2[%]", "012", "PX4"),
    "ArduPilot": (
        "timestamp,T,TimeUS", lambda row: f"{1.7e9 + 0.01 * row:.6f},41.5,{10**4 * (500 + row)}",
        "Gyr%", "Acc%", "XYZ", "ArduPilot",
    ),
    "VectorNav": (
        "TimeStartup,Temp", lambda row: f"{10**7 * (500 + row)},25.1", "AngularRate%", "Accel%", "XYZ", "VectorNav",
    ),
    "MATLAB": ("Time", lambda row: f"{row / 100} sec", "AngularVelocity_%", "LinearAcceleration_%", "123", "REP 103"),
    "receiver": (
        "TOW [0.001 s],WNc [w]", lambda row: f"{10 * row},2250", "%AngRate [deg/s]", "%Accel [mg]", "xyz", "deg mg",
    ),
    "evaluation board": (
        "epoch (ms)", lambda row: 1_700_000_000_000 + 10 * row, "%GYRO_OUT (dps)", "%ACCL_OUT (mg)", "XYZ", "deg mg",
    ),
    "board with T(°)": (
        "time,DeviceName,T(°)", lambda row: f"2024-05-01 12:00:{0.01 * row + 10:06.3f},W 1,30",
        "As%(°/s)", "Acc%(mg)", "XYZ", "deg mg",
    ),
    "Kalibr": ("timestamp", lambda row: 10**7 * (170396168542 + row), "omega_%", "alpha_%", "xyz", "Kalibr"),
    "tracker": (
        "PacketCounter,SampleTimeFine,UTC_Second", lambda row: f"{51400 + row},{100 * row},NaN",
        "Gyr_%", "Acc_%", "XYZ", "MT Manager",
    ),
    "phone": (
        '"Time (s)"', lambda row: f"{0.01 * row:.4f}", '"Gyroscope % (rad/s)"', '"Acceleration % (m/s^2)"', "xyz", "",
    ),
    "dates": (
        "stamp", lambda row: f"2024-05-01 12:00:{0.01 * row + 10:06.3f}",
        "gyro_%_deg_per_s", "acc_% in m/s^2", "xyz", "deg",
    ),
    "seconds and nanoseconds": (
        "header.stamp.secs,header.stamp.nsecs", lambda row: f"{1637290175 + row // 100},{row % 100 * 10**7}",
        "angular_velocity.%", "linear_acceleration.%", "xyz", "REP 103",
    ),
    "ROS 2": (
        "sec,nanosec", lambda row: f"{1637290175 + row // 100},{row % 100 * 10**7}",
        "angular_velocity_%", "linear_acceleration_%", "xyz", "REP 103",
    ),
    "MAVLink": ("time_boot_ms", lambda row: 10 * (500 + row), "%gyro [deg/s]", "%acc [mg]", "xyz", "deg mg"),
    "flight controller of a drone": (
        "time (us)", lambda row: 10**4 * (500 + row), "gyroADC[%] (deg/s)", "accSmooth[%] (mg)", "012", "deg mg",
    ),
    "axes by their units": ("t [s]", lambda row: f"{row / 100}", "% [°/h]", "% [mg]", "xyz", "deg/h mg"),
    "axes before a rate": ("Time (s)", lambda row: f"{row / 100}", "% Rot (rad/s)", "% Acc (mg)", "XYZ", "mg"),
    "Greek and German": ("Zeit [s]", lambda row: f"{row / 100}", "ω% [°/s]", "a% [mg]", "xyz", "deg mg"),
    "milliseconds without a unit": ("timestamp", lambda row: 10 * row, "w% [rad·s⁻¹]", "a% [mg]", "xyz", "mg"),
}  # fmt: skip


@pytest.mark.parametrize("program", PROGRAMS)
def test_names_of_programs(program: str):
    before, stamp, gyro_name, force_name, axes, by = PROGRAMS[program]
    names = [name.replace("%", axis) for name in (gyro_name, force_name) for axis in axes]
    gyro = np.degrees(GYRO) * (3600.0 if "/h" in by else 1.0) if "deg" in by else GYRO
    force = FORCE / 9.80665e-3 if "mg" in by else FORCE
    lines = [f"{stamp(row)},{line}" for row, line in enumerate(rows_of(np.hstack([gyro, force])))]
    header = ",".join([before, *names])
    log = read_log("\n".join([header, *lines]).encode())
    np.testing.assert_allclose(log.gyro, GYRO, rtol=1e-12)
    np.testing.assert_allclose(log.accelerometer, FORCE, rtol=1e-12)
    assert log.rate_hz == pytest.approx(100.0, rel=1e-5)
    if by not in ("", "deg", "mg", "deg mg", "deg/h mg"):
        assert f"by convention ({by})" in reading_of(log)
    if program == "ROS topic as CSV":
        assert "not used: field.header.seq, field.header.frame_id" in reading_of(log)


def test_a_tracker_whose_rates_may_be_degrees_is_asked_for_them():
    """Movella DOT writes degrees per second and microseconds under the names of MT Manager, without the date."""
    lines = [f"{row},{8333 * row}," + line for row, line in enumerate(rows_of(np.hstack([np.degrees(GYRO), FORCE])))]
    text = "\n".join(["PacketCounter,SampleTimeFine,Gyr_X,Gyr_Y,Gyr_Z,Acc_X,Acc_Y,Acc_Z", *lines])
    with pytest.raises(InputError, match="does not give the gyro unit") as refused:
        read_log(text.encode())
    assert refused.value.key == "gyro_unit"
    log = read_log(text.encode(), LogOptions(gyro_unit="deg/s"))
    np.testing.assert_allclose(log.gyro, GYRO, rtol=1e-12)
    np.testing.assert_allclose(log.accelerometer, FORCE, rtol=1e-12)
    assert log.rate_hz == pytest.approx(120.0, rel=1e-4)


@pytest.mark.parametrize(
    ("comment", "rate"), [("", 100.0), ("// Sample rate: 100.0Hz\n", None)], ids=["given", "in a comment"]
)
def test_a_tracker_that_counts_tenths_of_a_millisecond_is_read_at_its_stated_rate(comment, rate):
    """MT Manager without the date: 100 a sample is 10 Hz in ms and 10 kHz in µs, and 100 Hz is neither."""
    lines = [f"{row},{100 * row}," + line for row, line in enumerate(rows_of(np.hstack([GYRO, FORCE])))]
    text = comment + "\n".join(["PacketCounter,SampleTimeFine,Gyr_X,Gyr_Y,Gyr_Z,Acc_X,Acc_Y,Acc_Z", *lines])
    log = read_log(text.encode(), LogOptions(gyro_unit="rad/s", rate_hz=rate))
    np.testing.assert_allclose(log.gyro, GYRO, rtol=1e-12)
    assert log.rate_hz == pytest.approx(100.0, rel=1e-5)
    assert "taken as 0.1 ms" in reading_of(log)


def test_angular_accelerations_are_no_specific_forces():
    lines = rows_of(np.hstack([TIME + 1.7e9, GYRO, FORCE - 9.8]))
    log = read_log("\n".join(["timestamp,omega_x,omega_y,omega_z,alpha_x,alpha_y,alpha_z", *lines]).encode())
    assert log.accelerometer is None
    assert "alpha not used" in reading_of(log)


def test_units_below_the_names_and_padded_lines_above_them():
    header = "Recorder;7;;\nRate of GNSS: 10 Hz;;;\ntime;gyro_x;gyro_y;gyro_z\ns;deg/s;deg/s;deg/s\n"
    text = header + csv(np.hstack([TIME, np.degrees(GYRO)]), delimiter=";").decode()
    log = read_log(text.encode("cp1252"))
    np.testing.assert_allclose(log.gyro, GYRO, rtol=1e-12)
    assert log.rate_hz == pytest.approx(100.0)
    assert "10 Hz" not in reading_of(log)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_encodings(encoding: str):
    header = "time [s],gyro_x [°/s],gyro_y [°/s],gyro_z [°/s],acc_x [m/s²],acc_y [m/s²],acc_z [m/s²]"
    log = read_log(csv(np.hstack([TIME, np.degrees(GYRO), FORCE]), header).decode().encode(encoding))
    np.testing.assert_allclose(log.gyro, GYRO, rtol=1e-9)
    np.testing.assert_allclose(log.accelerometer, FORCE, rtol=1e-9)


@pytest.mark.parametrize(
    ("comment", "rate"),
    [
        ("# sample rate: 200 Hz", 200.0),
        ("// Update Rate: 200.0Hz", 200.0),
        ("% fs = 0.2 kHz", 200.0),
        ("# IMU recorded at 200 Hz", 200.0),
        ("# imu_rate_hz: 200", 200.0),
        ("# GNSS rate: 10 Hz", None),
        ("# rate 1.2.3 Hz", None),
        ("# rate . Hz", None),
        ("# bandwidth 50 Hz", None),
        ("# filter frequency: 98 Hz", None),
        ("# accelerometer output rate 62.5 Hz", None),
        ("# baud rate 115200", None),
    ],
)
def test_only_a_rate_of_these_samples_is_one(comment: str, rate: float | None):
    content = csv(GYRO, comment + "\n" + ",".join(f"{name} [rad/s]" for name in NAMES[:3]))
    if rate is None:
        with pytest.raises(InputError, match="does not give the rate"):
            read_log(content)
    else:
        assert read_log(content).rate_hz == rate


def test_stamps_win_over_a_comment_and_the_contradiction_is_said():
    log = read_log(b"# sample rate: 200 Hz\n" + "\n".join(GOOD).encode())
    assert log.rate_hz == pytest.approx(100.0)
    assert "a comment in the file says 200 Hz" in reading_of(log)


def test_lost_samples_and_rows_without_a_value_are_gaps():
    for content in (
        GOOD[:20] + GOOD[21:],
        [*GOOD[:20], "0.19,,,,,,", *GOOD[21:]],
        [*GOOD[:20], "0.19" + ",nan" * 6, *GOOD[21:]],
    ):
        log = read_log("\n".join(content).encode())
        assert log.rate_hz == pytest.approx(100.0)
        assert {role: breaks.tolist() for role, breaks in log.breaks.items()} == {"gyro": [19], "accelerometer": [19]}
        np.testing.assert_allclose(log.gyro, np.delete(GYRO, 19, axis=0), rtol=1e-9)
        assert "1 samples lost, so read in 2 stretches" in reading_of(log)
    untimed = csv(np.where(np.arange(50)[:, None] == 30, np.nan, GYRO), ",".join(f"{n} [rad/s]" for n in NAMES[:3]))
    assert read_log(untimed, LogOptions(rate_hz=10.0)).breaks["gyro"].tolist() == [30]


def test_sensors_without_a_number_are_told():
    with pytest.raises(InputError, match=r"gyro_x \[rad/s\], .* hold no numbers"):
        read_log(csv(GYRO * np.nan, ",".join(f"{name} [rad/s]" for name in NAMES[:3])), LogOptions(rate_hz=1.0))


def test_sensors_in_rows_of_their_own_have_their_own_rates():
    lines, gyro, force = [GOOD[0]], rows_of(GYRO), rows_of(FORCE)
    for row in range(50):
        time = f"{row * 0.01:.3f}"
        lines.append(f"{time},{gyro[row]},,,")
        if row % 2 == 0:
            lines.append(f"{row * 0.01 + 0.003:.3f},,,,{force[row]}")
    log = read_log("\n".join(lines).encode())
    np.testing.assert_allclose(log.gyro, GYRO)
    np.testing.assert_allclose(log.accelerometer, FORCE[::2])
    assert [axis.rate_hz for axis in log.axes()] == pytest.approx([100.0] * 3 + [50.0] * 3)
    assert not log.breaks


def test_a_held_sensor_is_read_at_its_own_rate_also_as_increments():
    rng = np.random.default_rng(5)
    gyro, force = rng.standard_normal((400, 3)), rng.standard_normal((100, 3)) + 9.8
    table = np.hstack([np.arange(400)[:, None] * 0.004, gyro, np.repeat(force, 4, axis=0)])
    log = read_log(csv(table, GOOD_HEADER))
    np.testing.assert_allclose(log.accelerometer, force)
    assert [axis.rate_hz for axis in log.axes()] == pytest.approx([250.0] * 3 + [62.5] * 3)
    assert "each value of accelerometer is held for 4 rows; analysed at its own 62.5 Hz" in reading_of(log)
    summed = read_log(csv(table, GOOD_HEADER.replace("m/s^2", "m/s")))
    np.testing.assert_allclose(summed.accelerometer, force * 62.5)


@pytest.mark.parametrize(
    ("stamps", "options", "complaint"),
    [
        (np.arange(50) * 100, {}, r"'time' goes up by 100 a sample, which is 10 Hz in ms or 10000 Hz in us"),
        (np.arange(50), {}, "'time' goes up by 1 a sample"),
    ],
)
def test_stamps_with_two_meanings_are_asked_about(stamps: np.ndarray, options: dict[str, float], complaint: str):
    header = "time," + ",".join(f"{name} [rad/s]" for name in NAMES[:3])
    with pytest.raises(InputError, match=complaint) as refused:
        read_log(csv(np.column_stack([stamps, GYRO]), header), LogOptions(**options))
    assert refused.value.key == "rate"
    assert read_log(csv(np.column_stack([stamps, GYRO]), header.replace("time", "time [ms]"))).rate_hz > 1.0


def test_several_times_are_one_if_they_agree():
    header = "time [s],stamp [s]," + ",".join(f"{name} [rad/s]" for name in NAMES[:3])
    jittery = TIME + 0.002 * np.random.default_rng(2).random(TIME.shape)
    log = read_log(csv(np.hstack([jittery, TIME, GYRO]), header))
    assert "from stamp [s]" in reading_of(log)
    assert "time [s] not used" in reading_of(log)
    with pytest.raises(InputError, match=r"disagree: 'time \[s\]' 50 Hz, 'stamp \[s\]' 100 Hz"):
        read_log(csv(np.hstack([2 * TIME, TIME, GYRO]), header))


def test_an_option_that_nothing_in_the_file_answers_to_is_refused():
    gyro_alone = csv(GYRO, ",".join(f"{name} [rad/s]" for name in NAMES[:3]))
    with pytest.raises(InputError, match="'g' is given, but the file has no accelerometer") as refused:
        read_log(gyro_alone, LogOptions(rate_hz=100.0, accelerometer_unit="g"))
    assert refused.value.key == "accelerometer_unit"
    with pytest.raises(InputError, match="The file is a table"):
        read_log(gyro_alone, LogOptions(rate_hz=100.0, arrays={"gyro": "w"}))
    with pytest.raises(InputError, match="The file is an NPZ archive"):
        read_log(npz(gyro_dps=GYRO, fs=100.0), LogOptions(columns=NAMES[:3]))
    with pytest.raises(InputError, match="'furlong' is not understood") as refused:
        read_log(csv(GYRO, "gyro_x [furlong],gyro_y [furlong],gyro_z [furlong]"), LogOptions(rate_hz=100.0))
    assert refused.value.key == "gyro_unit"


def test_decimal_commas_between_commas_are_refused_as_what_they_are():
    row = "0,{n:02d},0,5,0,25,0,125"
    text = "time [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s]\n" + "\n".join(row.format(n=n) for n in range(50))
    with pytest.raises(InputError, match="decimal commas between commas"):
        read_log(text.encode())


def test_names_of_a_file_are_told_short():
    header = (
        "time [s],"
        + ",".join(f"{name} [rad/s]" for name in NAMES[:3])
        + "".join(f",<b>{'x' * 500}{n}</b>" for n in range(30))
    )
    log = read_log(csv(np.hstack([TIME, GYRO, np.tile(GYRO[:, :1], 30)]), header))
    assert len(reading_of(log)) < 600
    assert "and 22 more" in reading_of(log)
