"""Addresses that Panel stumbles at as shipped. Of the plain ones both say the same."""

from __future__ import annotations

import pytest
from panel.io import location

from app.upstream.requests import _params

_SHIPPED = location._get_location_params


@pytest.mark.parametrize(("host", "uri"), [("[::1]:5006", "/"), ("a", "/?b=c?d")])
def test_as_shipped_some_addresses_are_a_fault(host: str, uri: str) -> None:
    with pytest.raises(ValueError, match="too many values"):
        _SHIPPED("http", host, uri)
    found = _params("http", host, uri)
    assert found["href"] == f"http://{host}{uri}"
    assert found["pathname"] == "/"
    assert found.get("search", "") == uri[1:]


@pytest.mark.parametrize("host", ["127.0.0.1:5006", "server.example"])
@pytest.mark.parametrize("uri", ["/", "/?f=9GHz", "/ws?f=9GHz&arw=0.5deg/sqrt(h)"])
def test_plain_addresses_are_as_ever(host: str, uri: str) -> None:
    assert _params("https", host, uri) == _SHIPPED("https", host, uri)
