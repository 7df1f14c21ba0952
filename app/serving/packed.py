"""Static files compressed once: over a slow line, a first visit takes a quarter of what the files are.

A text is compressed when it is first asked for and kept in memory, for all visitors of this process. What has its
hash in its address stays with the browser.
"""

import gzip
import re
from datetime import datetime
from functools import lru_cache
from pathlib import Path

from bokeh.embed.bundle import extension_dirs
from bokeh.server.views.multi_root_static_handler import MultiRootStaticHandler
from bokeh.server.views.static_handler import StaticHandler
from tornado.routing import PathMatches, Rule
from tornado.web import StaticFileHandler

_TEXTS = (".js", ".mjs", ".css", ".svg", ".json")
_LEAST, _MOST = 1000, 5_000_000  # bytes: less gains nothing, and the largest bundle has 1.4 million
_KEPT = 100  # files
_HASHED = re.compile(r"-[A-Z0-9]{8}\.\w+$")


@lru_cache(maxsize=_KEPT)
def _packed(path: str, _: datetime | None) -> bytes | None:
    """The file compressed; None where that gains nothing."""
    file = Path(path)
    if not _LEAST <= file.stat().st_size <= _MOST:
        return None
    return gzip.compress(file.read_bytes(), 9, mtime=0)


class _Packed(StaticFileHandler):
    """Sends a text compressed to a browser that takes it so; parts of a file as they are."""

    def set_extra_headers(self, path: str) -> None:
        """As Tornado, which calls this before it looks at size and content."""
        super().set_extra_headers(path)
        if not path.endswith(_TEXTS) or self.absolute_path is None:
            return
        self.set_header("Vary", "Accept-Encoding")
        taken = "gzip" in self.request.headers.get("Accept-Encoding", "") and "Range" not in self.request.headers
        content = _packed(self.absolute_path, self.modified) if taken else None
        if content is not None:
            self.set_header("Content-Encoding", "gzip")
            self.get_content_size = lambda: len(content)  # type: ignore[method-assign]
            self.get_content = lambda *_: content  # type: ignore[method-assign, assignment]

    def compute_etag(self) -> str | None:
        """A weak one: the same for a file and for what is made of it."""
        etag = super().compute_etag()
        return etag and f"W/{etag}"

    def get_cache_time(self, path: str, modified: datetime | None, mime_type: str) -> int:
        """Ten years for an address with a hash."""
        hashed = bool(self.request.query) or _HASHED.search(path)
        return self.CACHE_MAX_AGE if hashed else super().get_cache_time(path, modified, mime_type)


class _Extensions(_Packed, MultiRootStaticHandler):
    """Files of Panel and its components."""


class _Bokeh(_Packed, StaticHandler):
    """Files of Bokeh."""


def packed_files() -> list[Rule]:
    """The routes to static files, which come before Bokeh's own."""
    return [
        Rule(PathMatches(r"/static/extensions/(.*)"), _Extensions, {"root": extension_dirs}),
        Rule(PathMatches(r"/static/(.*)"), _Bokeh),
    ]
