"""Scripts of ours go to the browser as they are, and their messages do not make the whole server busy."""

from typing import Any

import panel as pn
from bokeh.document import Document
from panel.models.esm import DataEvent

from app.ui.anchored_text import AnchoredText
from app.ui.tour import Tour


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


def test_a_message_leaves_the_servers_flag_alone() -> None:
    component = _Told()
    component._process_bokeh_event(Document(), DataEvent(None, "said"))
    assert component.busy == []
