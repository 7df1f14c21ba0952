"""Work that may wait until the first screen stands."""

from __future__ import annotations

from collections.abc import Callable

import panel as pn


def once_shown(make: Callable[[], None]) -> None:
    """Call ``make`` when the session's page stands in the browser, in the order asked for.

    Each call has a turn of the event loop of its own, so that other sessions' events come in between. Where no
    page is being served, or it stands already, it is called at once.
    """
    document = pn.state.curdoc
    if document is None or pn.state.loaded:
        make()
    else:
        pn.state.onload(lambda: document.add_next_tick_callback(make))
