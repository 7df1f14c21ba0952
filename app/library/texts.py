"""Cleans user texts for storage: limited in length, the same on every database, no invisible characters.

Markup is kept as it is and escaped where a text is shown.
"""

import unicodedata

from nav_model.base.errors import InputError

LIMITS = {"name": 200, "author": 100, "note": 4000, "tag": 40, "title": 200, "comment": 4000, "reason": 1000}
"""The longest text of each kind, in characters."""

_ASKED = {"author": "Enter your name.", "reason": "Enter a reason.", "comment": "Enter a comment."}
_LINES = {"note", "comment", "reason"}  # kinds that may have several lines
_BIDI = {*range(0x202A, 0x202F), *range(0x2066, 0x206A)}
TAGS = 20
"""The most tags one design may carry."""


def clean(kind: str, text: str, *, required: bool = False) -> str:
    """A text of one of the kinds of `LIMITS`, trimmed.

    Control characters, which PostgreSQL or a terminal would not take, become their visible pictures (NUL is ␀);
    marks that turn the direction of writing, which make one text look like another, become U+FFFD.

    Raises
    ------
    InputError
        Naming the kind: too long, missing though required, or not Unicode text.
    """
    text = text.replace("\r\n", "\n").strip()
    if len(text) > LIMITS[kind]:
        raise InputError(kind, f"{len(text)} characters are too many: at most {LIMITS[kind]} are kept.")
    if required and not text:
        raise InputError(kind, _ASKED.get(kind, f"Enter a {kind}."))
    try:
        text.encode()
    except UnicodeEncodeError as error:
        raise InputError(kind, f"{text[:60]!r} is not Unicode text") from error
    return "".join(_sign(sign, kind) for sign in text)


def _sign(sign: str, kind: str) -> str:
    code = ord(sign)
    if sign == "\n" and kind in _LINES:
        return sign
    if code in _BIDI:
        return "\ufffd"
    if unicodedata.category(sign) != "Cc":
        return sign
    return chr(0x2400 + code) if code < 0x20 else "\u2421" if code == 0x7F else "\ufffd"


def clean_tags(text: str) -> tuple[str, ...]:
    """Tags from a line of them, separated by commas: lower case, each once, in order.

    Raises
    ------
    InputError
        For a tag too long or too many tags.
    """
    tags = tuple(sorted({tag for part in text.split(",") if (tag := clean("tag", part).lower())}))
    if len(tags) > TAGS:
        raise InputError("tag", f"{len(tags)} tags; at most {TAGS} are kept")
    return tags


def moment(stamp: str | None) -> str:
    """A date of the library in readable form."""
    return f"{stamp[:10]} {stamp[11:16]} UTC" if stamp else ""


def counted(number: int, thing: str) -> str:
    """A count with its noun, such as "2 designs"."""
    return f"{number} {thing}{'' if number == 1 else 's'}"
