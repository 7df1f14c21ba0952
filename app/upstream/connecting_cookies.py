"""A session sees the cookies its browser connects with, also those set since the page was asked for.

Bokeh hands a session the cookies that its token holds, which are those of the request for the page: what a script in
the page has set by then is not among them.

Written for: Bokeh 3.9.2
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_connecting_cookies.py::test_as_shipped_a_session_sees_old_cookies fails
"""

from __future__ import annotations

import panel as pn


def connecting_cookies() -> dict[str, str]:
    """Cookies of the connection for which a session is made; none outside one."""
    context = pn.state.curdoc.session_context if pn.state.curdoc else None
    if context is None or context.request is None:
        return {}
    connecting = context.request._request  # what the proxy with the token's cookies stands for
    return {name: morsel.value for name, morsel in connecting.cookies.items()}
