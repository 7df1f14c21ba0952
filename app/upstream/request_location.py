"""A page opens at every address that a browser may send.

Panel takes the address of a request apart at each ":" and "?": an IPv6 host, or a second "?" in a query, ends in an
exception while the session is made, and the visitor sees an empty page.

Written for: Panel 1.9.4
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_request_location.py::test_as_shipped_some_addresses_are_a_fault fails
"""

from __future__ import annotations

from urllib.parse import urlsplit

import panel.io.location


def _params(protocol: str | None, host: str | None, uri: str | None) -> dict[str, str]:
    href = (f"{protocol}:" if protocol else "") + (f"//{host}" if host else "") + (uri or "")
    # A request's path never has the host in it; "//a" would be taken for one.
    at = urlsplit(f"//{host or ''}")
    path, _, search = (uri or "").partition("?")
    found = {"protocol": f"{protocol}:" if protocol else "", "hostname": at.hostname or "", "href": href,
             "port": str(at.port or ""), "pathname": path, "search": f"?{search}" if search else ""}  # fmt: skip
    return {name: value for name, value in found.items() if value}


def read_any_address() -> None:
    """Install the override; the server calls it once, before it serves."""
    panel.io.location._get_location_params = _params
