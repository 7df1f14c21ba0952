"""The served app: one page a session, built from the link it was opened with."""

from __future__ import annotations

import asyncio
import ipaddress
import secrets
import signal
import socket
import time
from collections.abc import Callable, Sequence
from importlib.resources import files
from typing import Any

import panel as pn
from bokeh.settings import settings

from app import workers
from app.page import Frame, is_review_link
from app.serving.access import provider_of
from app.serving.collector import Collector, settle
from app.serving.faults import caught
from app.serving.handlers import Metrics, around, being_sent, close_door
from app.serving.logs import event, request_done, set_up, short
from app.serving.rules import Rules
from app.serving.writes import repair
from app.state import Session
from nav_model.design import Design
from nav_model.design_file import parse_design
from nav_model.inputs import DesignError
from nav_model.link import from_query, split_link

_MAX_BODY = 65_536  # of a posted form; files travel over the page's own connection
_MAX_HEADER = 65_536  # a design as a link is far shorter
_LAST_LOOKS = 20  # for results to reach the pages once all work has ended, 50 ms and more between two


def first_design() -> Design:
    """What a visitor without a link sees: a real inertial unit under a real radar."""
    text = files("app").joinpath("examples/mems_x_band.toml").read_text(encoding="utf-8")
    return parse_design(text, "first design")


def build(changed: Callable[[Any], None] | None = None) -> Any:
    """The page of one session; ``changed`` is called with every new budget.

    A link that is wrong is said so on the page, which opens all the same.
    """
    design, notice = first_design(), ""
    query = pn.state.location.search if pn.state.location else ""
    of_design, of_study = split_link(query)
    if of_design and not is_review_link(query):
        try:
            design = from_query(of_design)
        except DesignError as error:
            notice = f"The link was not used. {error}"
    try:
        session = Session(design)
    except DesignError as error:
        session, notice = Session(first_design()), f"The link was not used. {error}"
    session.study_link = of_study
    if changed is not None:
        session.param.watch(changed, "budget")
    return Frame(session, notice).view


def serve(rules: Rules) -> None:
    """Serve until stopped by SIGTERM or SIGINT; prints the address.

    Raises
    ------
    DesignError
        If the rules contradict each other, or the address cannot be listened on.
    """
    rules.check()
    pn.extension(exception_handler=caught)
    settings.perform_error_diagnostics = False  # Panel asks models for what they lack; no guess at what was meant
    repair()
    set_up(rules.log)
    workers.use(rules.workers)
    began, running, metrics, collector = time.monotonic(), dict[str, Any](), Metrics(), Collector()
    try:
        port = rules.port or _free_port(rules.address)
        server = pn.serve(
            {"/": lambda: _counted(metrics, collector)},
            address=rules.address,
            port=port,
            title="NavBudget",
            show=False,
            start=False,
            verbose=False,
            websocket_origin=_origins(rules.address, port, rules.allow_origin),
            websocket_max_message_size=rules.max_message,
            http_server_kwargs={"max_body_size": _MAX_BODY, "max_header_size": _MAX_HEADER},
            use_xheaders=rules.behind_proxy,
            sign_sessions=True,  # a session nobody was given cannot be opened
            secret_key=secrets.token_bytes(32),
            unused_session_lifetime_milliseconds=round(1000 * rules.session_lifetime),
            check_unused_sessions_milliseconds=min(10_000, round(500 * rules.session_lifetime)),
            log_function=request_done,
            **provider_of(rules),
            **around(rules, metrics, running, collector.heard),
        )
    except OSError as error:
        raise DesignError("--address", f"cannot listen on {rules.address}:{rules.port}: {error.strerror}") from error
    running |= {"server": server, "uptime": lambda: time.monotonic() - began}
    Frame(Session(first_design()))  # the first visitor should not wait for what Python loads late
    settle()
    print(f"NavBudget on http://{_host(rules.address)}:{port}", flush=True)
    event("started", address=rules.address, port=port, protected=rules.protected)
    _run(server, rules.grace, collector)
    event("stopped")


def _counted(metrics: Metrics, collector: Collector) -> Any:
    """`build`, seen by the operator: sessions come and go, budgets are computed."""
    metrics.opened.inc()
    collector.heard()
    name = short(pn.state.curdoc.session_context.id)
    event("session opened", session=name)

    def closed(_: Any) -> None:
        event("session closed", session=name)
        collector.page_closed()

    pn.state.on_session_destroyed(closed)
    return build(lambda _: metrics.events.inc())


def _run(server: Any, grace: float, collector: Collector) -> None:
    """Run until told to stop: nobody new is let in, heavy work may end and reach who asked for it, then everything
    is closed.

    A second signal does not wait.
    """
    loop = server.io_loop.asyncio_loop
    stopping: list[asyncio.Task[None]] = []

    async def wind_down() -> None:
        # Not Bokeh's `unlisten`, which also cuts what is just being answered.
        server._http.stop()
        close_door()
        deadline = loop.time() + grace
        quiet = 0  # looks in a row that found nothing; not seconds, in which a busy machine may do nothing
        while quiet < _LAST_LOOKS and loop.time() < deadline:
            quiet = 0 if workers.under_way() or being_sent() else quiet + 1
            await asyncio.sleep(0.05)
        server.io_loop.stop()

    def told() -> None:
        event("stopping", under_way=workers.under_way())
        if stopping:
            server.io_loop.stop()
        else:
            stopping.append(loop.create_task(wind_down()))

    server.start()
    collecting = loop.create_task(collector.run())
    for signal_number in (signal.SIGTERM, signal.SIGINT):
        loop.add_signal_handler(signal_number, told)
    try:
        server.io_loop.start()
    finally:
        collecting.cancel()
        server.stop(wait=False)
        workers.stop()


def _free_port(address: str) -> int:
    """A port nobody listens on: the allowed origins must name it before the server starts."""
    family = socket.AF_INET6 if ":" in address else socket.AF_INET
    with socket.socket(family) as probe:
        probe.bind((address, 0))
        return int(probe.getsockname()[1])


def _host(address: str) -> str:
    """An address as it stands in a URL."""
    return f"[{address}]" if ":" in address else address


def _origins(address: str, port: int, allowed: Sequence[str]) -> list[str]:
    """Loopback names always; an address that is a name of this machine as well."""
    hosts = {"127.0.0.1", "localhost"}
    try:
        everywhere = ipaddress.ip_address(address).is_unspecified
    except ValueError:
        everywhere = False
    if not everywhere:
        hosts.add(_host(address))
    return [*(f"{host}:{port}" for host in sorted(hosts)), *allowed]
