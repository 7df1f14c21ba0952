"""Which finished studies go into the report: a box to tick for each, and a word on those of another design."""

from __future__ import annotations

from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import held
from app.report.studies import belonging
from app.session import Session
from app.subjects import STUDIES
from app.ui.html_pane import html_pane


class ReportChoice(pn.viewable.Viewer):
    """Boxes beside the report buttons once a study is finished; every study of the design in force is ticked."""

    session = held(Session)

    def __init__(self, session: Session) -> None:
        super().__init__(session=session)
        self._unticked: set[str] = set()
        self._boxes = pmui.CheckBoxGroup(label="", options={}, value=[], inline=True, margin=(0, 8))
        self._left = html_pane("", margin=(0, 8))
        self._view = pn.FlexBox(self._boxes, self._left, align_items="center", visible=False)
        self._boxes.param.watch(self._ticked, "value")

    def __panel__(self) -> pn.FlexBox:
        return self._view

    def chosen(self) -> dict[str, Any]:
        """The findings to tell, by kind; those of another design too, so that the report says it leaves them out."""
        return {kind: finding for kind, finding in self.session.findings.items() if kind not in self._unticked}

    def _ticked(self, event: Any) -> None:
        offered = set(self._boxes.options.values())
        self._unticked = (self._unticked - offered) | (offered - set(event.new))

    @param.depends("session.findings", "session.budget", watch=True)
    def _follow(self) -> None:
        findings = self.session.findings
        if not findings:
            return
        fits = belonging(findings, self.session.design)
        offered = {f"{STUDIES[kind].study} in the report": kind for kind, fit in fits.items() if fit}
        if offered != self._boxes.options:
            value = [kind for kind in offered.values() if kind not in self._unticked]
            self._boxes.param.update(options=offered, value=value, visible=bool(offered))
        left = [STUDIES[kind].study for kind, fit in fits.items() if not fit]
        said = f"Not in the report, of another design: {', '.join(left)}."
        shown = f'<span class="quiet">{escape(said)}</span>' if left else ""
        if self._left.object != shown:
            self._left.object = shown
        self._view.visible = True
