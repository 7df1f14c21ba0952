"""Faults of our own that reach nobody's `except`: the log gets the trace, the person a sentence and a number that
finds it there. Nothing of the fault's text is shown or logged as JSON, for it may quote a design."""

from __future__ import annotations

import logging
import secrets
from collections.abc import Callable
from weakref import WeakKeyDictionary

import panel as pn
from bokeh.document import Document

from app.serving.logs import LOGGER

_tellers: WeakKeyDictionary[Document, Callable[[str], None]] = WeakKeyDictionary()


def tell_here(say: Callable[[str], None]) -> None:
    """Have faults in the current session said by `say`; does nothing outside a session."""
    if pn.state.curdoc:
        _tellers[pn.state.curdoc] = say


def caught(fault: BaseException) -> None:
    """What Panel calls with an exception that a callback let through (`pn.config.exception_handler`)."""
    number = secrets.token_hex(3)
    LOGGER.log(logging.ERROR, "fault", exc_info=fault, extra={"fields": {"fault": number}})
    say = _tellers.get(pn.state.curdoc) if pn.state.curdoc else None
    if say is not None:
        say(
            f"Something failed in NavBudget ({type(fault).__name__}), and this step was not done. The design and "
            f"what was saved are as they were. The server's log has the cause as fault {number}."
        )
