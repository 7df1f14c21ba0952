"""Places of sliders and the values there, against decimal logarithms."""

import math
from decimal import Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.ui.log_scale import STEP, LogScale

scales = st.builds(
    lambda low, decades, zero: LogScale(low, low * 10**decades, zero),
    st.floats(1e-6, 1e3), st.floats(0.5, 5), st.booleans(),
)  # fmt: skip


@given(scales, st.floats(0, 1))
def test_a_place_is_the_decimal_logarithm_and_its_value_lies_there(scale: LogScale, share: float) -> None:
    value = scale.low * (scale.high / scale.low) ** share
    place = scale.place(value)
    assert place == pytest.approx(float(Decimal(value).log10()), abs=1e-9)
    assert scale.amount(place, "", "") == pytest.approx(value, rel=5.1e-3)  # three digits


@given(scales, st.floats(-1e3, 1e3))
def test_no_place_is_beyond_the_ends(scale: LogScale, place: float) -> None:
    start, end = scale.ends
    assert start <= scale.place(10 ** min(max(place, -300), 300)) <= end
    amount = scale.amount(place, "", "")
    assert amount == 0 or 0.99 * scale.low <= amount <= 1.01 * scale.high


@given(scales)
def test_the_far_left_is_zero_where_zero_is_allowed_and_there_alone(scale: LogScale) -> None:
    start, _ = scale.ends
    assert (scale.amount(start, "", "") == 0) == scale.zero
    assert scale.place(0.0) == start
    assert scale.amount(math.log10(scale.low), "", "") > 0
    if scale.zero:
        assert scale.amount(start + STEP, "", "") == 0  # one key press does not jump from zero to the lowest value


@given(scales)
def test_a_value_can_be_quoted_in_its_unit(scale: LogScale) -> None:
    amount = scale.amount(math.log10(scale.low * scale.high) / 2, "cm", "length")
    centimetres = Decimal(repr(amount)) * 100
    digits = f"{float(centimetres):.12g}".replace(".", "").partition("e")[0].strip("0")
    assert len(digits) <= 3
