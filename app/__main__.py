"""The way into the command `navbudget`: `python -m app` or the script of that name.

To load the command takes most of a second. A signal that arrives meanwhile, or once the command has ended, ends the
process at once: nothing has been begun, or everything is done. What it does in between, `app.console.ending` says.
"""

from __future__ import annotations

import os
import signal
import sys
from typing import Any


def main() -> int:
    """Run the command; returns its exit code."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _end)
    from app.cli import main as command

    return command()


def _end(number: int, _: Any) -> None:
    word = "interrupted" if number == signal.SIGINT else "terminated"
    os.write(2, f"navbudget: {word}\n".encode())
    os._exit(128 + number)


if __name__ == "__main__":
    sys.exit(main())
