"""A box for one input, with or without a slider: an error is shown at the box, and the last valid value is kept."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, cast

import panel as pn
import panel_material_ui as pmui
import param

from app.ui.log_slider import LogSlider
from app.upstream.prompt_input import PromptInput
from nav_model.base.errors import InputError
from nav_model.design.declaration import BaseQuantity
from nav_model.design.several import Axes


class InputBox(pn.viewable.Viewer, param.ParameterizedABC):
    """Box and perhaps slider of one input.

    Widget values are compared with the current value: a widget that only follows it changes nothing.

    Parameters
    ----------
    key : str
        Dotted key of the input.
    box : TextInput or Select
        Shows the input as text.
    slider : LogSlider, optional
        Moves the size of the input.
    """

    error = param.String(doc="Why what was typed last is refused; empty if it was taken.")

    def __init__(self, key: str, box: pmui.TextInput | pmui.Select, slider: LogSlider | None = None) -> None:
        super().__init__()
        self.key, self.box, self.slider = key, box, slider
        self._last: object = None

    def listen(self) -> None:
        """Follow what is in force, and from now on take what a person types or slides."""
        self.follow()
        self.box.param.watch(self._typed, "value")
        if self.slider is not None:
            self.slider.param.watch(self._slid, "value")

    # --- what a kind of input says ---------------------------------------------------------------------------

    @abstractmethod
    def value(self) -> object:
        """The current value."""

    @abstractmethod
    def text(self) -> str:
        """The current value as the box shows it."""

    def size(self) -> float | None:
        """The current value as the slider shows it, SI; None: there is no slider, or it stays where it is."""
        return None

    @abstractmethod
    def help(self) -> str:
        """What the box says under it unless something is refused."""

    @abstractmethod
    def take(self, text: str) -> InputError | None:
        """Put a text in force, or say or raise why not."""

    def take_size(self) -> InputError | None:
        """Put in force what the slider says, or say why not; without a slider there is nothing to put."""
        return None

    # --- how all follow and take -----------------------------------------------------------------------------

    def follow(self) -> None:
        """Show the current value; a text that was refused stays until there is another value."""
        value, size = self.value(), self.size() if self.slider is not None else None
        if value != self._last:
            self._last = value
            self._refuse("")
        if self.slider is not None and size is not None:
            self.slider.follow(size)
        if not self.error:
            if isinstance(self.box, PromptInput):
                self.box.follow(self.text())
            else:
                self.box.value = self.text()
        self.say()

    def clear(self) -> None:
        """Drop a text that was refused."""
        self.error = ""
        self.follow()

    def say(self) -> None:
        """Show the help, or why the text is refused."""
        said: dict[str, object] = {"helper_text": self.error or self.help()}
        if isinstance(self.box, pmui.TextInput):
            said["error_state"] = bool(self.error)
        if any(getattr(self.box, name) != what for name, what in said.items()):
            # In one message: a second one could undo what is typed between the two.
            self.box.param.update(**said)

    def put(self, take: Callable[[], InputError | None]) -> None:
        """Put something in force, and show it or why it is refused: all that comes of it is one message."""
        with pn.io.hold():
            try:
                refused = take()
            except InputError as error:
                refused = error
            self._refuse("" if refused is None else refused.reason if refused.key == self.key else str(refused))
            self.follow()

    def _refuse(self, why: str) -> None:
        if self.error != why:  # to set it costs as much as to format the value
            self.error = why

    def _typed(self, event: param.parameterized.Event) -> None:
        if event.new == self.text():
            self._refuse("")
            self.say()
        else:
            self.put(lambda: self.take(event.new))

    def _slid(self, _: param.parameterized.Event) -> None:
        size = self.size()
        assert self.slider is not None
        if size is None or not self.slider.shows(size):
            self.put(self.take_size)


def slider_of(declared: BaseQuantity[Any] | Axes, value: float) -> LogSlider:
    """The slider of a declaration over its soft bounds, at a value [SI]; its far left is zero if that is allowed."""
    low, high = cast("tuple[float, float]", declared.softbounds)
    above_zero = isinstance(declared, BaseQuantity) and not declared.inclusive_bounds[0]
    zero = declared.limits[0] == 0 and not above_zero
    return LogSlider(str(declared.label), low, high, declared.unit, declared.dimension, zero, value)
