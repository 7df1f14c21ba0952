"""Logs for the operator: one line of JSON each, without contents of designs.

Of libraries' records only the template is kept, not what was put into it, and of an exception its kind and where it
was raised: texts of both may quote a design. Paths are logged without their query, which is a design's link.
"""

from __future__ import annotations

import hashlib
import json
import logging
import sys
import traceback
import warnings
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # a worker process reads this file too
    from tornado.web import RequestHandler

LOGGER = logging.getLogger("navbudget")
_LONGEST = 10_000  # characters of a record for a terminal


class JsonFormatter(logging.Formatter):
    """A record as one line of JSON."""

    def format(self, record: logging.LogRecord) -> str:
        """The record as a line of JSON, without what may quote a design."""
        entry: dict[str, Any] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
            "logger": record.name,
            "process": record.process,
        }
        if record.name == LOGGER.name:
            entry |= {"event": record.msg, **getattr(record, "fields", {})}
        else:
            entry |= {"at": f"{record.module}:{record.lineno}"}
            if record.args:  # with nothing put in, the text may already be filled out
                entry["template"] = str(record.msg)
        if record.exc_info and record.exc_info[0] is not None:
            frames = traceback.extract_tb(record.exc_info[2])
            entry |= {
                "exception": record.exc_info[0].__name__,
                "raised": [f"{frame.filename}:{frame.lineno} {frame.name}" for frame in frames[-5:]],
            }
        return json.dumps(entry, ensure_ascii=False)


class TextFormatter(logging.Formatter):
    """A record for a person at a terminal."""

    def format(self, record: logging.LogRecord) -> str:
        """The line, with its traceback if there is one; cut where a library quotes what somebody sent."""
        text = super().format(record)
        if len(text) > _LONGEST:
            text = f"{text[:_LONGEST]} ..."
        fields = getattr(record, "fields", {})
        return text + "".join(f" {key}={value}" for key, value in fields.items())


def set_up(kind: str) -> None:
    """Send the log of this process to standard error: ``json`` for every event, ``text`` for warnings only."""
    handler = logging.StreamHandler(sys.stderr)
    as_json = kind == "json"
    handler.setFormatter(
        JsonFormatter() if as_json else TextFormatter("%(asctime)s %(levelname)s %(name)s: %(message)s")
    )
    if as_json:
        warnings.showwarning = _warned  # type: ignore[assignment]
    root = logging.getLogger()
    root.handlers[:] = [handler]
    root.setLevel(logging.WARNING)
    LOGGER.setLevel(logging.INFO if as_json else logging.WARNING)
    for name in ("bokeh", "panel", "tornado"):  # they install their own handlers
        logger = logging.getLogger(name)
        logger.handlers[:] = []
        logger.propagate = True
        logger.setLevel(logging.WARNING)


def _warned(message: Warning | str, category: type[Warning], filename: str, lineno: int, *_: Any) -> None:
    event("warning", logging.WARNING, category=category.__name__, raised=f"{filename}:{lineno}")


def event(name: str, level: int = logging.INFO, **fields: Any) -> None:
    """Log something that happened."""
    LOGGER.log(level, name, extra={"fields": fields})


def short(session_id: str) -> str:
    """A session's name in the log: tells sessions apart, opens none."""
    return hashlib.sha256(session_id.encode()).hexdigest()[:12]


def request_done(handler: RequestHandler) -> None:
    """Tornado's access log: everything as JSON but the page's own scripts and fonts, only failures as text."""
    request, status = handler.request, handler.get_status()
    if request.path.startswith(("/liveness", "/metrics", "/static/")) and status < 400:
        return
    level = logging.ERROR if status >= 500 else logging.WARNING if status >= 400 else logging.INFO
    event(
        "request",
        level,
        method=request.method,
        path=request.path[:200],
        status=status,
        milliseconds=round(1000 * request.request_time(), 1),
        peer=request.remote_ip,
    )
