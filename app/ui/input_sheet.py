"""A sheet of inputs, drawn by the browser as one component.

Inputs that are widgets, three each, are a thousand models of a page. Here an input is a row of data, and one message
brings back what a person typed, chose or slid. An error is shown at its row, and the last valid value is kept.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, ClassVar, NamedTuple

import panel as pn
import param

from app.ui.log_scale import STEP, LogScale
from app.ui.theme import BASE, PRINT_NOTHING
from app.upstream.plain_script import PlainScript
from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.errors import InputError

Row = dict[str, Any]


class SheetInput(ABC):
    """One input of a sheet: its row as data, and what becomes of what a person does there.

    Parameters
    ----------
    key : str
        Dotted key of the input.
    """

    def __init__(self, key: str) -> None:
        self.key = key
        self.error = ""
        """Why what was entered last is refused; empty if it was taken."""
        self._last: object = None

    @abstractmethod
    def row(self) -> Row:
        """The part of its row that stays; see `text_row` and `choice_row`."""

    @abstractmethod
    def current(self) -> Row:
        """The part that follows the value: ``text``, and where there is such a thing the slider's ``place``, ``size``
        [SI], ``unit``, a ``mark`` of the source with its ``note``, in view at once where something was
        ``converted``."""

    @abstractmethod
    def value(self) -> object:
        """The current value: when it is another, a refusal has done its service."""

    @abstractmethod
    def take(self, text: str) -> InputError | None:
        """Put a text in force, or say or raise why not."""

    def slide(self, place: float) -> InputError | None:
        """Put the value at a place of the slider in force, or say why not."""
        return InputError(self.key, "has no slider", place)

    def turn_to(self, unit: str) -> InputError | None:
        """Show the value in another of its units, or say why not."""
        return InputError(self.key, "has no unit to choose", unit)

    def now(self) -> Row:
        """The row as it shows now; a refusal stays until there is another value."""
        value = self.value()
        if value != self._last:
            self._last, self.error = value, ""
        return {**self.current(), "error": self.error}

    def put(self, take: Callable[[], InputError | None]) -> None:
        """Put something in force, and keep why it is refused."""
        try:
            refused = take()
        except InputError as error:
            refused = error
        self.error = "" if refused is None else refused.reason if refused.key == self.key else str(refused)


class Group(NamedTuple):
    """Inputs under a title; without one they are always in view."""

    title: str
    inputs: Sequence[SheetInput]
    open: bool = True
    pictured: bool = False
    """True if the sheet's picture is shown above them."""


class InputSheet(PlainScript):
    """Rows of inputs in groups that unfold.

    `follow` shows what has changed. What is told to the browser is always all that differs from the beginning, so it
    does not matter which of two changes arrives last or whether it has drawn the rows yet.
    """

    heading = param.String(doc="For screen readers, above all.")
    groups = param.List(default=[], doc="Dicts of title, open, pictured and rows.")
    news = param.Dict(default={}, doc="Key -> what its row shows, where that is not as in `groups`.")
    heard = param.Integer(default=0, doc="Number of the last message that was dealt with.")
    picture = param.String(doc="HTML above the inputs of a group.")
    invalid = param.Integer(default=0, doc="Rows whose last entry was refused; the browser is not told.")

    _rename: ClassVar[dict[str, str | None]] = {"invalid": None}

    _stylesheets: ClassVar[list[str]] = [BASE, PRINT_NOTHING]

    def __init__(self, groups: Sequence[Group], **params: Any) -> None:
        self.inputs = {each.key: each for group in groups for each in group.inputs}
        self._rows = {key: each.row() for key, each in self.inputs.items()}
        self._begin = {key: each.now() for key, each in self.inputs.items()}
        self._entering = False  # something is being put in force, and told when it is
        rows = [
            {
                "title": group.title,
                "open": group.open,
                "pictured": group.pictured,
                "rows": [{"key": each.key, **self._rows[each.key], **self._begin[each.key]} for each in group.inputs],
            }
            for group in groups
        ]
        super().__init__(groups=rows, **{"sizing_mode": "stretch_width", "margin": 0, **params})

    def follow(self) -> None:
        """Show every row's value of now."""
        if not self._entering:
            self._tell(self.heard)

    def _tell(self, heard: int) -> None:
        now = {key: each.now() for key, each in self.inputs.items()}
        news = {key: row for key, row in now.items() if row != self._begin[key]}
        invalid = sum(bool(row["error"]) for row in news.values())
        with param.parameterized.batch_call_watchers(self):  # "update" looks at every parameter
            if self.news != news:
                self.news = news
            if self.invalid != invalid:
                self.invalid = invalid
            self.heard = heard

    def forget_refusals(self) -> None:
        """Drop every text that was refused."""
        for each in self.inputs.values():
            each.error = ""
        self.follow()

    def unfold(self, *titles: str, enter: bool = False) -> None:
        """Open these groups, close every other, and go to the first; ``enter``: into its first box."""
        self._send_msg({"open": titles, "enter": enter})

    def enter(self, key: str, text: str) -> None:
        """A person has typed or chosen something."""
        self._put(key, lambda: self.inputs[key].take(text))

    def _put(self, key: str, take: Callable[[], InputError | None], heard: int | None = None) -> None:
        with pn.io.hold():  # all that comes of it is one message
            self._entering = True
            try:
                self.inputs[key].put(take)
            finally:
                self._entering = False
                self._tell(self.heard if heard is None else heard)

    def _handle_msg(self, msg: Any) -> None:
        """Handle a message of the browser: a key, what was done to its row, and the number of the message."""
        match msg:
            case {"key": str(key), "number": int(number), **done} if key in self.inputs:
                each, row = self.inputs[key], self._rows[key]
            case _:
                return
        match done:
            case {"text": str(text)}:
                self._put(key, lambda: each.take(text), number)
            case {"place": int() | float() as place} if math.isfinite(place) and "slider" in row:
                self._put(key, lambda: each.slide(place), number)
            case {"unit": str(unit)} if unit in dict(row.get("units", ())):
                self._put(key, lambda: each.turn_to(unit), number)
            case _:
                self._tell(number)


def text_row(
    label: str, help: str, dimension: str = "", *, unit: str = "", empty: str = "", scale: LogScale | None = None,
    of_axes: bool = False, wide: bool = False,
) -> Row:  # fmt: skip
    """The row of an input that is text.

    Parameters
    ----------
    label, help : str
    dimension : str
        Whose units it can be shown in; with `unit` in that one alone.
    empty : str
        What an empty box means.
    scale : LogScale, optional
        Of a slider.
    of_axes : bool
        Whether the slider moves several numbers at once: the browser does not know the text at a place.
    wide : bool
        Whether the box has a line for itself.
    """
    row: Row = {"kind": "text", "label": label, "help": help, "empty": empty, "wide": wide}
    if dimension:
        kind = DIMENSIONS[dimension]
        row["units"] = [] if kind.decibels else [(u, float(f)) for u, f in kind.units.items() if unit in ("", u)]
    if scale is not None:
        start, end = scale.ends
        row["slider"] = {"start": start, "end": end, "step": STEP, "zero": scale.zero_below, "ofAxes": of_axes}
    return row


def choice_row(label: str, help: str, options: Sequence[tuple[str, str]] = (), *, wide: bool = False) -> Row:
    """The row of a choice among pairs of text and label, or of a switch (text "true" or "false") without options."""
    kind = "choice" if options else "switch"
    return {"kind": kind, "label": label, "help": help, "options": list(options), "wide": wide}
