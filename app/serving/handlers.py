"""What stands around the dashboard on the wire: the limit on sessions, health, metrics, headers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any
from weakref import WeakSet

from bokeh.protocol.exceptions import ProtocolError
from bokeh.server.urls import per_app_patterns
from bokeh.util.token import get_session_id
from panel.io.server import DocHandler, WSHandler
from prometheus_client import (
    CollectorRegistry,
    Counter,
    Gauge,
    ProcessCollector,
    disable_created_metrics,
    generate_latest,
)
from tornado.web import OutputTransform, RequestHandler

from app import workers
from app.serving.access import plain_page
from app.serving.logs import event
from app.serving.rules import Rules, is_loopback

_FORWARDED = ("Forwarded", "X-Forwarded-For", "X-Real-Ip")

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


class Metrics:
    """Counters of one server, in Prometheus' terms."""

    def __init__(self) -> None:
        disable_created_metrics()  # the process says when it began
        self.registry = CollectorRegistry()
        ProcessCollector(registry=self.registry)
        self.sessions = Gauge("navbudget_sessions", "Sessions open now.", registry=self.registry)
        self.limit = Gauge("navbudget_sessions_limit", "Sessions allowed at once.", registry=self.registry)
        self.opened = Counter("navbudget_sessions_opened", "Sessions opened.", registry=self.registry)
        self.refused = Counter("navbudget_sessions_refused", "Visitors told it is full.", registry=self.registry)
        self.events = Counter("navbudget_events", "Budgets computed for a change.", registry=self.registry)
        self.heavy = Gauge("navbudget_heavy_tasks", "Heavy tasks waiting or running.", registry=self.registry)
        self.uptime = Gauge("navbudget_uptime_seconds", "Seconds since the server began.", registry=self.registry)
        self.heavy.set_function(workers.under_way)


class _Limit:
    """How many sessions there may be, whether new ones are let in, and what the handlers tell of them."""

    most = 1
    stopping = False
    metrics: Metrics
    heard: Callable[[], None]


_connections: WeakSet[LimitedWSHandler] = WeakSet()


def being_sent() -> bool:
    """Whether a page has not yet taken all that was sent to it."""
    streams = (own.ws_connection.stream for own in _connections if own.ws_connection is not None)
    return any(stream is not None and stream.writing() for stream in streams)


def close_door() -> None:
    """Let no new session in, over connections that are open already either."""
    _Limit.stopping = True


class LimitedDocHandler(DocHandler):
    """The page, unless the server is full."""

    async def get(self, *arguments: Any, **options: Any) -> None:
        """The page of a new session, or 503 with a page that says so."""
        if _Limit.stopping:
            self._turn_away("Restarting", "This server is being stopped or restarted.", after=10)
            return
        if self.current_user is not None and len(list(self.application_context.sessions)) >= _Limit.most:
            _Limit.metrics.refused.inc()
            event("full", sessions=_Limit.most)
            self._turn_away(
                "All places are taken",
                f"This server keeps {_Limit.most} sessions at a time, and all are in use. A place becomes free "
                "shortly after somebody closes the page.",
                after=60,
            )
            return
        page = super().get(*arguments, **options)
        if page is not None:  # None: sent to log in
            await page

    def _turn_away(self, title: str, text: str, after: int) -> None:
        self.set_status(503)
        self.set_header("Retry-After", str(after))
        self.finish(plain_page(title, text, again=self.request.uri, link_text="Try again"))


class LimitedWSHandler(WSHandler):
    """The page's connection; it opens no session beyond the limit either."""

    async def prepare(self) -> None:
        """Refuse before the handshake."""
        await super().prepare()
        if self._finished:
            return
        names = self.request.headers.get("Sec-WebSocket-Protocol", "").split(",")
        try:
            wanted = get_session_id(names[-1].strip())
        except ValueError:  # not a token; the handshake refuses it
            self.set_status(403)
            self.finish()
            return
        known = {session.id for session in self.application_context.sessions}
        if wanted not in known and (_Limit.stopping or len(known) >= _Limit.most):
            _Limit.metrics.refused.inc()
            self.set_status(503)
            self.finish()

    def open(self, *arguments: Any, **options: Any) -> None:
        """As Bokeh; and remember the connection for as long as it lives.

        A message is a dozen small frames and more: without `set_nodelay` the second waits until the browser has
        confirmed the first, up to 40 ms.
        """
        _connections.add(self)
        super().open(*arguments, **options)
        if self.ws_connection is not None:  # None: refused
            self.set_nodelay(True)

    async def _handle(self, message: Any) -> Any:
        """As Bokeh, but a page may change what it shows, not put another document in its place."""
        _Limit.heard()
        if message.msgtype == "PUSH-DOC":
            raise ProtocolError("PUSH-DOC is not taken")
        return await super()._handle(message)

    async def send_message(self, message: Any) -> None:
        """As Bokeh, but a fault is not told with its traceback, which says where and what is installed here."""
        if message.msgtype == "ERROR":
            message.content = {"text": "the server could not do this", "traceback": None}
        await super().send_message(message)


class Alive(RequestHandler):
    """Whether the server answers; builds no page, so that asking costs nothing."""

    def get(self) -> None:
        """Yes."""
        self.set_header("Cache-Control", "no-store")
        self.write({"alive": True})


class MetricsHandler(RequestHandler):
    """Metrics for this machine, and for whoever is logged in."""

    def initialize(self, metrics: Metrics, server: dict[str, Any], rules: Rules) -> None:
        self._metrics, self._server, self._rules = metrics, server, rules

    def get(self) -> None:
        """Prometheus text."""
        if not self._may_see():
            self.set_status(403)
            self.finish("metrics are for this machine, or for who is logged in\n")
            return
        self._metrics.sessions.set(len(self._server["server"].get_sessions()))
        self._metrics.uptime.set(self._server["uptime"]())
        self.set_header("Content-Type", "text/plain; version=0.0.4; charset=utf-8")
        self.set_header("Cache-Control", "no-store")
        self.finish(generate_latest(self._metrics.registry))

    def _may_see(self) -> bool:
        # Behind a proxy on this machine everybody seems to be here: a forwarded request is not from here.
        forwarded = any(name in self.request.headers for name in _FORWARDED) and not self._rules.behind_proxy
        if is_loopback(self.request.remote_ip or "") and not forwarded:
            return True
        if self._rules.password_file is None:
            return False
        return self.application.auth_provider.get_user(self) is not None


class _Headers(OutputTransform):
    """Every answer carries the headers that keep other sites out."""

    def __init__(self, request: Any) -> None:
        self._request = request

    def transform_first_chunk(self, status_code: int, headers: Any, chunk: bytes, finishing: bool) -> Any:
        for name, value in HEADERS.items():
            headers[name] = value
        return status_code, headers, chunk


def around(rules: Rules, metrics: Metrics, server: dict[str, Any], heard: Callable[[], None]) -> dict[str, Any]:
    """What the server must be told, beside the dashboard itself; ``heard`` is called with every message of a page."""
    _Limit.heard = heard
    _Limit.most, _Limit.metrics, _Limit.stopping = rules.max_sessions, metrics, False
    metrics.limit.set(rules.max_sessions)
    # The page and its connection; the ways to embed the page elsewhere are not offered.
    per_app_patterns[:] = [(r"/ws", LimitedWSHandler), (r"/?", LimitedDocHandler)]
    return {
        "extra_patterns": [
            (r"/liveness", Alive),
            (r"/metrics", MetricsHandler, {"metrics": metrics, "server": server, "rules": rules}),
        ],
        "transforms": [_Headers],
    }
