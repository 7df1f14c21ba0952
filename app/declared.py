"""Typed parameters for views: Param's own types do not always state what a parameter holds."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar, cast

import param

T = TypeVar("T")


def required(kind: type[T], *, constant: bool = True) -> T:
    """A parameter that holds an instance of `kind`, never None and never a copy.

    Declared on a class, ``session = required(Session)`` reads as that instance, for the type checker too.
    """
    return cast(T, param.ClassSelector(class_=kind, allow_None=False, instantiate=False, constant=constant))


def optional(kind: type[T], doc: str) -> T | None:
    """A declared parameter that may also be None, as at first."""
    return cast(T, param.ClassSelector(class_=kind, default=None, allow_None=True, instantiate=False, doc=doc))


def chosen(default: T, options: Mapping[str, T] | Sequence[T], label: str) -> T:
    """A parameter that is one of some options, by their names where they have any."""
    objects: Any = dict(options) if isinstance(options, Mapping) else list(options)
    return cast(T, param.Selector(default=default, objects=objects, label=label))


def declared(parameter: param.Parameter[Any]) -> Any:
    """A parameter typed as its value: ``figure: str = declared(param.Selector(...))``."""
    return parameter
