"""Numba finds out the types of an operation once; as shipped it looks them up again at each use."""

import numpy as np
import pytest
from numba import errors, njit
from numba.core.types.functions import BaseFunction, Function
from numba.core.typing.templates import AbstractTemplate

from nav_model.base import numba_typing

ELEMENTS = 40


def lookups(monkeypatch, get_call_type) -> int:
    """Number of templates that are asked to compile a sum of array elements."""
    asked = []

    def counted(template, *arguments):
        asked.append(template)
        return ask(template, *arguments)

    ask = AbstractTemplate.apply
    text = f"lambda a: {' + '.join(f'a[{i}]' for i in range(ELEMENTS))}"
    with monkeypatch.context() as patch:
        patch.setattr(BaseFunction, "get_call_type", get_call_type)
        patch.setattr(AbstractTemplate, "apply", counted)
        assert njit(eval(text))(np.arange(ELEMENTS)) == ELEMENTS * (ELEMENTS - 1) / 2
    return len(asked)


def test_as_shipped_every_use_is_looked_up_again(monkeypatch):
    once = lookups(monkeypatch, numba_typing.remembered)
    assert lookups(monkeypatch, numba_typing.as_shipped) > 2 * once + ELEMENTS


def test_kernels_are_compiled_this_way():
    import nav_model.base.compiled  # noqa: F401

    assert Function.get_call_type is numba_typing.remembered


@pytest.mark.long
def test_each_pair_of_types_has_its_own_answer():
    numba_typing.remember()
    function = njit(lambda a, b: a * b)
    assert function(2, 3) == 6
    assert function(0.5, 3) == 1.5
    assert function(1j, 3.0) == 3j
    assert list(function(np.arange(3), 2)) == [0, 2, 4]
    for _ in range(2):
        with pytest.raises(errors.TypingError, match="No implementation of function"):
            function(1.0, None)
