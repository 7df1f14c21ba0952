"""Reads TOML: data files of the product, and text from others, with its size limited before it is parsed.

Python's parser takes memory and time as the square of the number of parts of a key: one of 15,000 dots needs a
gigabyte. Nesting, keys and parts of keys are therefore counted first, in one pass in linear time.

Memory is at most 50 times the text's, time a second a megabyte; tests/nav_model/base/text/test_toml_text.py holds
hostile texts to both.
"""

import re
import tomllib
from importlib.resources import files
from typing import Any

from nav_model.base.errors import InputError, reason_of

MOST_PARTS = 8
"""Parts of one dotted key; what this program reads has three."""
MOST_DEPTH = 8
"""Brackets and braces inside one another."""
MOST_KEYS = 10_000
"""Keys and tables of one text; a design has a hundred, a catalogue of one's own twenty an entry."""
MOST_VALUES = 100_000
"""Values in lists."""

# Strings and comments, whose dots and brackets mean nothing. One that is not closed goes on all the same, so that
# every sign is looked at once.
_QUOTED = re.compile(
    r'"""(?:[^"\\]++|\\.?|"{1,2}(?!"))*+"{0,5}|'
    r"'''(?:[^']++|'{1,2}(?!'))*+'{0,5}|"
    r'"(?:[^"\\\n]++|\\[^\n]?)*+"?|'
    r"'[^'\n]*+'?|"
    r"\#[^\n]*+",
    re.DOTALL,
)
_BRACKETS = {"[": 1, "{": 1, "]": -1, "}": -1}


def shipped(package: str, name: str) -> dict[str, Any]:
    """A data file of the product's own, beside the code of a package."""
    return tomllib.loads(files(package).joinpath(f"{name}.toml").read_text(encoding="utf-8"))


def read_toml(data: bytes | str, where: str, kind: str, most_bytes: int) -> dict[str, Any]:
    """The tables of a text.

    Parameters
    ----------
    data : bytes or str
        The text, in UTF-8 if bytes.
    where : str
        The file's name, for messages.
    kind : str
        What it should have been, such as "a design file", for messages.
    most_bytes : int
        The longest text taken.

    Raises
    ------
    InputError
        Under `where`: too long, not UTF-8, nested too deeply, too many keys or values, or not TOML (the parser's own
        error is its cause). Under the first two parts of a key: it has too many.

    Examples
    --------
    >>> read_toml("[imu]\\nrate = '100 Hz'", "a.toml", "a design file", 1000)
    {'imu': {'rate': '100 Hz'}}
    """
    if len(data) > most_bytes:
        raise InputError(where, f"larger than {_size(most_bytes)}; not {kind}")
    if isinstance(data, bytes):
        try:
            data = data.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise InputError(where, f"not a text file (byte {error.start} is not UTF-8)") from error
    _check(data, where, kind)
    try:
        return tomllib.loads(data)
    except (ValueError, RecursionError) as error:  # also an integer or a date beyond what Python reads
        raise InputError(where, f"not {kind} (TOML): {reason_of(error).partition(';')[0]}") from error


def _size(count: int) -> str:
    return f"{count // 1_000_000} MB" if count >= 1_000_000 else f"{count // 1000} kB"


def _check(text: str, where: str, kind: str) -> None:
    """Refuse more keys, parts or nesting than allowed."""
    bare = _QUOTED.sub("_", text).translate({ord(" "): None, ord("\t"): None})
    for part in re.split(r"[\n=\[\]{},]", bare):
        if part.count(".") >= MOST_PARTS:
            key = ".".join(part.split(".", 2)[:2])[:60]
            raise InputError(key, f"a key of {part.count('.') + 1} parts; {kind} has none of more than {MOST_PARTS}")
    depth = deepest = 0
    for sign in re.findall(r"[\[\]{}]", bare):
        depth += _BRACKETS[sign]
        deepest = max(deepest, depth)
    if deepest > MOST_DEPTH:
        raise InputError(where, f"not {kind}: nested more than {MOST_DEPTH} deep")
    for count, most, what in (
        (bare.count("=") + bare.count("\n["), MOST_KEYS, "keys"),
        (bare.count(","), MOST_VALUES, "values"),
    ):
        if count > most:
            raise InputError(where, f"not {kind}: more than {most} {what}")
