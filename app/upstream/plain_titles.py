"""An accordion with text titles makes no further models for them.

As shipped each title also gets an empty pane, for a title that is a component: it is found out what kind of pane
nothing is, and a model that the browser never shows is made, sent and kept.

Written for: panel-material-ui 0.16.6
Upstream: none found, searched 2026-11-23
Needless when: tests/app/upstream/test_plain_titles.py::test_as_shipped_each_title_brings_an_empty_pane fails
"""

from __future__ import annotations

from typing import Any

import panel_material_ui as pmui


class WordedAccordion(pmui.Accordion):
    """An accordion of parts, each given with its title: pairs of text and component."""

    def _to_objects_and_names(self, items: Any) -> Any:
        parts, *_, titles = found = super()._to_objects_and_names(items)
        return (parts, [], titles) if len(found) > 2 else found  # two while it is being made
