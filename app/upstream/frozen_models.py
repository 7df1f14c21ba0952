"""A document can still change after an exception during a batch of changes.

Bokeh walks through the whole document for each change of its parts, unless it is told that more will follow. Its own
way to say so (``models.freeze()``, and ``panel.io.hold(freeze=True)`` by it) never ends when an exception leaves it:
the document notices no new part from then on.

Written for: Bokeh 3.9.2, Panel 1.9.4
Upstream: none found, searched 2026-11-22 (holoviz/panel#8417 brought the way by Panel)
Needless when: tests/app/upstream/test_frozen_models.py::test_as_shipped_a_fault_leaves_the_document_frozen fails
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from bokeh.document import Document


@contextmanager
def frozen_models(document: Document) -> Iterator[None]:
    """Put off the walk until all changes are made, however that ends."""
    document.models._push_freeze()
    try:
        yield
    finally:
        document.models._pop_freeze()
