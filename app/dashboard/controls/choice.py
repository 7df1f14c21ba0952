"""One choice of a design: a select, or a switch."""

from __future__ import annotations

from html import escape

import panel as pn
import panel_material_ui as pmui
import param

from app.session import Session
from app.ui.html_pane import html_pane
from nav_model.design import Design
from nav_model.design.declaration import Choice
from nav_model.design.parts import declaration_of


class ChoiceControl(pn.viewable.Viewer):
    """A select, or a switch, for one choice."""

    explained = param.Boolean(default=False, doc="Whether the help line is shown.")

    def __init__(self, session: Session, key: str) -> None:
        super().__init__()
        declaration = declaration_of(key)
        assert isinstance(declaration, Choice)
        self.key = key
        self._session = session
        self._declaration = declaration
        label = str(declaration.label)
        if isinstance(declaration.default, bool):
            self.widget = pmui.Switch(label=label, margin=(10, 10, 0, 10))
        else:
            self.widget = pmui.Select(
                label=label,
                options={said: option for option, said in declaration.options.items()},
                margin=(10, 10, 0, 10),
                sizing_mode="stretch_width",
            )
        self._view = pn.Column(self.widget)
        self.widget.param.watch(self._chosen, "value")
        self.show(session.design)

    def __panel__(self) -> pn.Column:
        return self._view

    def differs(self, old: Design, new: Design) -> bool:
        """Whether the choice has changed."""
        return bool(old[self.key] != new[self.key])

    def show(self, design: Design) -> None:
        """Follow the current design."""
        if self.widget.value != design[self.key]:
            self.widget.value = design[self.key]

    @param.depends("explained", watch=True)
    def _explain(self) -> None:
        if isinstance(self.widget, pmui.Select):
            self.widget.helper_text = str(self._declaration.doc) if self.explained else ""
        else:  # a switch has no helper text
            note = html_pane(f'<p class="note">{escape(str(self._declaration.doc))}</p>', margin=(0, 14))
            self._view.objects = [self.widget, note] if self.explained else [self.widget]

    def _chosen(self, event: param.parameterized.Event) -> None:
        if event.new != self._session.design[self.key]:
            self._session.change({self.key: event.new})
