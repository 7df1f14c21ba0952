"""The model imports no user interface, and starts without the heavy half of SciPy."""

import ast
import subprocess
import sys
from pathlib import Path

import nav_model

ROOM = Path(nav_model.__file__).parent
SCREENS = {"app", "panel", "bokeh", "panel_material_ui", "matplotlib", "typst", "holoviews"}


def _imported(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield (node.module or "").partition(".")[0]


def test_no_module_of_the_model_imports_a_screen():
    modules = list(ROOM.rglob("*.py"))
    assert len(modules) > 15
    for path in modules:
        assert not SCREENS & set(_imported(path)), path


def test_analyse_loads_neither_screens_nor_scipy():
    code = (
        "import sys\n"
        "from nav_model.budget import analyse\nfrom nav_model.budget.json import to_json\n"
        "from nav_model.design import Design\nto_json(analyse(Design({'gnss.interval': 0.1})))\n"
        f"print(sorted({SCREENS | {'scipy', 'numba', 'IPython'}!r} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOM.parent, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
