"""Which scripts the browser is told to leave as they are."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn
import pytest
from bokeh.document import Document
from panel.custom import JSComponent
from panel.models.esm import DataEvent

from app.ui.anchored_text import AnchoredText
from app.ui.tour import Tour


class Shipped(JSComponent):
    _esm = "export function render() {}"


def test_as_shipped_a_script_is_compiled_in_the_browser() -> None:
    assert Shipped().get_root().bundle is None


def test_ours_are_bundles_with_different_names() -> None:
    tour, text = Tour().get_root(), AnchoredText().get_root()
    assert tour.bundle
    assert text.bundle
    assert tour.bundle != text.bundle
    assert tour.esm.strip() == Tour._esm.strip()


class _Told(Tour):
    busy: list[Any]

    def _handle_msg(self, _: Any) -> None:
        self.busy = list(pn.state._busy_counter)


@pytest.mark.parametrize(("handle", "flags"), [(JSComponent._process_bokeh_event, 1), (Tour._process_bokeh_event, 0)])
def test_as_shipped_a_message_makes_the_whole_server_busy(handle: Callable[..., None], flags: int) -> None:
    component = _Told()
    handle(component, Document(), DataEvent(None, "said"))
    assert len(component.busy) == flags
