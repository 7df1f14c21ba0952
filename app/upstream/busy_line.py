"""The busy line under the page's head shows only this user's long work.

panel-material-ui binds it to one flag of the whole server: every event of every user redraws every page, and the
binding outlives the page. With 20 users a slider's step took four seconds instead of a tenth.

Written for: panel-material-ui 0.16.6
Upstream: none found, searched 2026-11-22 (panel-extensions/panel-material-ui#235 brought it)
Needless when: tests/app/upstream/test_busy_line.py::test_as_shipped_every_page_follows_one_flag fails
"""

from __future__ import annotations

import panel_material_ui as pmui
import param
from panel.util import edit_readonly


def follow_own_work(page: pmui.Page, running: param.Boolean[bool]) -> None:
    """Bind the line of a page to a flag of its session: a parameter, as in ``session.param.running``."""
    with edit_readonly(page):
        page.busy = running
