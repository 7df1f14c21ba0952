"""Separation of users: what one does reaches nobody else's page.

The busy line under the page's head shows only this user's long work: panel-material-ui binds it to one flag of the
whole server, so every event of every user redraws every page. Closing a page does not start a full garbage
collection, during which nobody is answered (`app.serving.collector` says when to collect instead), and no task of
Panel's keeps a page.

Reports to send upstream, versions and ends: docs/upstream/neighbours.md
"""

import panel as pn
import panel.io.document
import panel_material_ui as pmui
import param
from panel.util import edit_readonly


def follow_session_work(page: pmui.Page, running: param.Boolean[bool]) -> None:
    """Bind the busy line of a page to a flag of its session: a parameter, as in ``session.param.running``."""
    with edit_readonly(page):
        page.busy = running


def leave_collecting() -> None:
    """Install the override permanently; the server calls it once, before it serves."""
    panel.io.document._garbage_collect = lambda: None
    pn.state._schedule_busy_cleanup()  # outside any page, and before there is a loop for its task
