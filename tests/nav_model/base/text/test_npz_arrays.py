"""A damaged or hostile NPZ is refused under the name of its file, whatever its readers raise."""

import io
import struct
import zipfile
from typing import Any

import numpy as np
import pytest

from nav_model.allan.log_content import LogOptions
from nav_model.allan.log_file import read_log
from nav_model.base.errors import InputError
from nav_model.base.text.npz_arrays import read_npz_arrays

_HEAD = "{'descr': '<f8', 'fortran_order': False, 'shape': "
_EVENT = '{"time": "now", "event": "login"}'


def _npz(header: str, kind: int = zipfile.ZIP_STORED) -> bytes:
    text = header.encode("latin1")
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", kind) as archive:
        archive.writestr("gyro.npy", b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + bytes(800))
    return data.getvalue()


@pytest.mark.parametrize(
    "header",
    [
        _HEAD + "(10",
        _HEAD + "(" + 3 * "'",
        f"{{}}\n    {_EVENT}\n  x",
        _HEAD + "(True, 10)}",
        _HEAD + "(0, " + "9" * 60 + ")}",
        _HEAD.replace("'<f8'", "{}") + "(10,)}",
        "'" + "x" * 40,
    ],
)
def test_headers_that_are_none(header: str) -> None:
    with pytest.raises(InputError) as refused:
        read_log(_npz(header), LogOptions(rate_hz=100, gyro_unit="deg/s"), file_name="own.npz")
    assert refused.value.key == "own.npz"
    assert "login" not in str(refused.value)


@pytest.mark.parametrize("kind", [zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_random_damage(kind: int) -> None:
    random = np.random.default_rng(5)
    whole = _npz(_HEAD + "(100,)}\n", kind)
    named = set()
    for _ in range(300):
        damaged = bytearray(whole)
        for place in random.integers(0, len(whole), random.integers(1, 8)):
            damaged[place] = random.integers(0, 256)
        try:
            read_npz_arrays(bytes(damaged), "own.npz", 10**6)
        except InputError as refused:
            named.add(refused.key)
    assert named == {"own.npz"}


@pytest.mark.parametrize(("array", "arrays"), [(np.empty((0, 3)), None), (np.float64(3), {"gyro": "gyro"})])
def test_logs_without_samples(array: Any, arrays: dict[str, str] | None) -> None:
    data = io.BytesIO()
    np.savez(data, gyro=array)
    with pytest.raises(InputError):
        read_log(data.getvalue(), LogOptions(rate_hz=100, gyro_unit="deg/s", arrays=arrays), file_name="own.npz")


def test_a_long_name_of_an_array_is_told_in_short() -> None:
    data = io.BytesIO()
    np.savez(data, **{"gyro_" + "n" * 5000: np.zeros((9, 4)), **{f"{'k' * 5000}{place}": 1 for place in range(99)}})
    for arrays in ({"gyro": "no"}, {"gyro": "gyro_" + "n" * 5000}):
        with pytest.raises(InputError) as refused:
            read_log(data.getvalue(), LogOptions(rate_hz=100.0, arrays=arrays), "a.npz")
        assert len(str(refused.value)) < 400
    whole = _npz(_HEAD + "(100,)}").replace(b"gyro.npy", b"gyro.txt")
    with pytest.raises(InputError, match=r"array 'gyro.txt': not a plain .npy array"):
        read_npz_arrays(whole, "a.npz", 10**6)
