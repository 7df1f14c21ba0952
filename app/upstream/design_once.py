"""A change of a component does not compute the styles of the whole page.

As shipped Panel works out, for every change of every component, what the page's design would have it look like, and
uses that when the change is one of style sheets: a twentieth of a slider's step.

Written for: Panel 1.9.4
Upstream: holoviz/panel#5278 (merged: fewer, for text alone)
Needless when: tests/app/upstream/test_design_once.py::test_as_shipped_a_change_of_text_asks_the_design fails
"""

from __future__ import annotations

from typing import Any

from panel.reactive import Reactive

_shipped = Reactive._update_properties


def _update_properties(component: Reactive, *events: Any, doc: Any) -> dict[str, Any]:
    changes = {event.name: event.new for event in events}
    if "stylesheets" in changes:
        return _shipped(component, *events, doc=doc)
    return component._process_param_change(changes)


def ask_when_styles_change() -> None:
    """Install the override; the server calls it once, before it serves."""
    Reactive._update_properties = _update_properties
