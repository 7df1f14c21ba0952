"""Budgets of the examples, and what the reports of several subjects share."""

import asyncio
import inspect
import pickle
from collections import OrderedDict
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from app.charts.print.svg import to_svg
from app.document import pdf
from app.examples import example
from app.work import result_cache
from nav_model.budget import Budget, analyse


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    """A test that is a coroutine runs in an event loop of its own."""
    if not inspect.iscoroutinefunction(pyfuncitem.obj):
        return None
    asked = inspect.signature(pyfuncitem.obj).parameters
    asyncio.run(pyfuncitem.obj(**{name: pyfuncitem.funcargs[name] for name in asked}))
    return True


@pytest.fixture(scope="session", autouse=True)
def _data_of_its_own(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """The user's data folder, where the default library and the key of reviews are, stays as it is."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_DATA_HOME", str(tmp_path_factory.mktemp("data")))
        yield


@pytest.fixture
def nothing_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """No result that a server still has."""
    monkeypatch.setattr(result_cache, "_results", OrderedDict())


@pytest.fixture(scope="session")
def budget_of() -> Callable[[str], Budget]:
    """The budget of the example of this name."""
    return lambda name: analyse(example(name))


@pytest.fixture(scope="session")
def mems(budget_of: Callable[[str], Budget]) -> Budget:
    return budget_of("mems_x_band")


@pytest.fixture(scope="session")
def tactical(budget_of: Callable[[str], Budget]) -> Budget:
    return budget_of("tactical_x_band")


@pytest.fixture(scope="session")
def _drawn() -> dict[bytes, str]:
    """Charts by what they show."""
    return {}


@pytest.fixture(scope="module")
def charts_drawn_once(_drawn: dict[bytes, str]) -> Iterator[None]:
    """The same chart is drawn once, however many reports show it: that is most of a report's time, and that it comes
    out the same each time is held in charts/."""

    def once(chart: Any) -> str:
        key = pickle.dumps(chart)
        if key not in _drawn:
            _drawn[key] = to_svg(chart)
        return _drawn[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pdf, "to_svg", once)
        yield
