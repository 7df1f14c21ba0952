"""One BLAS thread: the matrices here are small, and the test workers already take every core.

And the record of what results were compared with: `make validation` writes it, the Theory page shows it.
"""

import datetime
import gc
import importlib.metadata
import json
import os
import subprocess
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy is first imported

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers

# No example is wrong for being slow. The same examples every time, so that a verdict is the code's; `make test-slow`
# searches on among new ones.
_PATIENT = settings(deadline=None, print_blob=True, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("searching", _PATIENT)
settings.register_profile("steady", _PATIENT, derandomize=True)
settings.load_profile("steady")
# Among them would be numbers from whatever modules other tests have imported by then.
providers._get_local_constants = providers.Constants

RECORD = Path(__file__).parents[1] / "app" / "subjects" / "theory" / "validation.json"
_rows = {}
_differences = {}


def pytest_collection_finish(session):
    """What is imported by now stays: the collector need not go through it again and again, nor as often as usual."""
    gc.freeze()
    gc.set_threshold(100_000, 50, 50)


def pytest_addoption(parser):
    parser.addoption(
        "--write-validation", action="store_true", help="write app/subjects/theory/validation.json from this run"
    )


def pytest_collection_modifyitems(config, items):
    if config.getoption("--write-validation"):
        recording = [item for item in items if {"compared", "differs"} & set(getattr(item, "fixturenames", ()))]
        config.hook.pytest_deselected(items=[item for item in items if item not in recording])
        items[:] = recording


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
