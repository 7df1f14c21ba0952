"""Scripts of ours go to the browser as they are."""

import pytest

from app.ui.anchored_text import AnchoredText
from app.ui.tour import Tour

pytestmark = pytest.mark.watches("app/upstream", "docs/upstream")


def test_ours_are_bundles_with_different_names() -> None:
    tour, text = Tour().get_root(), AnchoredText().get_root()
    assert tour.bundle
    assert text.bundle
    assert tour.bundle != text.bundle
    assert tour.esm.strip() == Tour._esm.strip()
