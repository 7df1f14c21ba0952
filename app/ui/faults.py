"""Exceptions that no page expects.

Of bad input the user is told what is wrong. Of a fault the log gets the trace, the user a sentence with a number to
find it there. Nothing of its text is shown or logged as JSON, for it may quote a design.
"""

import logging
import secrets
from collections.abc import Callable
from weakref import WeakKeyDictionary, WeakMethod

import panel as pn
from bokeh.document import Document

from nav_model.base.errors import InputError

_LOGGER = logging.getLogger("navbudget")
_tellers: WeakKeyDictionary[Document, WeakMethod[Callable[[str], None]]] = WeakKeyDictionary()


def report_to(say: Callable[[str], None]) -> None:
    """Have faults in the current session reported by `say`, a method; does nothing outside a session.

    The method is not kept alive: it belongs to a page, and what is told of faults must not hold pages in memory.
    """
    if pn.state.curdoc:
        _tellers[pn.state.curdoc] = WeakMethod(say)


def clear_message() -> None:
    """Take back what was said last, as an action that came later succeeded."""
    if say := _teller():
        say("")


def handle(fault: BaseException) -> None:
    """Handler of exceptions in callbacks (`pn.config.exception_handler`)."""
    say = _teller()
    if say is not None and isinstance(fault, InputError):
        say(str(fault))
        return
    number = secrets.token_hex(3)
    _LOGGER.log(logging.ERROR, "fault", exc_info=fault, extra={"fields": {"fault": number}})
    if say is not None:
        say(
            f"NavBudget failed ({type(fault).__name__}). This step was not done. Your design and everything saved "
            f"are unchanged. The server's log has the cause as fault {number}."
        )


def _teller() -> Callable[[str], None] | None:
    teller = _tellers.get(pn.state.curdoc) if pn.state.curdoc else None
    return None if teller is None else teller()
