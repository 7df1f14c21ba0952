"""Every custom component is loaded before the first page, so that open pages know all of them."""

import subprocess
import sys

import pytest

pytestmark = [pytest.mark.long, pytest.mark.watches("app")]

_FOUND_LATE = """
import pkgutil
from importlib import import_module
import app
from app.serving.server import COMPONENTS
from panel.custom import ReactiveESM
from panel.reactive import ReactiveHTML

def below(kind):
    return {kind}.union(*map(below, kind.__subclasses__()))

def known():
    return below(ReactiveESM) | below(ReactiveHTML)

for name in COMPONENTS:
    import_module(name)
before = known()
for module in pkgutil.walk_packages(app.__path__, "app."):
    if not module.name.endswith("__main__"):
        import_module(module.name)
print(*sorted(f"{found.__module__}.{found.__name__}" for found in known() - before))
"""


def test_no_page_brings_a_part_that_open_pages_have_not_heard_of() -> None:
    done = subprocess.run([sys.executable, "-c", _FOUND_LATE], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
