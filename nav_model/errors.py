"""Bad input, told once: the one exception that a person's input ends in."""

from __future__ import annotations

from typing import Any


class InputError(ValueError):
    """Bad input, with the key it stands under.

    Attributes
    ----------
    key : str
        Dotted key such as ``"imu.angle_random_walk"``, or the file's name when no key is to blame.
    reason : str
        What was given and what is allowed.
    """

    def __init__(self, key: str, reason: str) -> None:
        super().__init__(f"{key}: {reason}")
        self.key = key
        self.reason = reason

    def __reduce__(self) -> tuple[type[InputError], tuple[str, str]]:
        """So that it comes back whole from a worker process."""
        return type(self), (self.key, self.reason)


def shown(content: Any) -> str:
    """What was given, short enough for a one-line message, however long or deep it is."""
    try:
        text = repr(content)
    except (RecursionError, ValueError):  # nested too deeply; an integer with too many digits to print
        return f"what is given ({type(content).__name__})"
    return text if len(text) <= 60 else text[:57] + "..."
