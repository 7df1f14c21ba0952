"""The commands `evaluate`, `check`, `allocate` and `presets`: a design's budget, its verdict, what each source may
take, the catalogue."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING, Any

from app.console.arguments import design_arguments, paths_of, put_json, read_design
from app.console.ending import one_line, refuse
from app.console.flight import flown_arguments, flown_budget
from nav_model.base.errors import InputError
from nav_model.base.text.csv_text import csv_of
from nav_model.design.catalogue import catalogue
from nav_model.design.figures import FIGURES
from nav_model.design.other_filters import FILTERS, noise_for
from nav_model.design.user_entries import SPLITS, Allotment, read_allocation

if TYPE_CHECKING:
    from nav_model.budget import Budget


def add_to(commands: Any) -> None:
    """Declare the command."""
    evaluate = commands.add_parser("evaluate", help="print the whole budget of a design as JSON")
    design_arguments(evaluate, single=True)
    evaluate.add_argument(
        "--times", metavar="S,S,...", help="times of the outage curves, in seconds since the last fix"
    )
    evaluate.add_argument(
        "--sicd",
        action="store_true",
        help="print the image location errors as the SICD XML element ErrorStatistics instead",
    )
    flown_arguments(evaluate)
    evaluate.set_defaults(run=_evaluate)

    check = commands.add_parser("check", help="check designs against their requirements")
    design_arguments(check, single=False)
    flown_arguments(check)
    check.set_defaults(run=_check)

    share_out = commands.add_parser("allocate", help="split a requirement's limit among sources and contributors")
    design_arguments(share_out, single=True)
    share_out.add_argument("--requirement", metavar="NAME", help="a requirement's name; by default the tightest")
    share_out.add_argument(
        "--split",
        choices=SPLITS,
        help="equal values, in proportion to today's, or least change; by default the design's, or shares",
    )
    share_out.add_argument(
        "--reserve", metavar="RATIO", help="part of the limit to keep, such as 20%%; by default the design's, or that"
    )
    share_out.add_argument(
        "--lock", action="append", metavar="SOURCE=VALUE",
        help="a source whose value is given, with its unit, at the confidence of the limit: "
        '"gyro noise=5 deg"; in place of those of the design',
    )  # fmt: skip
    share_out.set_defaults(run=_allocate)

    vendor = commands.add_parser("table", help="print the errors that data sheets print: no outage, 10 s and 60 s")
    design_arguments(vendor, single=True)
    vendor.add_argument("--imu", metavar="NAME", help="an IMU of the catalogue in place of the design's")
    vendor.add_argument("--csv", action="store_true", help="as CSV instead of JSON")
    vendor.set_defaults(run=_table)

    export = commands.add_parser("export", help="write the sensor noise as another filter reads it")
    design_arguments(export, single=True)
    export.add_argument("--for", dest="filter", required=True, choices=tuple(FILTERS), help="the filter")
    export.set_defaults(run=_export)

    presets = commands.add_parser("presets", help="list the catalogue, with sources")
    presets.add_argument("kind", choices=("imu", "radar", "gnss"))
    presets.add_argument("--json", action="store_true", help="as JSON")
    presets.set_defaults(run=_presets)


def _evaluate(options: argparse.Namespace) -> int:
    from nav_model.budget import analyse
    from nav_model.budget.json import to_json

    (path,) = paths_of(options)
    design = read_design(path, options.changes)
    try:
        budget = analyse(design, _times(options.times))
    except InputError as error:
        raise (error.under("--times") if error.key == "times" else error) from error
    if options.sicd:
        from app.document.sicd import sicd_xml
        from nav_model.budget.sicd import error_statistics

        sys.stdout.write(sicd_xml(error_statistics(design)).decode())
        return 0
    return put_json(lambda: to_json(flown_budget(budget, options)))


def _times(text: str | None) -> list[float] | None:
    if text is None:
        return None
    try:
        return [float(part) for part in text.split(",")]
    except ValueError as error:
        raise InputError("--times", f"{text!r} is not a list of seconds such as 0,10,20") from error


def _check(options: argparse.Namespace) -> int:
    from nav_model.budget import analyse

    worst = 0
    for path in paths_of(options):
        try:
            budget = flown_budget(analyse(read_design(path, options.changes)), options)
            lines = check_lines(one_line(path), budget)
        except InputError as error:
            worst = refuse(error)
            continue
        print("\n".join(lines))
        if budget.verdict.failing or (budget.verdict.open and not options.no_flight):
            worst = max(worst, 1)
    return worst


def check_lines(path: str, budget: Budget) -> list[str]:
    """Lines of `navbudget check` for a design: one per requirement and caution, then both verdicts, the design's
    last and with the file's name.

    Words and digits are those of the page and the report; the minus sign is the one that scripts read.
    """
    from app.document.numbers import margin_in_sentence
    from app.document.verdict import SAID, check_words, judged, open_words, tightest_words
    from nav_model.budget.provenance import cautions

    verdict = budget.verdict
    if not verdict.checks:
        return [f"{path}: closes (the design has no requirement, so nothing was checked)"]
    lines = []
    for check in verdict.checks:
        words = check_words(budget.design, check)
        if not check.known:
            lines.append(f"  {_STATES[check.state]} {check.label} (limit {words.limit}; {check.reason})")
            continue
        lines.append(
            f"  {_STATES[check.state]} {check.label} {words.value} (limit {words.limit}, "
            f"{margin_in_sentence(check.margin)}; main error source {check.dominant}, {words.share}; {words.figure})"
        )
    other = budget.other_verdict
    lines += [f"  caution: {caution}" for caution in cautions(budget)]
    lines += [
        f"  {SAID[other.processing]} it {_WOULD[other.state]}{tightest_words(other)}",
        f"{path}: {_WORDS[verdict.state]} {judged(verdict)}{tightest_words(verdict)}"
        f"{_closing_words(budget)}{open_words(verdict)}",
    ]
    return [line.replace("−", "-") for line in lines]


def _closing_words(budget: Budget) -> str:
    """The change that a design needs, where the straight leg fails."""
    if not budget.straight_leg().failing:
        return ""
    from app.document.closing import closing_in_short
    from app.document.verdict import before_flight
    from nav_model.explore.closing import closing_sets

    return f"; {closing_in_short(closing_sets(budget.design))}{before_flight(budget.design)}"


_STATES = {"met": "met    ", "not met": "NOT MET", "open": "OPEN   ", "refused": "REFUSED"}
_WORDS = {"closes": "closes", "fails": "DOES NOT CLOSE", "open": "OPEN"}
_WOULD = {"closes": "would close", "fails": "would not close", "open": "is open"}


def _allocate(options: argparse.Namespace) -> int:
    from nav_model.budget import analyse
    from nav_model.budget.allocation import allocate, check_of
    from nav_model.budget.json import allocation_json

    (path,) = paths_of(options)
    budget = analyse(read_design(path, options.changes))
    try:
        check = check_of(budget, options.requirement)
        plan = (budget.design.allocation or Allotment()).record()
        plan |= {key: given for key in ("split", "reserve") if (given := getattr(options, key)) is not None}
        if options.lock is not None:
            plan["locks"] = {check.name: _locks(options.lock)}
        allocation = allocate(budget, check.name, read_allocation(plan, budget.design.limits))
    except InputError as error:
        option = "lock" if "locks" in error.key else error.key.removeprefix("allocation.")
        raise (error.under(f"--{option}") if option in ("requirement", "reserve", "lock") else error) from error
    return put_json(lambda: allocation_json(allocation)) or int(not allocation.closes)


def _locks(texts: list[str]) -> dict[str, str]:
    """Sources and their values as texts."""
    locks: dict[str, str] = {}
    for text in texts:
        source, equals, value = (part.strip() for part in text.rpartition("="))
        if not equals:
            raise InputError("lock", f'{text!r} has no "=". Write SOURCE=VALUE, such as "gyro noise=5 deg".', text)
        if source in locks:
            raise InputError("lock", f"{source!r} is locked twice.", text)
        locks[source] = value
    return locks


_OF_TABLE = "IMU and receiver alone, without the design's contributors; 1 sigma per axis"


def _table(options: argparse.Namespace) -> int:
    from nav_model.explore.vendor_table import COLUMNS, vendor_table, with_unit

    (path,) = paths_of(options)
    design = read_design(path, options.changes)
    if options.imu is not None:
        try:
            design = with_unit(design, options.imu)
        except InputError as error:
            raise error.under("--imu") from error
    rows = [
        {"processing": row.processing, "outage_s": row.outage}
        | {FIGURES[COLUMNS[name].outage].column.removeprefix("coast_"): value for name, value in row.values.items()}
        for row in vendor_table(design)
    ]
    if options.csv:
        sys.stdout.write(csv_of(rows))
        return 0
    return put_json(lambda: {"imu": options.imu or design.imu.preset, "of": _OF_TABLE, "rows": rows})


def _export(options: argparse.Namespace) -> int:
    (path,) = paths_of(options)
    sys.stdout.write(noise_for(read_design(path, options.changes), options.filter))
    return 0


def _presets(options: argparse.Namespace) -> int:
    entries = catalogue(options.kind)
    if options.json:
        plain = {
            entry.name: {
                "grade": entry.grade,
                "note": entry.note,
                **{
                    key: {
                        "value": v.text,
                        "status": v.status,
                        "source": v.source,
                        **({"kind": v.kind} if v.kind else {}),
                    }
                    for key, v in (*entry.values.items(), *entry.extra.items())
                },
            }
            for entry in entries.values()
        }
        return put_json(lambda: plain)
    for entry in entries.values():
        print(entry.name + (f" ({entry.grade})" if entry.grade else ""))
        for key, value in (*entry.values.items(), *entry.extra.items()):
            mark = "" if value.confirmed else f"  [{value.status.upper()}]"
            kind = f", {value.kind}" if value.kind else ""
            print(f"  {key:22} {value.text}{kind}{mark}  -- {value.source}")
        if entry.note:
            print(f"  note: {entry.note}")
    return 0
