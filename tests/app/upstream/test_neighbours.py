"""The line of a page follows its own session's work, and closing a page does not start a full garbage collection."""

import gc

import panel as pn
import panel.io.document
import panel_material_ui as pmui
import param
import pytest

from app.upstream.neighbours import follow_session_work, leave_collecting

pytestmark = pytest.mark.watches("app/upstream", "docs/upstream")


class _Session(param.Parameterized):
    running = param.Boolean(False)


def _followers() -> int:
    """Number of followers of the flag of the whole server."""
    return len(pn.state._param__private.watchers.get("busy", {}).get("value", []))


def test_it_follows_one_session_and_no_more() -> None:
    before, page, session = _followers(), pmui.Page(), _Session()
    follow_session_work(page, session.param.running)
    assert _followers() == before
    session.running = True
    assert page.busy
    session.running = False
    assert not page.busy


def test_collecting_is_left_to_others(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []
    monkeypatch.setattr(gc, "collect", lambda: asked.append(1))
    monkeypatch.setattr(panel.io.document, "_panel_last_cleanup", -1e9)
    monkeypatch.setattr(panel.io.document, "_garbage_collect", panel.io.document._garbage_collect)
    leave_collecting()
    panel.io.document._garbage_collect()
    assert not asked
