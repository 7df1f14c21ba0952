"""One BLAS thread: the matrices here are small, and the test workers already take every core.

And the record of what results were compared with: `make validation` writes it, the Theory page shows it.
"""

import datetime
import importlib.metadata
import json
import os
import subprocess
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy is first imported

import pytest

RECORD = Path(__file__).parents[1] / "app" / "validation.json"
_rows = []


def pytest_addoption(parser):
    parser.addoption("--write-validation", action="store_true", help="write app/validation.json from this run")


@pytest.fixture
def validated(request):
    """Hold a deviation against its limit, as the committed record says it is held.

    ``validated(result, equation, oracle, figure, limit, measure, outside=True)``: ``outside`` only where the oracle
    is no part of this product: published figures, or a solver written by others.
    """
    writing = request.config.getoption("--write-validation")

    def hold(result, equation, oracle, figure, limit, measure, *, outside=True):
        figure = abs(float(figure))
        assert figure <= limit, f"{result}: {figure:g} beyond {limit:g} ({measure}) against {oracle}"
        name = request.node.nodeid.replace("::", ":")
        row = {
            "result": result, "equation": equation, "oracle": oracle, "limit": limit, "measure": measure,
            "outside": outside, "test": name,
        }  # fmt: skip
        if writing:
            _rows.append({**row, "figure": float(f"{figure:.3g}")})
            return
        committed = [{k: v for k, v in r.items() if k != "figure"} for r in json.loads(RECORD.read_text())["rows"]]
        assert row in committed, "app/validation.json does not have this row: run `make validation`"

    return hold


def pytest_sessionfinish(session, exitstatus):
    if session.config.getoption("--write-validation") and exitstatus == 0:
        commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=True)
        record = {
            "version": importlib.metadata.version("navbudget"),
            "commit": commit.stdout.strip(),
            "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
            "rows": _rows,
        }
        RECORD.write_text(json.dumps(record, ensure_ascii=False, indent=1) + "\n")
