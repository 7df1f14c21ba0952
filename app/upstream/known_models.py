"""A message looks up only the models that it names.

As shipped each message, to the page or from it, first lists every model that the page has, a thousand and more: an
eighth of a slider's step. And a model that the server has sent is described in full by the first message in which
the page names it, as one that the page has made: the server keeps its own, and warns of each.

Written for: Bokeh 3.9.2
Upstream: bokeh/bokeh#12915 (merged: no fault any more, but a warning), on the second; none found for the first,
searched 2026-11-23
Needless when: tests/app/upstream/test_known_models.py::test_as_shipped_each_message_lists_every_model fails
"""

from __future__ import annotations

from collections import ChainMap
from importlib import import_module
from typing import Any

import panel.io.model as panel_model
from bokeh.core.serialization import Deserializer, Serializer, UnknownReferenceError
from bokeh.document import Document
from bokeh.document.events import DocumentPatchedEvent
from bokeh.document.models import DocumentModelManager
from bokeh.model import Model


class _Lookup(Serializer):
    """Knows what the page has by looking there."""

    def __init__(self, *, references: DocumentModelManager, **options: Any) -> None:
        super().__init__(**options)
        self._models = references

    def has_ref(self, obj: Any) -> bool:
        return self.get_ref(obj) is not None

    def get_ref(self, obj: Any) -> Any:
        if (ref := super().get_ref(obj)) is not None:
            return ref
        models = self._models
        if isinstance(obj, Model) and models.get_by_id(obj.id) is obj and obj not in models._new_models:
            return obj.ref
        return None


class _LookupBack(Deserializer):
    """The same for what the page says."""

    def __init__(self, references: DocumentModelManager, *, setter: Any = None) -> None:
        super().__init__(setter=setter)
        self._references = ChainMap({}, references._models)

    def _decode_object_ref(self, obj: Any) -> Model:
        return self._references.get(obj["id"]) or super()._decode_object_ref(obj)


def _apply(document: Document, patch: Any, *, setter: Any = None) -> None:
    """As Bokeh's ``apply_json_patch``, but for the models."""
    models = document.models
    found = _LookupBack(models, setter=setter)
    try:
        events = found.deserialize(patch)["events"]
    except UnknownReferenceError as error:
        if models.seen(error.id):  # a model that has gone meanwhile
            return
        raise
    for event in events:
        DocumentPatchedEvent.handle_event(document, event, setter)
    models.flush_synced(lambda model: not found.has_ref(model))


def repair() -> None:
    """Install the override; the server calls it once, before it serves."""
    DocumentModelManager.synced_references = property(lambda models: models)
    # By name: the package has a class of the module's name.
    for module in (import_module("bokeh.protocol.messages.patch_doc"), panel_model):
        setattr(module, "Serializer", _Lookup)  # noqa: B010
    Document.apply_json_patch = _apply
