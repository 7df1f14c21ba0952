"""Results that a server still has."""

import pytest

from app.work import result_cache
from app.work.result_cache import keep

pytestmark = pytest.mark.usefixtures("nothing_kept")


def test_the_last_few_of_a_kind_are_kept_and_take_no_place_of_another_kind() -> None:
    keep("other", "sar", "design", "runs=50")
    for number in range(5):
        keep(number, "suborbital", str(number), most=3)
    assert [result_cache.cached("suborbital", str(number)) for number in range(5)] == [None, None, 2, 3, 4]
    assert result_cache.cached("sar", "design", "runs=50") == "other"
    assert result_cache.cached("sar", "design", "runs=100") is None


def test_what_is_asked_for_stays() -> None:
    for number in range(3):
        keep(number, "suborbital", str(number), most=3)
    assert result_cache.cached("suborbital", "0") == 0
    keep(3, "suborbital", "3", most=3)
    assert result_cache.cached("suborbital", "0") == 0
    assert result_cache.cached("suborbital", "1") is None
