"""Entry point of the command `navbudget`: `python -m app` or the script of that name.

Loading the command takes most of a second. A signal before or after the command runs ends the process at once;
`app.console.ending` handles signals while it runs.

OpenBLAS gets one thread, here and in every process started from here, unless the environment says otherwise: it reads
that as NumPy is loaded. The product solves many small systems, where waking a second thread takes longer than the
work: a map over the aperture takes 1.5 s so, and 5 to 27 s with two threads.
"""

import os
import signal
import sys
from typing import Any


def main() -> int:
    """Run the command; returns its exit code."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
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
