"""Which scripts the browser is told to leave as they are."""

from __future__ import annotations

from panel.custom import JSComponent

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
