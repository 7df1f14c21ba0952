"""pyulog's reader of PX4 logs with bounds on messages and fields, which it has not.

370 bytes of formats within formats make it take 3 GB. Report to send upstream, version and end:
docs/upstream/bounded_ulog.md
"""

import io
from collections.abc import Mapping
from typing import Any

from nav_model.trajectory.files.heights import Heights

_SHORTEST = 20  # bytes of a message on average
_MOST_FIELDS = 200_000  # of all topics, with those of the formats within formats


class Messages(io.BytesIO):
    """A log that refuses more messages than one of its size has: pyulog reads each for itself."""

    def __init__(self, content: bytes, heights: Heights) -> None:
        super().__init__(content)
        self._heights, self._reads = heights, 2 * (len(content) // _SHORTEST + 10_000)

    def read(self, size: int | None = -1, /) -> bytes:
        """A head or a body of at most `size` bytes; InputError under the file's name after too many."""
        self._reads -= 1
        if self._reads < 0:
            raise self._heights.refuse("is a PX4 log (ULog) that is damaged: most of its messages are empty")
        return super().read(size)


def bounded(reader: Any) -> Any:
    """The class `reader`, pyulog's `ULog`, with a bound on fields, as formats within formats grow with the power of
    their depth. Reading raises RecursionError beyond it: pyulog passes over other errors of a message."""
    fields = 0

    class Added(reader._MessageAddLogged):  # type: ignore[misc]
        def _parse_nested_type(self, prefix: str, name: str, formats: Mapping[str, Any]) -> None:
            nonlocal fields
            fields += 1 + sum(max(size, 1) for _, size, _ in formats[name].fields)
            if fields > _MOST_FIELDS:
                raise RecursionError(f"its topics have more than {_MOST_FIELDS} fields")
            super()._parse_nested_type(prefix, name, formats)

    return type("Bounded", (reader,), {"_MessageAddLogged": Added})
