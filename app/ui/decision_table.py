"""A table with a decision in each row: accept or reject, with a reason where one is needed."""

from collections.abc import Callable
from typing import Any, ClassVar

import param

from app.ui.theme import SHEET
from app.upstream.plain_script import PlainScript


class DecisionTable(PlainScript):
    """Requirements with the decision in force; ``on_decision`` is called with what a person decides, a dict.

    Under "do" it has "decide" (with place, name, accepted, reason, and seen: the number of the decision that was in
    view, 0 for none) or "accept" (with points: pairs of place and name that were open and met).
    """

    caption = param.String()
    open = param.Boolean(default=True, doc="Whether decisions are taken still.")
    rows = param.List(
        default=[],
        doc="Dicts of place, name, label, value, limit, met, verdict, tone, seen, decision and reason, as shown.",
    )

    _stylesheets: ClassVar[list[str]] = [SHEET]

    def __init__(self, on_decision: Callable[[dict[str, Any]], None], **params: Any) -> None:
        super().__init__(**params)
        self._on_decision = on_decision

    def _handle_msg(self, msg: Any) -> None:
        if isinstance(msg, dict) and msg.get("do") in {"decide", "accept"}:
            self._on_decision(msg)
