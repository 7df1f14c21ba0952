"""Early ends of a command: by a signal, or by a fault of the system."""

import errno
import io
import os
import signal
import stat
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor
from contextlib import contextmanager, suppress
from typing import Any, TextIO, cast

from nav_model.base.errors import InputError, quoted
from nav_model.base.processes import kill_workers

DONE, OPEN, BAD_INPUT, SURROUNDINGS, OWN_FAULT = 0, 1, 2, 3, 4
"""Exit codes: done or closes, does not close, bad input, a fault of the surroundings, a fault of NavBudget's own."""

_SURROUNDINGS = {errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.ENOMEM, errno.EMFILE, errno.ENFILE, errno.EFBIG}
_WORDS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}


class Stopped(KeyboardInterrupt):
    """A signal told the command to stop; ``number`` is the signal's."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def is_of_surroundings(fault: OSError) -> bool:
    """True if the system is the cause and not the input: disk full, out of files or memory."""
    return fault.errno in _SURROUNDINGS


def run_to_end(command: Callable[[], int]) -> int:
    """Run a command and flush its output; returns the exit code, with a line on standard error for any fault.

    SIGINT and SIGTERM end the worker processes, with what waits for them, and unwind the command, so that nothing
    half written stays; the code is 128 plus the signal's number. A reader that leaves early (`| head`) is no fault; a
    pipe that nobody reads is one, shown by the code alone. Writing to a closed standard
    output is a fault.
    """
    _open_streams()
    taken = _count_what_is_read()
    try:
        with _stoppable():
            code = command()
            sys.stdout.flush()
            return code
    except Stopped as stop:
        return _report(_WORDS.get(signal.Signals(stop.number), "stopped"), 128 + stop.number)
    except InputError as error:
        return refuse(error)
    except BrokenPipeError:
        return DONE if taken and taken.bytes else SURROUNDINGS
    except OSError as fault:
        full = fault.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)  # files of ours have their name
        where = quoted(fault.filename) + ": " if fault.filename else "standard output: " if full else ""
        return _report(f"{where}{fault.strerror or fault}", SURROUNDINGS)
    except MemoryError:
        return _report("this machine has too little free memory", SURROUNDINGS)
    except BrokenExecutor:
        return _report("something ended a worker process, perhaps a lack of memory", SURROUNDINGS)
    except Exception:  # noqa: BLE001  # the last resort, told in full
        traceback.print_exc()
        return _report("this is a fault in NavBudget; the lines above show where", OWN_FAULT)
    finally:
        _let_go()


def refuse(error: InputError) -> int:
    """Print bad input in one line; returns the exit code."""
    return _report(str(error), BAD_INPUT)


def one_line(text: str) -> str:
    """A text on one line: line ends, control characters and invalid text are escaped.

    >>> one_line("a\\nb.toml")
    'a\\\\nb.toml'
    """
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def _report(text: str, code: int) -> int:
    if text:
        with suppress(OSError, ValueError):
            print(f"navbudget: {one_line(text)}", file=sys.stderr, flush=True)
    return code


def _open_streams() -> None:
    """Open closed standard streams to nowhere, so that a file opened later does not take their number."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    for name, mode in (("stdin", "r"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115  # as long as Python runs
    if sys.stdout is None:
        sys.stdout = cast(TextIO, _Closed())


class _Closed(io.TextIOBase):
    """Standard output that was closed: results that go there are lost, which is a fault."""

    def write(self, _: str) -> int:
        raise OSError(errno.EBADF, "standard output is closed")


class _Pipe(io.FileIO):
    """A pipe that counts the bytes that its reader has taken."""

    bytes = 0

    def write(self, data: Any) -> int:
        count = super().write(data)
        self.bytes += count
        return count


def _count_what_is_read() -> _Pipe | None:
    """Put a `_Pipe` under standard output, if it is a pipe."""
    try:
        if not stat.S_ISFIFO(os.fstat(sys.stdout.fileno()).st_mode):
            return None
    except (OSError, ValueError):
        return None
    pipe = _Pipe(sys.stdout.fileno(), "w", closefd=False)
    sys.stdout = io.TextIOWrapper(io.BufferedWriter(pipe), encoding="utf-8")
    return pipe


def _let_go() -> None:
    """Drop output that cannot be written, so that Python does not try again, and complain, when it ends."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):
            with suppress(OSError, ValueError):
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


@contextmanager
def _stoppable() -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in _WORDS}

    def stop(number: int, _: Any) -> None:
        for signal_number in _WORDS:  # the way out is short, and must not be cut
            signal.signal(signal_number, signal.SIG_IGN)
        kill_workers()
        raise Stopped(number)

    for number in _WORDS:
        signal.signal(number, stop)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
