"""Shared parts of the commands: designs named on the command line, JSON output, errors in one line."""

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from app.console.files import whole_file
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.file import KEY_VALUE, MAX_BYTES, parse_design, read_bytes
from nav_model.design.parts import all_keys


def design_arguments(parser: argparse.ArgumentParser, *, single: bool) -> None:
    parser.add_argument(
        "designs",
        nargs="*",
        metavar="DESIGN" if single else "DESIGN...",
        help="design file (TOML), or - for standard input",
    )
    parser.add_argument("--set", dest="changes", action="extend", nargs="+", default=[], metavar="KEY=VALUE",
        help='override values of the file, e.g. imu.angle_random_walk="0.3 °/√h"')  # fmt: skip
    parser.set_defaults(single=single, parser=parser)


def paths_of(options: argparse.Namespace) -> list[str]:
    """The design files named, also a path that argparse took as a value of --set."""
    paths, changes = list(options.designs), list(options.changes)
    known = all_keys()
    while changes and "=" not in changes[-1] and changes[-1] not in known and not (options.single and paths):
        paths.append(changes.pop())
    for change in changes:
        if "=" not in change:
            raise InputError("--set", f'{change!r} has no "=". Write {KEY_VALUE}.', change)
    options.changes = changes
    if not paths:
        options.parser.error("no DESIGN given; name a file, or - for standard input")
    if options.single and len(paths) > 1:
        options.parser.error(f"takes one DESIGN, but {len(paths)} are given: {', '.join(paths)}")
    return paths


def read_design(path: str, changes: Sequence[str]) -> Design:
    return parse_design(*content_of(path, MAX_BYTES), changes)


def content_of(path: str, most: int) -> tuple[bytes, str]:
    """The content of a file or of standard input, at most one byte more than allowed, and its name for messages."""
    if path == "-":
        return sys.stdin.buffer.read(most + 1), "standard input"
    return read_bytes(path, most), path


def put_json(work: Callable[[], Any], output: Path | None = None) -> int:
    """Write the result of the work to standard output or completely into a file, which is checked before the work
    begins."""

    def text() -> str:
        return json.dumps(work(), ensure_ascii=False, allow_nan=False, indent=1) + "\n"

    if output is None:
        sys.stdout.write(text())
        return 0
    with whole_file(output) as file:
        file.write(text().encode("utf-8"))
    print(f"wrote {output}", file=sys.stderr)
    return 0
