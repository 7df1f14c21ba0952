"""Inputs that have moved since a result was computed, by the names that a page gives them."""

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from itertools import islice
from typing import Any

from nav_model.base.errors import InputError
from nav_model.design import Design, Value
from nav_model.design.declaration import in_sentence
from nav_model.design.figures import FIGURES
from nav_model.design.parts import PRESET_KEYS, TOP_KEYS, declaration_of
from nav_model.design.user_entries import UserEntries

_MOST_NAMED = 2


def moved_inputs(before: Design, now: Design, subject: Callable[[Design], object]) -> str:
    """The inputs in which two designs differ and that a result follows from, the first two by name.

    Parameters
    ----------
    before : Design
        The design that the result is of.
    now : Design
    subject : callable
        All of a design that the result follows from, to be compared. It may raise an InputError.

    Returns
    -------
    str
        Such as "angle random walk and fix interval"; empty where the result is one of both designs.

    Examples
    --------
    >>> design = Design({"imu.angle_random_walk": 1e-4})
    >>> moved_inputs(design, design.replace({"imu.angle_random_walk": 2e-4}), lambda design: design)
    'angle random walk'
    """
    known = subject(before)

    def moves(changes: dict[str, Value], entries: UserEntries) -> bool:
        try:
            return subject(before.replace(changes, entries=entries)) != known
        except InputError:
            return True

    with suppress(InputError):
        if subject(now) == known:
            return ""
    steps = list(_steps(before, now))
    # One input at a time. Where none alone moves the result, as a value and its switch do together, all are named.
    alone = list(islice((label for label, changes, entries in steps if moves(changes, entries)), _MOST_NAMED + 1))
    labels = alone or [label for label, _, _ in steps] or ["an input"]
    named = labels[:_MOST_NAMED]
    return f"{', '.join(named)} and others" if len(labels) > _MOST_NAMED else " and ".join(named)


def _steps(before: Design, now: Design) -> Iterator[tuple[str, dict[str, Value], UserEntries]]:
    """Each input that differs, by its name: what changes in the design before, and its entries with the change."""
    old, new = before.entries, now.entries
    for key, value in now.items():
        if key not in PRESET_KEYS and value != before[key]:
            yield _label(key), {key: value}, old
    for kind, called in (("contributors", "contributor"), ("limits", "limit")):
        held, given = ({entry.name: entry for entry in getattr(entries, kind)} for entries in (old, new))
        for name in {**held, **given}:
            if held.get(name) != given.get(name):
                others = tuple(entry for entry in held.values() if entry.name != name)
                changed: dict[str, Any] = {kind: (*others, given[name]) if name in given else others}
                yield f'{called} "{name}"', {}, replace(old, **changed)
    if old.allocation != new.allocation:
        yield "allocation", {}, replace(old, allocation=new.allocation)


def _label(key: str) -> str:
    section, _, name = key.rpartition(".")
    if key in TOP_KEYS:
        return key
    label = in_sentence(declaration_of(key).label)
    return f"limit on {label}" if section == "requirements" and name in FIGURES else label
