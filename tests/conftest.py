"""One BLAS thread: the matrices here are small, and the test workers already take every core.

And the record of what results were compared with: `make validation` writes it, the Theory page shows it. And which
tests are run, in which order: the longest file first, none that says which files it watches and passed on them, and
with --quick only what `make durations` measured to be quick.
"""

import asyncio
import collections
import datetime
import functools
import gc
import hashlib
import importlib.metadata
import json
import os
import re
import subprocess
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy is first imported

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers

gc.disable()  # until all is collected: it is a third of that time, in every worker
# No example is wrong for being slow. The same examples every time, so that a verdict is the code's; `make test-slow`
# searches on among new ones.
_PATIENT = settings(deadline=None, print_blob=True, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("searching", _PATIENT)
settings.register_profile("steady", _PATIENT, derandomize=True)
settings.load_profile("steady")
# Among them would be numbers from whatever modules other tests have imported by then.
providers._get_local_constants = providers.Constants

ROOT = Path(__file__).parents[1]
RECORD = ROOT / "app" / "subjects" / "theory" / "validation.json"
DURATIONS = ROOT / "tests" / "durations.json"
_QUICK = 0.25  # seconds that a test of `make check` takes at most, all its cases and the fixtures that it shares
_MEASURABLE = 0.1  # seconds; what takes less is not recorded
MODEL_TESTS = ROOT / "tests" / "nav_model"
MODEL = ("nav_model", "examples", "app/subjects/theory")  # the last has the record of comparisons
_rows = {}
_differences = {}
_seconds = collections.defaultdict(collections.Counter)  # by file, then by test function or shared fixture
_green = {}  # tests that watch files -> digest of these, or None after a failure


def pytest_collection_finish(session):
    """What is imported by now stays: the collector need not go through it again and again, nor as often as usual."""
    gc.freeze()
    gc.enable()
    gc.set_threshold(100_000, 50, 50)


def pytest_addoption(parser):
    parser.addoption(
        "--write-validation", action="store_true", help="write app/subjects/theory/validation.json from this run"
    )
    parser.addoption("--write-durations", action="store_true", help="write tests/durations.json from this run")
    parser.addoption("--quick", action="store_true", help="leave out tests that tests/durations.json has as long")
    parser.addoption(
        "--skip-unchanged", action="store_true", help="leave out tests that passed on the files that they watch"
    )


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config, items):
    passed = config.cache.get("watched/passed", {}) if config.getoption("--skip-unchanged") else {}
    unchanged = []
    for item in items:
        if watched := _watched(item):
            digest = _digest(item.path, watched)
            item.user_properties.append(("watched", digest))
            if passed.get(item.nodeid) == digest:
                unchanged.append(item)
    left_out = set(unchanged)
    if config.getoption("--quick"):
        left_out |= {item for item in items if _is_long(item)}
    if left_out:
        config.hook.pytest_deselected(items=[item for item in items if item in left_out])
        items[:] = [item for item in items if item not in left_out]
    if hasattr(config, "workerinput"):  # files are handed to the workers in this order
        items.sort(key=lambda item: -sum(_recorded().get(_file_of(item.nodeid), {}).values()))
    if config.getoption("--write-validation"):
        recording = [item for item in items if {"compared", "differs"} & set(getattr(item, "fixturenames", ()))]
        config.hook.pytest_deselected(items=[item for item in items if item not in recording])
        items[:] = recording


def _watched(item):
    """The files that a test says it watches; of one in tests/nav_model that does not import the app, the model."""
    if marker := item.get_closest_marker("watches"):
        return marker.args
    model_only = item.path.is_relative_to(MODEL_TESTS) and not _imports_app(item.path)
    return MODEL if model_only else ()


@functools.cache
def _imports_app(test):
    return re.search(r"^\s*(from|import) app\b", test.read_text(), re.MULTILINE) is not None


@functools.cache
def _digest(test, watched):
    """Of all that a test watches: the files named, its own, what tests share, and every version installed."""
    paths = [ROOT / name for name in (*watched, "requirements", "tests/conftest.py", "tests/support")]
    assert all(path.exists() for path in paths[: len(watched)]), f"{test}: nothing to watch in {watched}"
    conftests = [folder / "conftest.py" for folder in test.parents if folder.is_relative_to(ROOT / "tests")]
    return hashlib.sha256("".join(map(_contents, [*paths, test, *conftests])).encode()).hexdigest()


@functools.cache
def _contents(path):
    files = sorted(file for file in (path.rglob("*") if path.is_dir() else [path]) if file.is_file())
    return "".join(
        f"{file.relative_to(ROOT)} {hashlib.sha256(file.read_bytes()).hexdigest()}\n"
        for file in files
        if "__pycache__" not in file.parts  # what Python and Numba compile comes and goes
    )


def _file_of(nodeid):
    return nodeid.partition("::")[0]


def _function_of(nodeid):
    """A test's name in its file, without the case."""
    return nodeid.partition("::")[2].partition("[")[0]


@functools.cache
def _recorded():
    """Seconds of a quiet run, by file, then by test function or fixture that its tests share."""
    return json.loads(DURATIONS.read_text())


def _is_long(item):
    """True for a test that is marked as long, and for one measured to be, with the shared fixtures that it needs.

    Whoever runs first pays for a fixture. So each test that needs it counts it: otherwise the next one would pay.
    """
    seconds = _recorded().get(_file_of(item.nodeid), {})
    measured = sum(seconds.get(name, 0.0) for name in {_function_of(item.nodeid), *item.fixturenames})
    return item.get_closest_marker("long") is not None or measured > _QUICK


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef, request):
    before = time.perf_counter()
    try:
        return (yield)
    finally:
        if fixturedef.scope != "function":
            spent = fixturedef.argname, time.perf_counter() - before
            request._pyfuncitem.user_properties.append(("fixture", spent))


def pytest_runtest_logreport(report):
    seconds, function = _seconds[_file_of(report.nodeid)], _function_of(report.nodeid)
    seconds[function] += report.duration
    shared = [value for key, value in report.user_properties if key == "fixture"] if report.when == "setup" else []
    for fixture, spent in shared:
        seconds[fixture] += spent
        seconds[function] -= spent
    digest = dict(report.user_properties).get("watched")
    if digest and (report.failed or report.when == "call"):
        _green[report.nodeid] = digest if report.passed else None


def _loop_put_aside(item, *, putting=True):
    """Playwright's loop counts as running between its calls; a test that does not use it has loops of its own."""
    loop = asyncio._get_running_loop()
    if loop is None or not putting or "playwright" in item.fixturenames:
        return (yield)
    asyncio._set_running_loop(None)
    try:
        return (yield)
    finally:
        asyncio._set_running_loop(loop)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup(item):
    return (yield from _loop_put_aside(item))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item):
    return (yield from _loop_put_aside(item))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(item, nextitem):
    return (yield from _loop_put_aside(item, putting=nextitem is not None))  # after the last one, browsers close


@pytest.fixture
def compared(request):
    """Hold a deviation against its limit, as the committed record says it is held.

    ``compared(result, equation, kind, oracle, figure, limit, measure)``: the result in words, the equation's mark or
    nothing, the kind of comparison (see `app.subjects.theory.record`), what the result is compared with in words,
    the largest deviation found (an array: its largest), what it may be, and what is measured, unless that is the
    usual ratio. Calls of one result from several cases of a test make one row, of the worst.
    """
    from app.subjects.theory.record import INDEPENDENT, OURS, record

    writing = request.config.getoption("--write-validation")

    def hold(result, equation, kind, oracle, figure, limit, measure="largest ratio − 1"):
        assert kind in {*INDEPENDENT, OURS}, f"{result}: {kind!r} is no kind of comparison"
        figure = float(np.max(np.abs(figure)))
        assert figure <= limit, f"{result}: {figure:g} beyond {limit:g} ({measure}) against {oracle}"
        row = {
            "result": result, "equation": equation, "kind": kind, "oracle": oracle, "limit": limit,
            "measure": measure, "test": _name_of(request),
        }  # fmt: skip
        if writing:
            worst = max(figure, _rows.get((result, row["test"]), {"figure": 0.0})["figure"])
            _rows[result, row["test"]] = {**row, "figure": float(f"{worst:.3g}")}
            return
        committed = [{**vars(entry), "figure": 0.0} for entry in record().rows]
        assert {**row, "figure": 0.0} in committed, f"{RECORD.name} does not have this row: run `make validation`"

    return hold


@pytest.fixture
def differs(request):
    """Put beside each other a printed figure and ours where they disagree, with which of them holds and why.

    ``differs(result, equation, printed, ours, holds, why)``, all in words; the test itself shows it.
    """
    from app.subjects.theory.record import record

    writing = request.config.getoption("--write-validation")

    def put(result, equation, printed, ours, holds, why):
        row = {
            "result": result, "equation": equation, "printed": printed, "ours": ours, "holds": holds, "why": why,
            "test": _name_of(request),
        }  # fmt: skip
        if writing:
            _differences[result] = row
            return
        committed = [{**vars(entry), "ours": ""} for entry in record().differences]
        assert {**row, "ours": ""} in committed, f"{RECORD.name} does not have this row: run `make validation`"

    return put


def _name_of(request):
    """The test's file and function, without the case."""
    return request.node.nodeid.partition("[")[0].replace("::", ":")


@pytest.fixture
def ratio_off():
    """Ratio of two arrays, less one: the measure of most comparisons."""
    return lambda ours, theirs: np.asarray(ours, float) / np.asarray(theirs, float) - 1


def pytest_sessionfinish(session, exitstatus):
    if not hasattr(session.config, "workerinput"):
        session.config.cache.set("watched/passed", {**session.config.cache.get("watched/passed", {}), **_green})
        if session.config.getoption("--write-durations"):
            measured = {
                file: {name: round(spent, 1) for name, spent in sorted(seconds.items()) if spent >= _MEASURABLE}
                for file, seconds in _seconds.items()
            }
            record = {file: seconds for file, seconds in sorted({**_recorded(), **measured}.items()) if seconds}
            record = {file: seconds for file, seconds in record.items() if (ROOT / file).exists()}
            DURATIONS.write_text(json.dumps(record, indent=1) + "\n")
    if not session.config.getoption("--write-validation") or exitstatus != 0:
        return
    if session.config.pluginmanager.get_plugin("terminalreporter").stats.get("skipped"):
        raise pytest.UsageError("not written: a comparison was skipped (the real data lie in ../shared/data)")
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=True)
    record = {
        "version": importlib.metadata.version("navbudget"),
        "commit": commit.stdout.strip(),
        "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
        "rows": sorted(_rows.values(), key=lambda row: (row["test"], row["result"])),
        "differences": sorted(_differences.values(), key=lambda row: (row["test"], row["result"])),
    }
    RECORD.write_text(json.dumps(record, ensure_ascii=False, indent=1) + "\n")
