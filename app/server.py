"""The served app: one page a session, built from the link it was opened with."""

from __future__ import annotations

import socket
from importlib.resources import files
from typing import Any

import panel as pn

from app.page import Frame, is_review_link
from app.state import Session
from nav_model.design import Design
from nav_model.design_file import parse_design
from nav_model.inputs import DesignError
from nav_model.link import from_query

_LOOPBACK = {"127.0.0.1", "localhost", "::1"}


def first_design() -> Design:
    """What a visitor without a link sees: a real inertial unit under a real radar."""
    text = files("app").joinpath("first_design.toml").read_text(encoding="utf-8")
    return parse_design(text, "first design")


def build() -> Any:
    """The page of one session. A link that is wrong is said so on the page, which opens all the same."""
    design, notice = first_design(), ""
    query = pn.state.location.search if pn.state.location else ""
    if query and not is_review_link(query):
        try:
            design = from_query(query)
        except DesignError as error:
            notice = f"The link was not used. {error}"
    try:
        session = Session(design)
    except DesignError as error:
        session, notice = Session(first_design()), f"The link was not used. {error}"
    return Frame(session, notice).view


def serve(address: str, port: int, allow_origin: list[str]) -> None:
    """Serve until stopped; prints the address.

    Parameters
    ----------
    address, port
        To listen on.
    allow_origin : list of str
        Public hosts (``host`` or ``host:port``) under which browsers reach the page, beside the address.
    """
    pn.extension("tabulator")
    port = port or _free_port(address)
    server = pn.serve(
        {"/": build},
        address=address,
        port=port,
        title="NavBudget",
        show=False,
        start=False,
        verbose=False,
        liveness=True,
        websocket_origin=_origins(address, port, allow_origin),
    )
    Frame(Session(first_design()))  # the first visitor should not wait for what Python loads late
    print(f"NavBudget on http://{address}:{port}", flush=True)
    server.run_until_shutdown()


def _free_port(address: str) -> int:
    """A port nobody listens on: the allowed origins must name it before the server starts."""
    with socket.socket() as probe:
        probe.bind((address, 0))
        return int(probe.getsockname()[1])


def _origins(address: str, port: int, allowed: list[str]) -> list[str]:
    """Loopback names always; an address that is a name of this machine as well."""
    hosts = {"127.0.0.1", "localhost"} | ({address} - _LOOPBACK - {"0.0.0.0", "::"})
    return [*(f"{host}:{port}" for host in sorted(hosts)), *allowed]
