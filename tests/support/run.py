"""`make test`: lint, the tests without a browser and those in one, each to its end whatever became of the others.

They run beside each other, as much of a test is waiting for a server or a page. The last lines say how each ended;
the exit status is 1 if one of them failed. In a new installation the simulator is compiled first, beside lint: two
workers that find nothing compiled would each do it.

    python tests/support/run.py [lint | check | slow] [ORDER]

``check`` is what is quick of lint and the tests without a browser; ``slow`` is what `make test` leaves out. ORDER is
``random`` or the number of an order that was random.
"""

from __future__ import annotations

import os
import random
import subprocess
import sys
import time
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

_BIN = Path(sys.executable).parent
_WORKERS = str(max(2, (os.cpu_count() or 2) // 2))
_LINT = ("ruff check .", "ruff format --check .", "mypy", "lint-imports", "hadolint Dockerfile")
_HALVES = {"without a browser": ["--ignore", "tests/browser"], "in the browser": ["tests/browser"]}
_PYTEST = ["pytest", "-p", "no:benchmark", "-n", _WORKERS, "--dist", "loadfile", "--no-loadscope-reorder"]
_KINDS: dict[str, list[str]] = {
    "test": [],
    "lint": [],
    "check": ["-m", "not slow and not long"],
    "slow": ["-m", "slow", "--hypothesis-profile", "searching"],
}


@dataclass
class Part:
    """What is run, and what became of it; what is not ``shown`` as it comes is kept until the end."""

    name: str
    commands: list[list[str]]
    shown: bool = False
    said: str = ""
    failed: bool = False
    seconds: float = 0.0

    def run(self) -> None:
        """Each command to its end, the next one even if one failed."""
        began = time.monotonic()
        for command in self.commands:
            # As a module: processes that a test starts find its file then.
            own = [sys.executable, "-m", "pytest"] if command[0] == "pytest" else [str(_BIN / command[0])]
            done = [*own, *command[1:]]
            with subprocess.Popen(done, stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as process:
                assert process.stdout is not None
                while text := os.read(process.stdout.fileno(), 4096).decode(errors="replace"):
                    self.said += text
                    if self.shown:
                        print(text, end="", flush=True)
            self.failed |= process.returncode != 0
        self.seconds = time.monotonic() - began

    @property
    def outcome(self) -> str:
        """A line: pytest's last one, or how lint ended."""
        if self.commands[-1][0] == "pytest" and self.said.strip():
            return self.said.strip().splitlines()[-1].strip("= ")
        return f"{'failed' if self.failed else 'passed'} in {self.seconds:.1f}s"


def parts(kind: str, order: list[str]) -> list[Part]:
    """What is to be run; lint is not of the slow kind, the browser not of the quick one."""
    lint = Part("lint", [command.split() for command in _LINT])
    halves = [
        Part(name, [[*_PYTEST, *_KINDS[kind], *order, *where]], shown=name == "without a browser")
        for name, where in _HALVES.items()
    ]
    return {"lint": [lint], "check": [lint, halves[0]], "slow": halves, "test": [lint, *halves]}[kind]


def main(arguments: list[str]) -> int:
    """Run; the exit status."""
    # A hundred processes that each compile every source anew are a third of the whole time.
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    kind = arguments[0] if arguments and arguments[0] in _KINDS else "test"
    order: list[str] = []
    if arguments and arguments[-1] != kind:
        seed = str(random.randrange(10**6)) if arguments[-1] == "random" else arguments[-1]
        order = ["--random-order-bucket=module", f"--random-order-seed={seed}"]
        print(f"order {seed}: `make test ORDER={seed}` is this one again", flush=True)
    all_parts = parts(kind, order)
    with ThreadPoolExecutor(len(all_parts)) as pool:
        running: list[Future[None]] = [pool.submit(part.run) for part in all_parts if part.name == "lint"]
        if kind != "lint":
            subprocess.run(
                [sys.executable, "-m", "nav_model.simulation.warm"], check=False, stdout=subprocess.DEVNULL
            )
        running += [pool.submit(part.run) for part in all_parts if part.name != "lint"]
    for future in running:
        future.result()
    for part in all_parts:
        if not part.shown:
            print(f"\n{part.name}\n{part.said}", flush=True)
    print()
    for part in all_parts:
        print(f"{part.name:18s} {'FAILED  ' if part.failed else ''}{part.outcome}")
    return int(any(part.failed for part in all_parts))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
