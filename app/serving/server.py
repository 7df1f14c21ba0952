"""The served app: one page a session, built from the link it was opened with."""

import asyncio
import os
import secrets
import signal
import time
from collections.abc import Callable
from functools import partial
from importlib import import_module
from importlib.resources import files
from typing import Any

import panel as pn
from bokeh.document import Document
from bokeh.settings import settings
from panel.io.state import set_curdoc

from app.dashboard.frame import Frame, is_review_link
from app.dashboard.opening import OPENING_SCRIPT, OPENING_SHEET
from app.document.display import display_of
from app.serving.access import PasswordProvider, provider_of
from app.serving.address import SharedSocket, announce, listen, origins
from app.serving.board import BoardRow, SharedMetrics
from app.serving.collector import Collector, settle
from app.serving.handlers import (
    RequestContext,
    around,
    being_sent,
    close_door,
    handle_page_fault,
    hang_up_on_ended_logins,
)
from app.serving.hosts import Hosts, first_rules
from app.serving.logs import event, request_done, set_up, short
from app.serving.metrics import ServerMetrics
from app.serving.packed import packed_files
from app.serving.rules import Rules
from app.session import Session, link_parts
from app.subjects import SUBJECTS, TABS
from app.ui.defaults import set_defaults
from app.ui.remembered import DISPLAY_COOKIE, NAME_COOKIE, login, recalled
from app.upstream.connection import keep_first_changes, send_in_order, write_once
from app.upstream.fonts import load_fonts_by_need
from app.upstream.late_session import page_of, sheets_from_here, visitor
from app.upstream.rendering import check_given_values
from app.upstream.requests import ask_first, listen_on, read_any_address, stop_accepting, trust_proxies_only
from app.upstream.sent_back import expect_known_models
from app.work import pool as workers
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.file import parse_design
from nav_model.design.link import from_query

_TITLE = "NavBudget"
_VIEWPORT = '<meta name="viewport" content="width=device-width, initial-scale=1">'
"""Before any script asks for the width of the window: a phone would say that of a desk."""
COMPONENTS = (
    "app.ui.anchored_text", "app.ui.decision_table", "app.ui.row_editor",
    "app.ui.fields", "app.ui.sortable_table", "app.ui.verdict_switch", "app.upstream.file_input",
)  # fmt: skip
"""Modules with parts for the browser that pages load late. They are imported before anybody comes: Panel makes a part
that one visitor's tab is the first to import known to one open page, and every other page breaks on it."""
_MAX_BODY = 65_536  # of a posted form; files travel over the page's own connection
_MAX_HEADER = 65_536  # a design as a link is far shorter
_SLOWEST = 20.0  # seconds for a request's headers, for its body, and between two requests of a connection
_TELL = 0.5  # seconds
_REST = 1.0  # seconds
_LAST_LOOKS = 20  # for results to reach the pages once all work has ended, 50 ms and more between two


def first_design() -> Design:
    """The first design of a visitor without a link: a real inertial unit and a real radar."""
    text = files("app").joinpath("examples/mems_x_band.toml").read_text(encoding="utf-8")
    return parse_design(text, "first design")


def build(changed: Callable[[Any], None] | None = None) -> Any:
    """The page of one session; ``changed`` is called with every new budget.

    A wrong link is reported on the page, which opens all the same.
    """
    design, notice = first_design(), ""
    query = pn.state.location.search if pn.state.location else ""
    of_design, of_study, display = link_parts(query)
    if of_design and not is_review_link(query):
        try:
            design = from_query(of_design)
        except InputError as error:
            notice = f"The link was not used. {error}"
    try:
        session = Session(design)
    except InputError as error:
        session, notice = Session(first_design()), f"The link was not used. {error}"
    session.take_studies(of_study)
    session.author = login() or recalled(NAME_COOKIE)
    try:
        session.display = display_of(display or recalled(DISPLAY_COOKIE)).word
    except InputError as error:
        notice = notice or (f"The link was not used whole. {error}" if display else "")
    if changed is not None:
        session.param.watch(changed, "budget")
    return Frame(session, notice).__panel__()


def serve(rules: Rules) -> None:
    """Serve from this process until stopped by SIGTERM or SIGINT; prints the address.

    Raises
    ------
    InputError
        If the rules contradict each other, or the address cannot be listened on.
    """
    rules.check()
    listening, port = listen(rules)
    set_up(rules.log)
    row = BoardRow(SharedMetrics())

    def ready() -> None:
        row.put("ready", 1)
        announce(rules, port)

    serve_on(SharedSocket(listening, row), port, rules, row, secrets.token_bytes(32), ready)
    event("stopped")


def serve_on(
    listening: SharedSocket, port: int, rules: Rules, row: BoardRow, secret: bytes, ready: Callable[[], None]
) -> None:
    """Serve from this process on a socket that listens already, until stopped; ``ready`` is called once visitors can
    come. The secret signs sessions: processes that share the socket share it too.

    Raises
    ------
    InputError
        If the password file cannot be read or is wrong.
    """
    pn.extension(exception_handler=handle_page_fault)
    set_defaults()
    settings.perform_error_diagnostics = False  # Panel asks models for what they lack; no guess at what was meant
    settings.simple_ids = True  # as it is unless said; said, it is not looked up anew for each id
    settings.perform_document_validation = False  # warns of empty layouts, at each look at a document
    send_in_order()
    write_once()
    keep_first_changes()
    read_any_address()
    check_given_values()
    expect_known_models()
    load_fonts_by_need()
    trust_proxies_only()
    for name in COMPONENTS:
        import_module(name)
    workers.use(rules.workers, row.board.processes, partial(set_up, rules.log), visitor)
    began, collector, loaded = time.monotonic(), Collector(), asyncio.Event()
    listen_on(listening, port)
    access = provider_of(rules)
    provider = access.get("auth_provider")
    here = RequestContext(
        row, rules.max_sessions, rules.max_message, page=opening_page(), heard=collector.heard, keep=listening.keep,
        admits=rules.oauth.admits if rules.oauth else lambda _: True,
        still_in=provider.still_in if isinstance(provider, PasswordProvider) else lambda _: True,
    )  # fmt: skip
    metrics = ServerMetrics(row.board, rules.max_sessions, lambda: time.monotonic() - began)
    server = pn.serve(
        {"/": lambda: _counted(row, collector, loaded)},
        address=rules.address,
        port=port,
        title=_TITLE,
        show=False,
        start=False,
        verbose=False,
        websocket_origin=origins(rules.address, port, rules.allow_origin),
        websocket_max_message_size=rules.max_message,
        websocket_compression_level=3,  # of a page's first message: `app.upstream.connection`
        http_server_kwargs={
            "max_body_size": _MAX_BODY,
            "max_header_size": _MAX_HEADER,
            "idle_connection_timeout": _SLOWEST,
            "body_timeout": _SLOWEST,
        },
        use_xheaders=rules.behind_proxy,
        sign_sessions=True,  # a session that was not issued cannot be opened
        secret_key=secret,
        unused_session_lifetime_milliseconds=round(1000 * rules.session_lifetime),
        check_unused_sessions_milliseconds=min(10_000, round(500 * rules.session_lifetime)),
        log_function=request_done,
        **access,
        **around(rules, here, metrics),
    )
    ask_first(server, [*first_rules(Hosts(rules.address, rules.allow_origin)), *packed_files()])
    settle()
    row.put("pid", os.getpid())
    ready()
    _run(server, rules.grace, collector, row, loaded)


def opening_page() -> Callable[[str, bool], str]:
    """The page that a browser loads before it connects, from the session's token and the dark-mode flag; built
    once."""
    document = Document()
    with set_curdoc(document):
        build().server_doc(document, _TITLE)
    light = page_of(document, _TITLE)

    def page(token: str, dark: bool) -> str:
        scheme = '<meta name="color-scheme" content="dark">' if dark else ""  # dark while it loads
        first = f"<head>{_VIEWPORT}{scheme}<style>{OPENING_SHEET}</style><script>{OPENING_SCRIPT}</script>"
        return light(token).replace("<head>", first, 1)

    return page


def _counted(row: BoardRow, collector: Collector, loaded: asyncio.Event) -> Any:
    """`build` with metrics and logs of sessions and computed budgets."""
    row.add("opened")
    row.add("sessions")
    sheets_from_here(pn.state.curdoc)
    collector.heard()
    name = short(pn.state.curdoc.session_context.id)
    event("session opened", session=name)

    def closed(_: Any) -> None:
        event("session closed", session=name)
        collector.page_closed()

    pn.state.on_session_destroyed(closed)
    pn.state.onload(loaded.set)
    return build(lambda _: row.add("events"))


async def _prepare(loaded: asyncio.Event) -> None:
    """Do what subjects prepare, a second after the first page has loaded, which then has its lower half too."""
    await loaded.wait()
    await asyncio.sleep(_REST)
    for subject in SUBJECTS:
        if subject.ahead:
            for tab in TABS:
                if tab.page.partition(".")[0] == subject.key:
                    await asyncio.to_thread(tab.load)
            await subject.load("ahead")(first_design())


def _run(server: Any, grace: float, collector: Collector, row: BoardRow, loaded: asyncio.Event) -> None:
    """Run until stopped: then no new session starts, heavy work may finish and reach its page, and everything is
    closed.

    A second signal does not wait.
    """
    loop = server.io_loop.asyncio_loop
    stopping: list[asyncio.Task[None]] = []

    async def wind_down() -> None:
        stop_accepting(server)
        close_door()
        deadline = loop.time() + grace
        quiet = 0  # looks in a row that found nothing; not seconds, in which a busy machine may do nothing
        while quiet < _LAST_LOOKS and loop.time() < deadline:
            quiet = 0 if workers.under_way() or being_sent() else quiet + 1
            await asyncio.sleep(0.05)
        server.io_loop.stop()

    def on_signal() -> None:
        ahead.cancel()
        event("stopping", under_way=workers.under_way())
        if stopping:
            server.io_loop.stop()
        else:
            stopping.append(loop.create_task(wind_down()))

    server.start()
    ahead = loop.create_task(_prepare(loaded))
    aside = [ahead, loop.create_task(collector.run()), loop.create_task(_tell(server, row))]
    for signal_number in (signal.SIGTERM, signal.SIGINT):
        loop.add_signal_handler(signal_number, on_signal)
    try:
        server.io_loop.start()
    finally:
        for task in aside:
            task.cancel()
        server.stop(wait=False)
        workers.stop()


async def _tell(server: Any, row: BoardRow) -> None:
    """Update this process's counters and close the pages of ended logins, until cancelled."""
    while True:
        row.put("sessions", len(server.get_sessions()))
        row.put("heavy", workers.under_way())
        await hang_up_on_ended_logins()
        await asyncio.sleep(_TELL)
