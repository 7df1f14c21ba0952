"""Only the page and its connection are served; tests/app/serving shows it of the product."""

from __future__ import annotations

from typing import Any


def test_as_shipped_the_page_is_offered_to_other_sites(shipped: dict[str, Any]) -> None:
    assert shipped["offered"] == ["autoload.js", "metadata"]
