"""Uploaded files are read, or refused, within the memory limit of their kind."""

import json
import subprocess
import sys

import pytest
from waiting import PATIENCE

pytestmark = pytest.mark.long

# Each in a process of its own, so that what it took is what reading took, MB. They begin as copies of one that has
# imported what they need.
_READ = """
import io, json, multiprocessing, resource, sys, zipfile
import numpy as np
from app.library.exchange import _listed, _unpack
from nav_model.allan.log_content import Limits, LogOptions
from nav_model.allan.log_file import read_log
from nav_model.base.errors import InputError
from nav_model.design.offers import read_offers
from nav_model.sar.image import read_phase_history
from nav_model.sar.pictures import uploaded_pictures
from nav_model.trajectory.files.reader import parse_file

def packed(**members):
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name, content in members.items():
            archive.writestr(name.replace("__", "."), content)
    return data.getvalue()

def npy(count, dtype, held=b""):
    data = io.BytesIO()
    np.lib.format.write_array_header_1_0(data, {"descr": dtype, "fortran_order": False, "shape": (count,)})
    return data.getvalue() + held

def log(content):
    read_log(content, LogOptions(rate_hz=100, gyro_unit="rad/s"), limits=Limits(30_000_000, 60_000_000, 5_000_000))

def history(content):
    read_phase_history("file", content)

def picture(content):
    uploaded_pictures("file", content, np.linspace(0, 1, 9), np.zeros(9), 5.0)

def ones(frequencies, pulses):
    lines = {name: np.ones(pulses) for name in ("x", "y", "z", "r0")}
    data = io.BytesIO()
    samples, band = np.ones((frequencies, pulses), complex), np.linspace(1e10, 1.001e10, frequencies)
    np.savez_compressed(data, fp=samples, freq=band, **lines)
    return data.getvalue()

def flight(content):
    parse_file(content, "file")

def offers(content):
    read_offers(content.decode())

def ulog(*messages):
    head = b"ULog" + bytes((1, 18, 53, 1)) + bytes(8)
    return head + b"".join(len(body).to_bytes(2, "little") + kind + body for kind, body in messages)

def library(content):
    _listed(_unpack(content))

def held(peak):  # not ru_maxrss, which begins at what the process that started this one has
    return int(next(line for line in open("/proc/self/status") if line.startswith(peak)).split()[1]) / 1024

def read(kind, source):
    resource.setrlimit(resource.RLIMIT_CPU, (60, 60))
    content = eval(source)
    before = held("VmRSS")
    open("/proc/self/clear_refs", "w").write("5")  # the peak from here on
    try:
        globals()[kind](content)
        message = "read"
    except ValueError as error:
        message = str(error)
    return held("VmHWM") - before, message

with multiprocessing.get_context("fork").Pool(1, maxtasksperchild=1) as pool:
    print(json.dumps(pool.starmap(read, json.loads(sys.argv[1]), chunksize=1)))
"""
_FORMAT = r"FMT, 130, 50, IMU, QB, TimeUS,GyrX,GyrY,GyrZ\n"  # of a text dump
_CASES = [
    ("log", "b'1,' * 14_000_000", 100, "longer than 100000 characters"),
    ("log", "(b'1,' * 99 + b'1\\n') * 145_000", 250, "No header names its 100 columns"),
    ("log", "b'1 2 3' + b' ' * 9_900 + b'\\n' + (b'1 2 3' + b' ' * 9_900 + b'\\n') * 2_900", 250, "No header"),
    ("log", "b'\\n' * 29_000_000", 100, "hold no numbers"),
    ("log", "b'gyro_x,gyro_y\\n' + b'1,2\\n' * 7_000_000", 250, "More than 60 MB of numbers"),
    ("log", "b'gyro_x\\n' + b'1\\n' * 14_900_000", 250, "more than 5000000 rows"),
    ("log", "packed(gyro__npy=npy(10**12, '<f8'))", 20, "declares 8000000000000 bytes"),
    ("log", "packed(gyro__npy=npy(10**8, '|u1', b'0' * 10**8))", 20, "unpacks to 100 MB"),
    ("log", f"b'{_FORMAT}' + b'ab\\n' * 9_600_000", 100, "its lines are too short for one"),
    ("log", f"b'{_FORMAT}' + b''.join(b'%014x;\\n' % n for n in range(1_750_000))", 100, "without IMU or IMU2"),
    ("flight", "b'a' + b' ' * 90_000 + b'b,c\\n' + b'1,2,3\\n' * 30", 20, "3 numbers under 2 names"),
    ("flight", "b'time,a[d' + b\"'\" * 3_000 + b'x,c\\n' + b'1,2,3,4\\n' * 30", 20, "4 numbers under 3 names"),
    ("flight", "b'time,a' + b'[' * 90_000 + b',c\\n' + b'1,2,3\\n' * 30", 20, "are missing; found time"),
    ("flight", "b'time,lat,lon,alt\\n0,1' + b' ' * 3_000 + b'x,8,5\\n' + b'1,47,8,5\\n' * 30", 20, "is not a number"),
    ("flight", "b'time;position\\n' + (b'0;47.1' + b' ' * 40_000 + b'\\n') * 99 + b'0;47.1,8.1\\n' * 30", 30,
     "has no height"),
    ("flight", "b'#INSPVAXA,' * 1_500_000", 20, "holds no INSPVAXA"),
    ("flight", "ulog(*((b'F', b'l%d:l%d[10] a;' % (n, n - 1)) for n in range(1, 9)), (b'F', b'l0:float[10] a;'), "
     "(b'A', b'...l8'))", 50, "more than 200000 fields"),
    ("flight", "ulog((b'F', b'a:a b;'), (b'A', b'...a'))", 20, "is a PX4 log (ULog) that is damaged"),
    ("flight", "ulog((b'F', b'vehicle_local_position:uint64_t timestamp;float x;'), "
     "(b'A', bytes(3) + b'vehicle_local_position'), (b'D', bytes(14)))", 20, "(ULog) that is damaged"),
    ("flight", "ulog((b'F', b'l:uint64_t timestamp;'), (b'A', b'...l')) + bytes(15_000_000)", 40, "are empty"),
    ("offers", "b'Name;ARW' + b'([' * 1_900 + b'x\\n' + b'a;1 deg\\n' * 1_900", 20, "is not a unit of angle"),
    ("history", "packed(fp__npy=npy(10**12, '<c16'))", 20, "declares 16000000000000 bytes"),
    ("history", "packed(fp__npy=npy(3 * 10**8, '|u1', b'0' * 3 * 10**8))", 20, "unpacks to 300 MB"),
    ("picture", "ones(4096, 256)", 250, "read"),
    ("picture", "ones(2, 200_000)", 100, "at most 20000 of each are taken"),
    ("picture", "ones(200_000, 2)", 100, "at most 20000 of each are taken"),
    ("library", "packed(a__toml=b'#' * 10**8)", 20, "unpacks to more than 1000000 bytes"),
    ("library", "packed(**{f'a{i}__toml': b'' for i in range(2001)})", 20, "2001 files; at most 2000"),
    ("library", "packed(library__json=b'[' * 19_000_000)", 220, "has more than 100000 parts"),
    ("library", "packed(library__json=b'{\"format\":1,\"designs\":[' + b'[],' * 6_000_000)", 220,
     "has more than 100000 parts"),
]  # fmt: skip


@pytest.fixture(scope="module")
def readings() -> dict[str, tuple[float, str]]:
    """Memory and message by content."""
    contents = [(kind, content) for kind, content, *_ in _CASES]
    command = [sys.executable, "-c", _READ, json.dumps(contents)]
    # A copy that is killed never answers.
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=PATIENCE)
    readings = json.loads(done.stdout)
    return {content: reading for (_, content), reading in zip(contents, readings, strict=True)}


@pytest.mark.parametrize(("kind", "content", "most", "message"), _CASES)
def test_a_file_takes_no_more_than_its_kind_may(
    readings: dict[str, tuple[float, str]], kind: str, content: str, most: float, message: str
) -> None:
    memory, text = readings[content]
    assert message in text
    assert memory < most
