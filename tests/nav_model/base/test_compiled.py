"""Compiled kernels: fast to start, and never older than the source they came from."""

import builtins
import errno
import importlib.util
import io
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import pytest
from numba.core.event import install_recorder

import nav_model
from nav_model.base.compiled import room_digest

pytestmark = [pytest.mark.long, pytest.mark.watches("nav_model")]

ROOM = Path(nav_model.__file__).parent
FLY = """
from numba.core.event import install_recorder
from nav_model.simulation.single_run import fly_without_errors
from nav_model.simulation.specification import ImuModel, SimulationSpec, TriadModel
imu = ImuModel(TriadModel(random_walk=1e-4), TriadModel(random_walk=1e-3))
with install_recorder("numba:compile") as compiled:
    sigma = fly_without_errors(SimulationSpec(imu, duration=10.0)).filter_sigma[1, -1, 2]
print(sigma, len(compiled.buffer))
"""


def fly(root: Path) -> tuple[float, int]:
    """Down sigma after 10 s and how often Numba compiled, in a fresh process that imports nav_model from `root`."""
    done = subprocess.run([sys.executable, "-c", FLY], cwd=root, capture_output=True, text=True, check=True)
    sigma, compiled = done.stdout.split()
    return float(sigma), int(compiled)


def test_a_fresh_process_takes_everything_from_the_cache():
    """Compiling takes ten seconds and more, loading what is compiled a tenth of one: `benchmarks` has the times."""
    fly(ROOM.parent)
    _sigma, compiled = fly(ROOM.parent)
    assert compiled == 0


def _adding(folder: Path) -> Callable[[int], tuple[int, int]]:
    """A small kernel of its own folder, read anew: what it gives, and how often Numba compiled."""
    path = folder / "adding.py"
    path.write_text("from nav_model.base.compiled import kernel\n@kernel\ndef add(a):\n    return a + 1\n")
    specification = importlib.util.spec_from_file_location("adding", path)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)

    def add(value: int) -> tuple[int, int]:
        with install_recorder("numba:compile") as compiled:
            total = module.add(value)
        return total, len(compiled.buffer)

    return add


@pytest.fixture
def beside_the_source(monkeypatch: pytest.MonkeyPatch) -> None:
    """Numba's cache lies in the folder of a file."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")


@pytest.mark.usefixtures("beside_the_source")
@pytest.mark.parametrize("kind", ["nbi", "nbc"])
@pytest.mark.parametrize("content", [b"", b"\0" * 4096, b"half"])
def test_a_damaged_file_of_the_cache_is_written_anew(tmp_path: Path, kind: str, content: bytes) -> None:
    assert _adding(tmp_path)(1) == (2, 2)  # an event at the start, one at the end
    assert _adding(tmp_path)(2) == (3, 0)
    (file,) = (tmp_path / "__pycache__").glob(f"*.{kind}")
    file.write_bytes(file.read_bytes()[:-100] if content == b"half" else content)
    assert _adding(tmp_path)(3) == (4, 2)
    assert _adding(tmp_path)(4) == (5, 0)


@pytest.mark.usefixtures("beside_the_source")
def test_with_a_full_disk_a_kernel_is_compiled_for_the_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    add, shipped = _adding(tmp_path), open

    def full(file: Any, mode: str = "r", *arguments: Any, **options: Any) -> Any:
        if "w" in mode:
            raise OSError(errno.ENOSPC, "No space left on device")
        return shipped(file, mode, *arguments, **options)

    for module in (builtins, io):
        monkeypatch.setattr(module, "open", full)
    assert add(1) == (2, 2)
    assert not list((tmp_path / "__pycache__").glob("*.nb?"))


@pytest.mark.slow
def test_without_a_place_to_write_the_simulator_still_flies(tmp_path):
    """An installation of root's, run by another user without a home: a read-only container."""
    shutil.copytree(ROOM, tmp_path / "nav_model", ignore=shutil.ignore_patterns("__pycache__"))
    for path in (tmp_path, *tmp_path.parents[:2], *tmp_path.rglob("*")):
        path.chmod(0o555 if path.is_dir() else 0o444)
    other = {"user": 65534, "group": 65534, "extra_groups": []} if os.geteuid() == 0 else {}
    environment = {"PATH": os.environ["PATH"], "HOME": "/nonexistent"}
    try:
        subprocess.run([sys.executable, "-c", ""], env=environment, check=True, capture_output=True, **other)
    except (PermissionError, subprocess.CalledProcessError):
        pytest.skip(f"another user may not run {sys.executable}")
    done = subprocess.run(
        [sys.executable, "-c", FLY],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
        **other,
    )
    assert float(done.stdout.split()[0]) == pytest.approx(fly(ROOM.parent)[0], rel=1e-12)
    for path in (*tmp_path.parents[:2], tmp_path, *tmp_path.rglob("*")):
        path.chmod(0o755)


def test_every_kernel_is_in_the_digest(monkeypatch):
    read = []
    with monkeypatch.context() as patched:
        patched.setattr(Path, "read_bytes", lambda path: read.append(path) or b"")
        room_digest.__wrapped__()
    kernels = {path for path in ROOM.rglob("*.py") if "nav_model.base.compiled import" in path.read_text()}
    assert len(kernels) > 10
    assert kernels <= set(read)


FALL = """
import numpy as np
from nav_model.simulation.strapdown import initial_state, navigate
start = initial_state(np.array([0.7, 0.0, 0.0]), np.zeros(3), np.eye(3))
print(navigate(start, np.zeros((102, 6)), 100.0)[-1, 5])
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "old", "new", "expected"),
    [
        ("earth/wgs84.py", "return surface * (", "return 2.0 * surface * (", 19.60),
        # Somigliana's formula at 0.7 rad with a flattening of one half.
        ("base/constants.py", "FLATTENING: Final = 1.0 / 298.257223563", "FLATTENING: Final = 0.5", 11.79),
    ],
)
def test_a_changed_callee_is_compiled_again(tmp_path, file, old, new, expected):
    """Numba alone would go on using the cached caller: the digest of the room is what forbids it."""

    def fall() -> float:
        done = subprocess.run([sys.executable, "-c", FALL], cwd=tmp_path, capture_output=True, text=True, check=True)
        return float(done.stdout)

    shutil.copytree(ROOM, tmp_path / "nav_model", ignore=shutil.ignore_patterns("__pycache__"))
    assert abs(fall() - 9.80) < 0.02
    source = tmp_path / "nav_model" / file
    text = source.read_text()
    changed = text.replace(old, new)
    assert changed != text
    source.write_text(changed)
    assert abs(fall() - expected) < 0.04


def test_as_shipped_a_changed_callee_goes_unnoticed(tmp_path):
    """Numba without the digest: the caller's cached code still holds the old callee."""
    (tmp_path / "callee.py").write_text("from numba import njit\n@njit(cache=True)\ndef inner():\n    return 1\n")
    (tmp_path / "caller.py").write_text(
        "from numba import njit\nfrom callee import inner\n@njit(cache=True)\ndef outer():\n    return inner()\n"
    )

    def outer() -> str:
        code = "from caller import outer; print(outer())"
        environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
        done = subprocess.run(
            [sys.executable, "-c", code], cwd=tmp_path, env=environment, capture_output=True, text=True, check=True
        )
        return done.stdout.strip()

    assert outer() == "1"
    (tmp_path / "callee.py").write_text("from numba import njit\n@njit(cache=True)\ndef inner():\n    return 22\n")
    assert outer() == "1"


def test_as_shipped_an_empty_file_of_the_cache_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "adding.py").write_text("from numba import njit\n@njit(cache=True)\ndef add(a):\n    return a + 1\n")
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    command = [sys.executable, "-c", "from adding import add; add(1)"]
    subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, check=True)
    (file,) = (tmp_path / "__pycache__").glob("*.nbi")
    file.write_bytes(b"")
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert "EOFError" in done.stderr


MEET = """
import sys
import numpy as np
from nav_model.simulation.kalman import normalised_square
print("ready", flush=True)
sys.stdin.readline()
normalised_square(np.eye(9), np.ones(9), np.empty((9, 9)))
print(sum(normalised_square.stats.cache_misses.values()))
"""


def test_of_processes_that_start_together_one_compiles(tmp_path):
    shutil.copytree(ROOM, tmp_path / "nav_model", ignore=shutil.ignore_patterns("__pycache__"))
    environment = {key: value for key, value in os.environ.items() if key != "NUMBA_CACHE_DIR"}
    command, pipe = [sys.executable, "-c", MEET], subprocess.PIPE
    both = [
        subprocess.Popen(command, cwd=tmp_path, env=environment, stdin=pipe, stdout=pipe, text=True) for _ in range(2)
    ]
    for process in both:
        assert process.stdout.readline() == "ready\n"
    for process in both:
        process.stdin.write("\n")
        process.stdin.flush()
    compiled = [int(process.communicate()[0]) for process in both]
    assert sorted(compiled) == [0, 1]
