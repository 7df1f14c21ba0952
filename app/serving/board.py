"""Shared counters of the processes of one server: a row of numbers each, which only it writes and all read."""

import multiprocessing
from dataclasses import dataclass

_COLUMNS = ("pid", "ready", "sessions", "opened", "refused", "events", "heavy", "restarts")
_LASTING = ("opened", "refused", "events", "restarts")  # what a process counted outlives it


class SharedMetrics:
    """A row per process. It reaches another process as an argument of that process only."""

    def __init__(self, processes: int = 1) -> None:
        self.processes = processes
        self._cells = multiprocessing.get_context("spawn").RawArray("d", processes * len(_COLUMNS))

    def get(self, process: int, column: str) -> int:
        """The number in a column of a process's row."""
        return int(self._cells[self._place(process, column)])

    def put(self, process: int, column: str, value: int) -> None:
        """Write one number; only for the process that owns the row, and for its parent while it does not run."""
        self._cells[self._place(process, column)] = value

    def total(self, column: str) -> int:
        """The sum over all processes."""
        return sum(self.get(process, column) for process in range(self.processes))

    def fewest(self, column: str) -> int:
        """The least of the processes that take visitors."""
        ready = [process for process in range(self.processes) if self.get(process, "ready")]
        return min((self.get(process, column) for process in ready), default=0)

    def clear(self, process: int) -> None:
        """Reset the row of a process that has ended, except its totals."""
        for column in _COLUMNS:
            if column not in _LASTING:
                self.put(process, column, 0)

    @staticmethod
    def _place(process: int, column: str) -> int:
        return process * len(_COLUMNS) + _COLUMNS.index(column)


@dataclass(frozen=True)
class BoardRow:
    """The row of one process, to write on."""

    board: SharedMetrics
    process: int = 0

    def put(self, column: str, value: int) -> None:
        """Write a number."""
        self.board.put(self.process, column, value)

    def add(self, column: str) -> None:
        """Count one more."""
        self.put(column, self.board.get(self.process, column) + 1)
