"""The bound on fields of a PX4 log, and what pyulog does without it."""

import io

import pytest

from nav_model.trajectory.files.bounded_ulog import bounded

pyulog = pytest.importorskip("pyulog", reason="pyulog (the extra ulog) is not installed")


def log(depth, count):
    """A log whose one topic has `count` times 10 ** (depth + 1) numbers and a time."""
    head = b"ULog" + bytes((1, 18, 53, 1)) + bytes(8)
    formats = [(b"F", b"l0:float[10] a;"), *((b"F", b"l%d:l%d[10] a;" % (n, n - 1)) for n in range(1, depth + 1))]
    topic = (b"F", b"topic:uint64_t timestamp;l%d[%d] a;" % (depth, count)), (b"A", b"...topic")
    messages = (*formats, *topic)
    return io.BytesIO(head + b"".join(len(body).to_bytes(2, "little") + kind + body for kind, body in messages))


def fields(bound, depth, count):
    """How many fields the topic of such a log has, as pyulog unfolds it."""
    counts = []

    class Added(pyulog.ULog._MessageAddLogged):
        def __init__(self, *message):
            super().__init__(*message)
            counts.append(len(self.field_data))

    bound(type("Counted", (pyulog.ULog,), {"_MessageAddLogged": Added}))(log(depth, count))
    return counts


def test_as_shipped_formats_within_formats_have_no_bound():
    assert fields(lambda reader: reader, 4, 3) == [300_001]


def test_formats_within_formats_have_a_bound():
    assert fields(bounded, 3, 3) == [30_001]
    with pytest.raises(RecursionError, match="more than 200000 fields"):
        fields(bounded, 4, 3)
