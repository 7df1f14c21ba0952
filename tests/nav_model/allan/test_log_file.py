"""Reading logs: the layouts of the field, and every malformed upload refused by name."""

import io
import math
import zipfile
from pathlib import Path

import numpy as np
import pytest

from nav_model.allan.log_file import Limits, LogOptions, read_log
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
        (spoilt(7, 2, "nan"), r"line 7, column 3: 'nan'"),
        (spoilt(9, 4, "inf"), r"line 9, column 5: 'inf'"),
        (spoilt(12, 1, "N/A"), r"line 12, column 2: 'N/A' is not a number"),
        (spoilt(12, 1, ""), r"line 12, column 2: 'nothing' is not a number"),
        (spoilt(20, 6, "1.0,2.0"), r"line 20: 8 columns, 7"),
        (spoilt(20, 6, "=cmd|' /C calc'!A0"), r"line 20, column 7"),
        (spoilt(31, 0, "0.5"), r"line 3[12]"),
        (b"", "file is empty"),
        (b"\x89PNG\r\n\x1a\n\x00\x00", "not look like a CSV"),
        (b"hello\nworld\n", "No numbers"),
        (b"hello\n" * 500, "first 200 lines"),
        (b"a" * 50_000, "longer than"),
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
    with pytest.raises(InputError, match=r"line 21: irregular rate, a step of 0.02 s"):
        read_log("\n".join(GOOD[:20] + GOOD[21:]).encode())
    with pytest.raises(InputError, match="does not increase"):
        read_log("\n".join([*GOOD[:20], GOOD[19], *GOOD[20:]]).encode())
    for rate in (-1.0, 0.0, 1e-300, 1e300, math.inf, math.nan):
        with pytest.raises(InputError, match=r"A rate of .* Hz is not allowed. It must be 0.001 to 1e\+07 Hz."):
            read_log(csv(GYRO), LogOptions(columns=NAMES[:3], rate_hz=rate, gyro_unit="rad/s"))
    with pytest.raises(InputError, match=r"It must be 0.001"):
        read_log(b"time [ns],gyro_x [rad/s]\n" + b"".join(b"%de-300,1\n" % n for n in range(1, 600)))


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
    with pytest.raises(InputError, match="101 columns; a log has at most 100"):
        read_log(b",".join([b"1"] * 101))


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


def with_member(name: str, content: bytes) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, content)
    return stream.getvalue()


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
        (b"PK\x03\x04 not really", "not a readable NPZ"),
        (npz(gyro=GYRO, fs=100.0)[:-40], "not a readable NPZ"),
        (with_member("evil.py", b"print(1)"), "not a plain .npy"),
        (with_member("gyro.npy", b"garbage"), "not a readable .npy"),
        (npz(gyro=np.array(["a", "b"])), "not numbers"),
        (npz(gyro=GYRO.astype(complex)), "not numbers"),
        (npz(gyro_dps=GYRO[:, :2], fs=100.0), "three for a triad"),
        (npz(gyro_dps=GYRO, acc_g=FORCE[:-1], fs=100.0), "50 gyro but 49 accelerometer"),
        (npz(gyro_dps=np.where(np.arange(50)[:, None] == 17, np.nan, GYRO), fs=100.0), "sample 17: gyro_x"),
        (npz(velocity=GYRO, fs=100.0), "No gyro or accelerometer"),
    ],
)
def test_malformed_archive_is_refused_by_name(content: bytes, complaint: str):
    with pytest.raises(InputError, match=complaint) as refusal:
        read_log(content, file_name="flight7.npz")
    assert str(refusal.value).startswith("flight7.npz")


def test_names_and_units():
    meaning = meaning_of("Gyro Y (mdps)")
    assert (meaning.role, meaning.axis, meaning.unit) == ("gyro", 1, "mdeg/s")
    assert meaning_of("latitude") is None
    assert scale_of("accelerometer", "125 ug s").per_sample
    assert scale_of("gyro", "0.1 arcsec").factor == pytest.approx(np.radians(0.1 / 3600))
    for said in ("0.05 deg/s", "0.05 deg/s a count", "0.05 deg/s per count", "0.05 deg/s/count"):
        assert scale_of("gyro", said).factor == pytest.approx(np.radians(0.05))
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
    with pytest.raises(InputError, match="line 2: decimal commas, but decimal points elsewhere"):
        read_log(b"gyro_x [deg/s];gyro_y [deg/s];gyro_z [deg/s]\n1,5;2,5;3,5\n1.5;2;3", LogOptions(rate_hz=10.0))


def test_a_single_axis_is_a_log():
    values = np.linspace(-1.0, 1.0, 50)
    for label, name in (
        ("gyro_y [rad/s]", "gyro_y"),
        ("gyro [rad/s]", "gyro_x"),
        ("acc_z [m/s2]", "accelerometer_z"),
    ):
        text = "\n".join([label, *(f"{value!r}" for value in values.tolist())])
        ((found, _, signal),) = read_log(text.encode(), LogOptions(rate_hz=10.0)).axes()
        assert found == name
        np.testing.assert_array_equal(signal, values)
