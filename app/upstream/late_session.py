"""A session is made when the browser connects, not when the page is asked for, with the cookies of that connection.

A page is text made once, and each visitor gets it with a token of a session that does not exist yet: whoever only
looks makes none, and the connection may reach another process.

Reports to send upstream, versions and ends, and what Panel's `reuse_sessions` does: docs/upstream/late_session.md
"""

import secrets
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import bokeh.resources
import panel as pn
from bokeh.document import Document
from bokeh.server.contexts import ApplicationContext
from bokeh.server.session import ServerSession
from bokeh.server.views.static_handler import StaticHandler
from bokeh.util.token import generate_jwt_token, generate_session_id
from panel.config import config
from panel.io.resources import LOCAL_DIST, Resources
from panel.io.server import DocHandler, server_html_page_for_session
from tornado.web import decode_signed_value

_UNUSED = ("bokeh-gl", "bokeh-mathjax")  # no chart is drawn by WebGL; Panel asks for the tables
_ANY_AGE = 36_500  # days: the login held when the token was given out, and the token has an end of its own


def page_of(document: Document, title: str) -> Callable[[str], str]:
    """Page that a browser loads before it connects, for the token of its session.

    Made from a session's document like any: all pages load the same, and have the same roots.
    """
    token = secrets.token_hex(32)
    resources = bokeh.resources.Resources(mode="server", root_url="/", path_versioner=StaticHandler.append_version)
    resources.components = [part for part in resources.components if part not in _UNUSED]
    text = server_html_page_for_session(
        SimpleNamespace(document=document, token=token),
        Resources.from_bokeh(resources),
        title,
        template=document.template,
        template_variables=document.template_variables,
    )
    return lambda given: text.replace(token, given)


def new_token(handler: DocHandler) -> str:
    """For a session of whoever asks now, not yet made."""
    server = handler.application
    return generate_jwt_token(
        generate_session_id(server.secret_key, server.sign_sessions),
        server.secret_key,
        server.sign_sessions,
        extra_payload=handler._generate_token_payload(),
        expiration=server.session_token_expiration,
    )


def person_of(payload: dict[str, Any]) -> bytes | None:
    """Who had logged in when a token with this payload was given out, as the login's cookie says it; None: nobody."""
    cookies = payload.get("cookies")
    signed = cookies.get("user") if isinstance(cookies, dict) else None
    if not isinstance(signed, str) or config.cookie_secret is None:
        return None
    return decode_signed_value(config.cookie_secret, "user", signed, max_age_days=_ANY_AGE)


async def end_session(context: ApplicationContext, session: ServerSession) -> None:
    """End a session that nobody is connected to, now instead of when its time has passed."""
    await context._discard_session(session, lambda _: session.connection_count == 0)


def sheets_from_here(document: Document) -> None:
    """Have a session load its style sheets from this server.

    Panel says so only where a page is sent with its session, and otherwise takes them from the network.
    """
    document.template_variables["dist_url"] = LOCAL_DIST


def connecting_cookies() -> dict[str, str]:
    """Cookies of the connection for which a session is made; none outside one."""
    context = pn.state.curdoc.session_context if pn.state.curdoc else None
    if context is None or context.request is None:
        return {}
    connecting = context.request._request  # what the proxy with the token's cookies stands for
    return {name: morsel.value for name, morsel in connecting.cookies.items()}


def visitor() -> str:
    """Who uses the page that asks: the person who logged in, else the address; empty outside a page."""
    context = pn.state.curdoc.session_context if pn.state.curdoc else None
    if context is None or context.request is None:
        return ""
    return pn.state.user or str(context.request._request.remote_ip)
