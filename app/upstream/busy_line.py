"""The busy line under the page's head shows only this user's long work.

panel-material-ui binds it to one flag of the whole server: every event of every user redraws every page.

Reports to send upstream, versions and ends: docs/upstream/busy_line.md
"""

import panel_material_ui as pmui
import param
from panel.util import edit_readonly


def follow_own_work(page: pmui.Page, running: param.Boolean[bool]) -> None:
    """Bind the line of a page to a flag of its session: a parameter, as in ``session.param.running``."""
    with edit_readonly(page):
        page.busy = running
