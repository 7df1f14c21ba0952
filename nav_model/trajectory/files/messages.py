"""Recordings of receivers and autopilots as messages: NovAtel, NMEA and PX4, told by what they hold."""

from nav_model.trajectory.files import nmea, novatel, ulog
from nav_model.trajectory.files.epochs import Epochs
from nav_model.trajectory.files.heights import Heights

PLACE_MESSAGES = ("POS", "GPS", "AHR2")
"""Messages of a text dump (DataFlash) that have places, the one that is taken first before the others."""
_START = 65_536  # bytes


def read_messages(content: bytes, heights: Heights) -> Epochs | None:
    """The epochs of a recording; None where the content is none of these.

    Raises InputError under the file's name where it has no places.
    """
    if content.startswith(ulog.SIGNATURE):
        return ulog.read_ulog(content, heights)
    start = content[:_START]
    if novatel.NAMES.search(start):
        return novatel.read_novatel(content, heights)
    return nmea.read_nmea(content, heights) if nmea.NAMES.search(start) else None
