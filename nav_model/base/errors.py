"""The one exception for bad input."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

_LONGEST_KEY, _LONGEST_REASON, _LONGEST_CAUSE = 200, 1000, 120


class InputError(ValueError):
    """Bad input. Its message is ``key: reason``; both parts and the value are fields.

    Of a longer reason than 1000 characters, which a file has written, and of a longer key than 200, the middle is
    left out.

    Parameters
    ----------
    key : str
        Dotted key such as ``"imu.angle_random_walk"``, or the name of the option or file that is to blame.
    reason : str
        A sentence without the key: what is wrong and what is allowed.
    value : object, optional
        What was given, as it was given; None when nothing was, or when it is too large to quote, such as a file.

    Examples
    --------
    >>> error = InputError("imu.rate", "'fast' is not a number", "fast")
    >>> str(error), error.value
    ("imu.rate: 'fast' is not a number", 'fast')
    """

    def __init__(self, key: str, reason: str, value: object = None) -> None:
        key, reason = _shortened(key, _LONGEST_KEY), _shortened(reason, _LONGEST_REASON)
        super().__init__(f"{key}: {reason}")
        self.key = key
        self.reason = reason
        self.value = value

    def __reduce__(self) -> tuple[type[InputError], tuple[str, str, object]]:
        """Keep all fields when sent from a worker process."""
        return type(self), (self.key, self.reason, self.value)

    def under(self, key: str) -> InputError:
        """Copy of the error under another name, such as a command-line option or a file."""
        return type(self)(key, self.reason, self.value)


@contextmanager
def under(key: str) -> Iterator[None]:
    """Re-raise an `InputError` from the block with its key replaced by `key`."""
    try:
        yield
    except InputError as error:
        raise error.under(key) from error


def not_a_choice(given: Any, options: Iterable[object]) -> str:
    """The reason for a name that is not among the allowed ones.

    >>> not_a_choice("kaiser", ["uniform", "hamming", "taylor"])
    "'kaiser' is not a choice here. Choose uniform, hamming or taylor."
    """
    *most, last = map(str, options)
    either = f"{', '.join(most)} or {last}" if most else last
    return f"{quoted(given)} is not a choice here. Choose {either}."


def _shortened(text: str, most: int) -> str:
    return text if len(text) <= most else f"{text[: most // 2]} ... {text[-most // 4 :]}"


def quoted(content: Any) -> str:
    """Quote a value, short enough for a one-line message, however long or deep it is."""
    try:
        text = repr(content)
    except (RecursionError, ValueError):  # nested too deeply; an integer with too many digits to print
        return f"what is given ({type(content).__name__})"
    return text if len(text) <= 60 else text[:57] + "..."


def reason_of(error: Exception) -> str:
    """The message of a library's error on one line: of more than 120 characters, which a file has written, the middle
    is left out.

    >>> reason_of(LookupError("unknown encoding: utf-9"))
    'unknown encoding: utf-9'
    """
    return _shortened(" ".join(str(error).split()), _LONGEST_CAUSE)
