"""Who only looks at the page makes no session; tests/app/serving shows it of the product."""

from __future__ import annotations

from typing import Any


def test_as_shipped_who_only_looks_makes_a_session(shipped: dict[str, Any]) -> None:
    assert shipped["made"] == 1
