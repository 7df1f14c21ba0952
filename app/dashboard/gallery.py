"""The example designs: description, verdict, and a button to open each."""

from collections.abc import Callable
from html import escape

import panel as pn
import panel_material_ui as pmui

from app.document.blocks import Text
from app.document.pane import html_of
from app.document.verdict import verdict_of
from app.document.wording import preset_name
from app.examples import EXAMPLES, example
from app.ui.grid import cell, grid
from app.ui.html_pane import html_pane
from app.ui.theme import FRAME
from nav_model.budget import Budget, analyse
from nav_model.design import Design


def gallery(adopt: Callable[[Design], None]) -> pn.viewable.Viewable:
    """The examples side by side; ``adopt`` puts one in force."""
    budgets = [analyse(example(name)) for name in EXAMPLES]
    cards = grid(*(cell(4, _card(budget, adopt)) for budget in budgets), beside=900)
    head = html_pane(
        "<h3>Start from an example</h3><p class='quiet'>It replaces the current design. You can undo. "
        "Then change one input and watch the verdict.</p>",
        margin=(8, 14, 0, 14),
    )
    return pn.Column(head, cards)


def _card(budget: Budget, adopt: Callable[[Design], None]) -> pn.Column:
    design = budget.design
    button = pmui.Button(label=f"Open {design.name}", variant="outlined", margin=(4, 14, 12, 14))
    button.on_click(lambda _: adopt(design))
    return pn.Column(html_pane(_about(budget), margin=(10, 14, 0, 14)), button, styles=FRAME)


def _about(budget: Budget) -> str:
    design, verdict = budget.design, verdict_of(budget)
    return f"<h3>{escape(design.name)}</h3>" + html_of(
        Text(" ".join((f"{verdict.word}.", *verdict.sentences))),
        Text(f"IMU: {preset_name(design, 'imu')}. Radar: {preset_name(design, 'radar')}."),
        Text(design.description),
    )
