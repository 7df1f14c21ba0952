"""`navbudget serve` as a process."""

import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path

from waiting import PATIENCE


@contextmanager
def serving(
    *options: str, log: Path | None = None, program: Sequence[str] = ("-m", "app")
) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """Address and process of a server, which is stopped at the end and must then end well.

    What it says goes to `log`; without one it is among what the test says.
    """
    command = [sys.executable, *program, "serve", "--port", "0", *options]
    with (
        log.open("w") if log else nullcontext() as errors,
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True) as process,
    ):
        line = process.stdout.readline()
        assert line.startswith("NavBudget on http://"), line
        try:
            yield line.split()[-1], process
        finally:
            if process.poll() is None:
                process.terminate()
            assert process.wait(PATIENCE) == 0
