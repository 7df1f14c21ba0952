"""A server that stops listening finishes the responses in progress."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from bokeh.server.server import BaseServer

from app.upstream.listening import let_nobody_new_in


def _done(stop: Callable[[Any], None]) -> list[str]:
    """What becomes of a server's connections."""
    done: list[str] = []

    async def cut() -> None:
        done.append("cut")

    async def run() -> None:
        loop = asyncio.get_running_loop()
        server = BaseServer.__new__(BaseServer)
        server._http = SimpleNamespace(stop=lambda: done.append("closed"), close_all_connections=cut)  # type: ignore[assignment]
        server._loop = SimpleNamespace(add_callback=lambda work: loop.create_task(work()))  # type: ignore[assignment]
        stop(server)
        await asyncio.sleep(0)
        await asyncio.sleep(0)

    asyncio.run(run())
    return done


def test_as_shipped_open_connections_are_cut() -> None:
    assert _done(BaseServer.unlisten) == ["closed", "cut"]


def test_they_stay_open() -> None:
    assert _done(let_nobody_new_in) == ["closed"]
