"""HTTP handlers of the dashboard: the page and its connection, the limit on sessions, health, headers."""

from __future__ import annotations

import asyncio
import logging
import socket
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary, WeakSet

from bokeh.server.contexts import ApplicationContext
from bokeh.server.session import ServerSession
from bokeh.util.token import check_token_signature, get_session_id, get_token_payload
from panel.config import config
from panel.io.server import DocHandler
from panel.io.state import state
from tornado.web import OutputTransform, RequestHandler, authenticated

from app.dashboard.lifeline import THEME_COOKIE
from app.serving.access import plain_page
from app.serving.allowance import FRAME, Allowance
from app.serving.board import BoardRow
from app.serving.logs import event
from app.serving.metrics import MetricsHandler, ServerMetrics
from app.serving.rules import Rules, is_loopback
from app.ui.faults import handle
from app.upstream.connection import FirstChanges, LostConnection, NoTracebacks
from app.upstream.late_session import end_session, new_token, person_of
from app.upstream.requests import serve_only
from nav_model.base.errors import InputError

# Bokeh compiles its callbacks and carries its model in the page, so scripts cannot be held to files; what holds is
# that nothing comes from, goes to, or frames us from elsewhere.
_POLICY = "; ".join(
    (
        "default-src 'self'",
        "script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:",
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' data: blob:",
        "font-src 'self' data:",
        "connect-src 'self' data: blob:",
        "worker-src 'self' blob:",
        "object-src 'none'",
        "base-uri 'none'",
        "form-action 'self'",
        "frame-ancestors 'none'",
    )
)
HEADERS = {
    "Content-Security-Policy": _POLICY,
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "same-origin",  # an address may carry a design
    "Cross-Origin-Opener-Policy": "same-origin",
    "Server": "NavBudget",
}


@dataclass
class RequestContext:
    """State that the handlers share with the server."""

    row: BoardRow
    """Where this process says how many sessions it has."""
    most: int
    """Sessions allowed at once, over all processes."""
    most_bytes: int
    """Of one message of a page, with all its frames."""
    page: Callable[[str, bool], str]
    """Make what a browser is sent for the token of a session, and for a page in dark."""
    heard: Callable[[], None]
    """Called with every message of a page."""
    keep: Callable[[socket.socket], None]
    """Called with every connection of a page."""
    admits: Callable[[str], bool]
    """True if somebody who is logged in may enter."""
    still_in: Callable[[Any], bool]
    """True while the login that a connection was made with holds; asked in a thread."""
    stopping: bool = False

    def full(self, own_sessions: int) -> bool:
        """True when the limit on sessions is reached; also updates this process's count on the board."""
        self.row.put("sessions", own_sessions)
        return self.row.board.total("sessions") >= self.most


_here: RequestContext


_connections: WeakSet[LimitedWSHandler] = WeakSet()
_allowances: WeakKeyDictionary[ServerSession, Allowance] = WeakKeyDictionary()
_addresses: WeakKeyDictionary[ServerSession, str] = WeakKeyDictionary()
_MOST_FAULTS = 50  # of one connection


def being_sent() -> bool:
    """True while messages to a page are being sent."""
    streams = (c.ws_connection.stream for c in _connections if c.ws_connection is not None)
    return any(stream is not None and stream.writing() for stream in streams)


async def hang_up_on_ended_logins() -> None:
    """Close every page whose login has been ended, here or through another process."""
    pages = list(_connections)
    ended = await asyncio.to_thread(lambda: [page for page in pages if not _here.still_in(page)])
    for page in ended:
        page.close(1008, "logged out")


def handle_page_fault(fault: BaseException) -> None:
    """Handle an exception in a page's callback; a page that goes on causing them is closed: each fills the log."""
    handle(fault)
    if isinstance(fault, InputError):
        return
    for page in list(_connections):
        if page.shows(state.curdoc):
            page.count_fault()


def close_door() -> None:
    """Accept no new sessions, also over open connections."""
    _here.stopping = True


async def _place_for(address: str, context: ApplicationContext) -> bool:
    """True if an address gets a place for a new page: while there are any, half of those of this process at most, so
    that nobody alone fills the server; only this machine's own gets all.

    Where there is none, the oldest page that nobody is connected to gives way: of this address if that has its half,
    else of the one with most pages.
    """
    sessions = list(context.sessions)
    idle = [s for s in sessions if s.connection_count == 0]
    connected = (page.request.remote_ip for page in _connections if not page.is_closed())
    held = Counter([*connected, *map(_addresses.get, idle)])
    full = _here.full(len(sessions))
    if not is_loopback(address) and held[address] >= max(1, _here.most // (2 * _here.row.board.processes)):
        idle = [s for s in idle if _addresses.get(s) == address]
    elif full:
        idle = [s for s in idle if held[_addresses.get(s)] > 1]
    else:
        return True
    if not idle:
        return False
    first = max(idle, key=lambda s: (held[_addresses.get(s)], s.milliseconds_since_last_unsubscribe))
    await end_session(context, first)
    return not _here.full(len(list(context.sessions)))


class PageHandler(DocHandler):
    """The page before its session: what the browser needs to load and connect, with a token of its own.

    The session is made when the browser connects, by the process it reaches; a request without a connection makes
    none.
    """

    @authenticated
    async def get(self, *_: Any, **__: Any) -> None:
        """The page for a new session; 503 with an explanation at the limit on sessions."""
        self.set_header("Cache-Control", "no-store")  # the token is one visitor's and lives for minutes
        if _here.stopping:
            self._turn_away(503, "Restarting", "This server is being stopped or restarted.", after=10)
        elif not _here.admits(str(self.current_user)):
            self._turn_away(403, "Not admitted", f"{self.current_user} has no access to this server.")
        elif not await _place_for(str(self.request.remote_ip), self.application_context):
            _here.row.add("refused")
            event("full", sessions=_here.most)
            self._turn_away(
                503,
                "All places are taken",
                f"This server keeps {_here.most} sessions at a time, and all are in use. A place becomes free "
                "shortly after somebody closes the page.",
                after=60,
            )
        else:
            self.finish(_here.page(new_token(self), self.get_cookie(THEME_COOKIE) == "dark"))

    def _turn_away(self, status: int, title: str, text: str, after: int = 0) -> None:
        self.set_status(status)
        # From here: a proxy may serve this below a path of its own.
        again = {"again": f".{self.request.uri}", "link_text": "Try again"} if after else {}
        if after:
            self.set_header("Retry-After", str(after))
        self.finish(plain_page(title, text, **again))


class LimitedWSHandler(FirstChanges, LostConnection, NoTracebacks):
    """The page's connection; it opens no session beyond the limit either, and takes no more than a page sends."""

    receiver: Any
    _coming = 0  # bytes of the message that is being received
    _faults = 0

    async def prepare(self) -> None:
        """Refuse before the handshake."""
        await super().prepare()
        if self._finished:
            return
        names = self.request.headers.get("Sec-WebSocket-Protocol", "").split(",")
        token = names[-1].strip()
        try:
            wanted = str(get_session_id(token))
        except (ValueError, TypeError, KeyError, RecursionError):  # not a token; the handshake refuses it
            self.set_status(403)
            self.finish()
            return
        if not self._fetched(token):  # the page of another person
            self.set_status(403)
            self.finish()
            return
        known = {session.id for session in self.application_context.sessions}
        if wanted not in known and (
            _here.stopping or not await _place_for(str(self.request.remote_ip), self.application_context)
        ):
            _here.row.add("refused")
            self.set_status(503)
            self.finish()

    def _fetched(self, token: str) -> bool:
        """True if a token was given out to the person who connects; one that is not signed the handshake refuses."""
        server = self.application
        if not check_token_signature(token, server.secret_key, server.sign_sessions):
            return True
        person = self.get_secure_cookie("user", max_age_days=config.oauth_expiry)
        return bool(person_of(get_token_payload(token)) == person)

    def open(self, *arguments: Any, **options: Any) -> None:
        """As Bokeh; and remember the connection for as long as it lives."""
        _connections.add(self)
        super().open(*arguments, **options)
        if self.ws_connection is not None and self.ws_connection.stream is not None:
            _here.keep(self.ws_connection.stream.socket)

    def is_closed(self) -> bool:
        """True once nobody is there any more."""
        return self.ws_connection is None

    async def _async_open(self, token: str) -> None:
        """As Bokeh, which makes a page also for whoever has hung up, and keeps it as one in use."""
        if self.is_closed():
            return
        await super()._async_open(token)
        if not self._is_gone():
            _addresses[self.connection.session] = str(self.request.remote_ip)
        if self.is_closed():  # while it was made
            self.on_close()

    async def _receive(self, fragment: str | bytes) -> Any:
        if self.receiver is None:  # before the greeting, and once it is refused
            return None
        self._coming += len(fragment) + FRAME
        if self._coming > _here.most_bytes:
            self._refuse("larger than --max-message")
            return None
        try:
            message = await super()._receive(fragment)
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
            self._refuse("malformed")
            return None
        if message is not None:
            self._coming = 0
        return message

    async def _handle(self, message: Any) -> Any:
        _here.heard()
        if self.is_closed() or self._is_gone():
            return None
        reason = _allowances.setdefault(self.connection.session, Allowance(_here.most_bytes)).against(message)
        if reason:
            self._refuse(reason)
            return None
        return await super()._handle(message)

    async def send_message(self, message: Any) -> None:
        """As Bokeh; a message that failed is a fault."""
        await super().send_message(message)
        if message.msgtype == "ERROR":
            self.count_fault()

    def shows(self, document: Any) -> bool:
        """True for the connection of a document's page."""
        return not self.is_closed() and not self._is_gone() and self.connection.session.document is document

    def count_fault(self) -> None:
        """Count a fault of this page; one that goes on causing them is closed."""
        self._faults += 1
        if self._faults > _MOST_FAULTS:
            self._refuse("fault after fault")

    def on_close(self) -> None:
        """As Bokeh; and let go of half a message."""
        self._drop_receiver()
        super().on_close()

    def _drop_receiver(self) -> None:
        """Free what came of a message at once: a receiver refers to itself, and garbage waits for a quiet moment."""
        if self.receiver is not None:
            vars(self.receiver).clear()
            self.receiver = None

    def _refuse(self, reason: str) -> None:
        self._drop_receiver()  # the browser may go on sending
        event("page closed", logging.WARNING, reason=reason, peer=self.request.remote_ip)
        self.close(1008, reason)

    def _internal_error(self, _: str) -> None:
        self._refuse("malformed")

    _protocol_error = _internal_error


class Alive(RequestHandler):
    """Health check, without building a page."""

    def get(self) -> None:
        """Say that this process answers."""
        self.set_header("Cache-Control", "no-store")
        self.write({"alive": True})


class _Headers(OutputTransform):
    """Adds the security headers to every response."""

    def __init__(self, request: Any) -> None:
        self._request = request

    def transform_first_chunk(self, status_code: int, headers: Any, chunk: bytes, finishing: bool) -> Any:
        for name, value in HEADERS.items():
            headers[name] = value
        return status_code, headers, chunk


def around(rules: Rules, here: RequestContext, metrics: ServerMetrics) -> dict[str, Any]:
    """The server's further options: routes and headers."""
    global _here
    _here = here
    serve_only(PageHandler, LimitedWSHandler)
    return {
        "extra_patterns": [
            (r"/liveness", Alive),
            (r"/metrics", MetricsHandler, {"metrics": metrics, "rules": rules}),
        ],
        "transforms": [_Headers],
    }
