"""The line of a page follows its own session's work."""

import panel as pn
import panel_material_ui as pmui
import param

from app.upstream.busy_line import follow_own_work


class _Session(param.Parameterized):
    running = param.Boolean(False)


def _followers() -> int:
    """How many follow the flag of the whole server."""
    return len(pn.state._param__private.watchers.get("busy", {}).get("value", []))


def test_it_follows_one_session_and_no_more() -> None:
    before, page, session = _followers(), pmui.Page(), _Session()
    follow_own_work(page, session.param.running)
    assert _followers() == before
    session.running = True
    assert page.busy
    session.running = False
    assert not page.busy
