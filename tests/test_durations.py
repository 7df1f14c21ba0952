"""The quick tests of `make check`: those that were measured to be quick, with the fixtures that they share."""

from pathlib import Path

import pytest

CONFTEST = str(Path(__file__).with_name("conftest.py"))


@pytest.mark.parametrize(
    ("measured", "long"),
    [({}, False), ({"shared": 0.2}, False), ({"test_a_shared_fixture_counts": 0.1, "shared": 0.2}, True)],
)
def test_a_shared_fixture_counts(request, monkeypatch, measured, long):
    conftest = request.config.pluginmanager.get_plugin(CONFTEST)
    node = request.node
    monkeypatch.setattr(node, "fixturenames", [*node.fixturenames, "shared"])
    monkeypatch.setattr(conftest, "_recorded", lambda: {node.nodeid.partition("::")[0]: measured})
    assert conftest._is_long(node) is long


@pytest.mark.long
def test_a_mark_counts_before_anything_is_measured(request, monkeypatch):
    conftest = request.config.pluginmanager.get_plugin(CONFTEST)
    monkeypatch.setattr(conftest, "_recorded", dict)
    assert conftest._is_long(request.node)
