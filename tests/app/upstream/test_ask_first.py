"""A server as shipped answers under any name; tests/app/serving/test_door.py shows that the product does not."""

from __future__ import annotations

from typing import Any

import pytest


@pytest.mark.long
def test_as_shipped_a_foreign_host_is_served(shipped: dict[str, Any]) -> None:
    assert shipped["foreign"] == 200
