"""A fault in the midst of many changes leaves the document able to change."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, suppress

from bokeh.document import Document
from bokeh.models import Div

from app.upstream.frozen_models import frozen_models


def _notices_parts_after_a_fault(freeze: Callable[[Document], AbstractContextManager[None]]) -> bool:
    document, late = Document(), Div()
    with suppress(ZeroDivisionError), freeze(document):
        raise ZeroDivisionError
    document.add_root(late)
    return document.models.get_by_id(late.id) is late


def test_as_shipped_a_fault_leaves_the_document_frozen() -> None:
    assert not _notices_parts_after_a_fault(lambda document: document.models.freeze())


def test_it_is_freed() -> None:
    assert _notices_parts_after_a_fault(frozen_models)
