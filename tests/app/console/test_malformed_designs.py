"""A corpus of malformed designs: each is refused with exit 2 and one line that names the key or the file."""

import io
import sys
from pathlib import Path

import pytest

from app.cli import main

FILE = None  # the message names the file, because no key is to blame

NOT_A_DESIGN = {
    "empty": b"",
    "white space": b"  \n\t\n",
    "comment only": b"# nothing\n",
    "byte order mark only": b"\xef\xbb\xbf",
    "null byte": b"\x00",
    "null bytes inside": b'name = "a\x00b"\n',
    "binary": bytes(range(256)),
    "executable": b"\x7fELF\x02\x01\x01" + bytes(64),
    "picture": b"\x89PNG\r\n\x1a\n" + bytes(range(200)),
    "utf-16": 'name = "a"\n'.encode("utf-16"),
    "latin-1": b'name = "caf\xe9"\n',
    "cut utf-8": b'name = "\xc2',
    "json": b'{"imu": {"rate": "100 Hz"}}',
    "yaml": b"imu:\n  rate: 100 Hz\n",
    "prose": b"a design with a good gyro\n",
    "unclosed string": b'name = "a\n',
    "unclosed section": b"[imu\n",
    "no value": b"[imu]\nrate =\n",
    "bare quantity": b"[imu]\nrate = 100 Hz\n",
    "section twice": b'[imu]\nrate = "1 Hz"\n[imu]\nvibration_factor = 1.0\n',
    "deep arrays": b"x = " + b"[" * 50_000,
    "deep tables": b"x = " + b"{a=" * 20_000,
    "endless integer": b"[requirements]\nconfidence = " + b"1" * 5000 + b"\n",
    "two megabytes": b"#" * 2_000_000,
    "wrong date": b"[imu]\nrate = 2020-13-45\n",
}
WRONG_KEY = {
    "unknown section": ("[antenna]\ngain = 1\n", "antenna"),
    "unknown top key": ("title = 'a'\n", "title"),
    "unknown key": ('[imu]\nwheels = "4 m"\n', "imu.wheels"),
    "misspelt key": ('[imu]\nangle_random_walks = "1 °/√h"\n', "imu.angle_random_walks"),
    "key of another section": ('[imu]\nspeed = "1 m/s"\n', "imu.speed"),
    "capitals": ('[IMU]\nrate = "1 Hz"\n', "IMU"),
    "key without section": ('rate = "1 Hz"\n', "rate"),
    "control character in key": ('[imu]\n"a\\u001b[2J\\nb" = 1\n', "imu.a"),
    "empty key": ('[imu]\n"" = 1\n', "imu."),
    "duplicate key": ('[imu]\nrate = "1 Hz"\nrate = "2 Hz"\n', "imu.rate"),
    "duplicate dotted key": ('imu.rate = "1 Hz"\nimu.rate = "2 Hz"\n', "imu.rate"),
    "duplicate by another name": ('[gnss]\nrate = "1 Hz"\ninterval = "1 s"\n', "gnss.interval"),
    "frequency and wavelength": ('[radar]\nfrequency = "1 GHz"\nwavelength = "3 cm"\n', "radar.wavelength"),
    "section as text": ('imu = "STIM300"\n', "imu"),
    "section as list": ('[[imu]]\nrate = "1 Hz"\n', "imu"),
    "section as number": ("gnss = 3\n", "gnss"),
    "key as section": ('[imu.rate]\nvalue = "1 Hz"\n', "imu.rate"),
    "deep value": ("imu.rate" + ".a" * 5000 + " = 1\n", "imu.rate"),
    "endless list": ("[imu]\nrate = [" + "1," * 100_000 + "]\n", "imu.rate"),
    "name as number": ("name = 3\n", "name"),
    "endless name": (f'name = "{"a" * 20_000}"\n', "name"),
    "unknown preset": ('[imu]\npreset = "Nokia 3310"\n', "imu.preset"),
    "preset as number": ("[radar]\npreset = 1\n", "radar.preset"),
    "preset for a section without": ('[gnss]\npreset = "u-blox"\n', "gnss.preset"),
    "preset without velocity random walk": ('[imu]\npreset = "HG9900"\n', "imu.velocity_random_walk"),
}
WRONG_VALUE = {  # section.key, TOML value, and what of the message says what is allowed
    "number without quotes": ("imu.velocity_random_walk", "0.05"),
    "quantity as flag": ("imu.angle_random_walk", "true"),
    "quantity as list": ("imu.angle_random_walk", '["1 °/√h"]'),
    "quantity as table": ("imu.angle_random_walk", '{value = 1, unit = "°/√h"}'),
    "quantity as date": ("coast.duration", "2020-01-01"),
    "no unit": ("imu.angle_random_walk", '"0.5"'),
    "no number": ("imu.angle_random_walk", '"°/√h"'),
    "empty text": ("imu.angle_random_walk", '""'),
    "unknown unit": ("gnss.position_noise", '"1 parsec"'),
    "two units run together": ("gnss.position_noise", '"1 m m"'),
    "wrong dimension": ("gnss.position_noise", '"1 s"', "Use m, km, cm"),
    "rate for random walk": ("imu.angle_random_walk", '"0.5 °/h"'),
    "bias for random walk": ("imu.velocity_random_walk", '"80 µg"'),
    "accelerometer unit at the gyro": ("imu.angle_random_walk", '"0.05 m/s/√h"'),
    "two numbers": ("gnss.position_noise", '"1 2 m"'),
    "null in a unit": ("imu.rate", '"1 \\u0000Hz"'),
    "line end in a unit": ("imu.rate", '"1 H\\nz"'),
    "zero noise": ("imu.velocity_random_walk", '"0 m/s/√h"'),
    "zero gyro noise": ("imu.angle_random_walk", '"0 °/√h"'),
    "zero fixes": ("gnss.position_noise", '"0 m"'),
    "zero interval": ("gnss.interval", '"0 s"'),
    "zero rate": ("gnss.rate", '"0 Hz"', "at most 1000 Hz"),
    "zero wavelength": ("radar.wavelength", '"0 cm"', "at most 2997.92 cm"),
    "zero speed": ("flight.speed", '"0 m/s"'),
    "zero limit": ("requirements.quadratic_phase", '"0°"'),
    "negative noise": ("imu.velocity_random_walk", '"-0.05 m/s/√h"'),
    "negative bias": ("imu.gyro_bias", '"-1 °/h"'),
    "negative wavelength": ("radar.wavelength", '"-3 cm"'),
    "negative duration": ("coast.duration", '"-1 s"'),
    "vanishing noise": ("imu.velocity_random_walk", '"1e-300 m/s/√h"'),
    "underflow": ("gnss.position_noise", '"1e-399 m"'),
    "nan": (
        "imu.vibration_factor",
        "nan",
        "The vibration factor must be at least 0.01 and at most 1000.",
    ),
    "nan as text": ("imu.angle_random_walk", '"nan °/√h"'),
    "infinite": ("imu.vibration_factor", "inf"),
    "minus infinite": ("requirements.confidence", "-inf"),
    "infinite as text": ("gnss.position_noise", '"inf m"'),
    "overflow": ("gnss.position_noise", '"1e399 m"'),
    "absurd exponent": ("gnss.position_noise", '"1e999999999 m"'),
    "huge noise": ("imu.angle_random_walk", '"1e6 °/√h"', "at most 360 °/√h"),
    "huge integer": ("imu.vibration_factor", "1" + "0" * 400),
    "huge range": ("radar.slant_range", '"1e12 km"'),
    "beyond the pole": ("flight.latitude", '"91°"'),
    "grazing beyond the vertical": ("radar.grazing_angle", '"95°"'),
    "factor as text": ("imu.vibration_factor", '"many"'),
    "factor as flag": ("imu.vibration_factor", "true"),
    "factor with a unit": ("imu.vibration_factor", '"3 m"'),
    "unknown window": ("radar.window", '"hann"', "uniform, hamming or taylor"),
    "window as number": ("radar.window", "3"),
    "order without closed form": ("radar.autofocus_order", "4"),
    "order as fraction": ("radar.autofocus_order", "1.5"),
    "order as flag": ("radar.autofocus_order", "true"),
    "switch as number": ("gnss.correlated", "1"),
    "switch as word": ("gnss.correlated", '"perhaps"'),
    "unknown moment": ("requirements.steady_state", '"best"'),
}


def _corpus():
    for name, data in NOT_A_DESIGN.items():
        yield pytest.param(data, FILE, "", id=name)
    for name, (text, key) in WRONG_KEY.items():
        yield pytest.param(text.encode(), key, "", id=name)
    for name, (key, value, *words) in WRONG_VALUE.items():
        section, _, leaf = key.partition(".")
        yield pytest.param(f"[{section}]\n{leaf} = {value}\n".encode(), key, "".join(words), id=name)


CORPUS = list(_corpus())


def _refused(capsys, arguments, key, words=""):
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert err.endswith("\n")
    line = err.removesuffix("\n")
    assert line.isprintable()
    assert len(line) < 1000
    assert line.startswith(f"navbudget: {key}")
    assert words in line


@pytest.mark.parametrize(("data", "key", "words"), CORPUS)
def test_refused(capsys, monkeypatch, tmp_path, data, key, words):
    path = tmp_path / "design.toml"
    path.write_bytes(data)
    for command in ("evaluate", "check"):
        _refused(capsys, [command, str(path)], key or str(path), words)
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data), encoding="utf-8"))
    _refused(capsys, ["evaluate", "-"], key or "standard input", words)


def test_a_path_that_leads_nowhere_a_directory_and_a_file_nobody_may_read(capsys, tmp_path, monkeypatch):
    for name in ("missing.toml", "no/such/directory.toml", "nul\0.toml", "x" * 5000):
        assert main(["evaluate", f"{tmp_path}/{name}"]) == 2
        out, err = capsys.readouterr()
        assert (out, err.count("\n")) == ("", 1)
        assert "cannot be read" in err
    _refused(capsys, ["evaluate", str(tmp_path)], str(tmp_path))
    path = tmp_path / "secret.toml"
    path.write_text('name = "a"\n')

    opened = Path.open

    def refuse(self, *options, **named):
        if self == path:
            raise PermissionError(13, "Permission denied", str(self))
        return opened(self, *options, **named)

    monkeypatch.setattr(Path, "open", refuse)  # root may read everything, so modes prove nothing here
    _refused(capsys, ["evaluate", str(path)], f"{path}: cannot be read: Permission denied")


EXTREMES = {
    "gnss.position_noise": ("1e-6", "1e4", "m"), "gnss.interval": ("1e-3", "3600", "s"),
    "gnss.correlated_noise": ("1e-6", "1e4", "m"), "gnss.correlation_time": ("0.1", "1e5", "s"),
    "imu.velocity_random_walk": ("1e-9", "60", "m/s/√h"), "imu.angle_random_walk": ("1e-9", "360", "°/√h"),
}  # fmt: skip


@pytest.mark.parametrize("pattern", range(2 ** len(EXTREMES)))
def test_the_corners_of_what_is_allowed_give_numbers_or_one_line(capsys, tmp_path, pattern):
    """Sensors ten orders of magnitude apart: a budget without NaN, or a refusal by key; never a traceback."""
    changes = ["gnss.correlated=true"] + [
        f"{key}={ends[pattern >> bit & 1]} {ends[2]}" for bit, (key, ends) in enumerate(EXTREMES.items())
    ]
    path = tmp_path / "design.toml"
    path.write_text('name = "corner"\n')
    code = main(["evaluate", str(path), "--set", *changes])
    out, err = capsys.readouterr()
    assert code in {0, 2}
    assert (out == "") == (code == 2)
    assert err.count("\n") == (code == 2)
    assert "NaN" not in out
    if code == 2:
        assert err.startswith(("navbudget: gnss.", "navbudget: imu."))
