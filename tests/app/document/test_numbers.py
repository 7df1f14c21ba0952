"""Numbers as they are told, against decimal arithmetic of Python's own."""

import math
import re
from decimal import Context, Decimal

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from app.document.numbers import hundredths, margin_in_short, number, percent, show, show_in, signed_percent

_RAISED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
_SIZES = {
    "length": {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "km": 1e3},
    "speed": {"mm/s": 1e-3, "cm/s": 1e-2, "m/s": 1.0},
    "angle": {"arcsec": math.pi / 648_000, "°": math.pi / 180},
    "time": {"ms": 1e-3, "s": 1.0},
}
values = st.floats(1e-12, 1e12) | st.floats(-1e12, -1e-12)


def read(text: str) -> Decimal:
    """The number that a text begins with."""
    digits, _, power = text.replace("−", "-").partition("·10")
    return Decimal(digits).scaleb(int(power.translate(_RAISED) or 0))


@given(values, st.integers(2, 6))
def test_a_number_is_the_value_rounded_to_its_digits_and_shows_all_of_them(value: float, digits: int) -> None:
    text = number(value, digits)
    rounded = Context(prec=digits).create_decimal(Decimal(value))
    assert abs(read(text) - rounded) <= abs(rounded) * Decimal("1e-12")
    assert "-" not in text  # a minus is one as typeset
    significant = text.partition("·")[0].lstrip("−0.").replace(".", "")
    assert len(significant) >= digits or "·" in text


@pytest.mark.parametrize("dimension", _SIZES)
@given(value=st.floats(1e-6, 1e6))
def test_a_quantity_is_the_value_in_the_unit_it_names(dimension: str, value: float) -> None:
    figure, unit = re.fullmatch(r"(.*?)\s?([a-z/°]+)", show(value, dimension)).groups()
    assert float(read(figure)) * _SIZES[dimension][unit] == pytest.approx(value, rel=5.1e-3)
    sizes = sorted(_SIZES[dimension].values())
    if dimension != "angle" and sizes[0] <= value < 1000 * sizes[0]:
        assert abs(float(read(figure))) >= 0.9995  # the largest unit that keeps it at or above one
    assert show(value, dimension, like=value) == f"{figure}{'' if unit == '°' else ' '}{unit}"


@given(st.floats(0, 1))
@example(0.9999)
@example(1 - 1e-7)
@example(1e-9)
def test_a_share_is_nothing_or_all_only_where_it_is(share: float) -> None:
    assume(share < 1 - 1e-8 or share == 1)
    text = percent(share)
    assert (text == "100 %") == (share == 1)
    assert (text == "0 %") == (share == 0)
    if text != "< 0.1 %":
        assert float(text.removesuffix(" %")) == pytest.approx(100 * share, abs=0.5)


@given(st.floats(-50, 1))
@example(-1e-6)
@example(0.0)
def test_the_sign_of_a_margin_is_never_lost(margin: float) -> None:
    long, short = signed_percent(margin), margin_in_short(margin)
    assert short.startswith("✓" if margin >= 0 else "✗")
    if margin <= -0.005:  # one scale for all that fails: a multiple of the limit, which is above one
        assert long == f"{number(1 - margin)} × the limit"
        assert short == f"✗ {number(1 - margin)} ×"
    elif margin >= 0.005:
        assert long.startswith("+")
    else:
        assert ("at the limit" in short) == (margin >= 0)
        assert ("just over" in long) <= (margin < 0)


@given(st.floats(-500, 500))
def test_hundredths_have_no_minus_before_a_zero(value: float) -> None:
    text = hundredths(value)
    assert abs(read(text) - Decimal(value)) <= Decimal("0.0050001")
    assert text != "−0.00"


def test_a_value_given_stays_as_it_was_given() -> None:
    assert (show(2.0, "length", given=True), show(2.0, "length")) == ("2 m", "2.00 m")
    assert show_in(1852.0, "NM", "length", given=True) == "1 NM"
