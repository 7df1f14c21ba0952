"""Every equation can be typeset: one that cannot takes the Theory page and every report that cites it with it."""

from app.document.html import mathml
from nav_model.equations import ALL_EQUATIONS


def test_every_equation_is_typeset() -> None:
    wanted = tuple((equation.math, True) for equation in ALL_EQUATIONS)
    assert all("<math" in text for text in mathml(wanted).values())
