"""Typed parameters for views: Param's own types do not always state what a parameter holds."""

from __future__ import annotations

from typing import Any, TypeVar, cast

import param

T = TypeVar("T")


def held(kind: type[T], *, constant: bool = True) -> T:
    """A parameter that holds an instance of `kind`, never None and never a copy.

    Declared on a class, ``session = held(Session)`` reads as that instance, for the type checker too.
    """
    return cast(T, param.ClassSelector(class_=kind, allow_None=False, instantiate=False, constant=constant))


def declared(parameter: param.Parameter[Any]) -> Any:
    """A parameter typed as its value: ``figure: str = declared(param.Selector(...))``."""
    return parameter
