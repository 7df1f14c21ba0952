"""`navbudget explore` and `navbudget sweep`: inverse questions, answered as JSON or CSV. SI throughout."""

import argparse
import math
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from app.console.arguments import put_json
from app.console.progress import show_progress
from nav_model.base.errors import InputError
from nav_model.base.text.csv_text import csv_of
from nav_model.budget.verdict import decisive, flown_names
from nav_model.design import Design
from nav_model.design.catalogue import Entry, Kind, catalogue
from nav_model.design.figures import FIGURES
from nav_model.design.file import read_bytes
from nav_model.design.offers import named_apart, offered
from nav_model.design.processing import REAL_TIME
from nav_model.explore.closing import LeverSet, closing_sets
from nav_model.explore.margins import ALL, label_of, limits
from nav_model.explore.rank import rank, sentence, silent
from nav_model.explore.search import Candidate, left_out, search
from nav_model.explore.solve import remedies, resolution_for, solve
from nav_model.explore.sweep import run_sweep
from nav_model.explore.sweep_plan import read_plan
from nav_model.explore.trade_map import trade_map
from nav_model.explore.uncertainty import read_uncertain, uncertain_verdict
from nav_model.explore.vendor_table import invert

_OPTION = ("name", "kind", "where", "before_s", "costs_s", "closes", "useless", "lost_s")
_CLOSE = ("allow", "lock", "at-most", "reserve")
_SET = ("margin", "tightest", "price", "currency")
_JUDGED_BY_BUDGET = ("close", "solve", "map", "search", "uncertainty")
_CANDIDATE = ("imu", "gnss", "closes", "margin", "tightest", "dominant", "share")
Rows = Iterable[Mapping[str, Any]]


def solved(design: Design, options: argparse.Namespace) -> tuple[Any, Rows]:
    """The largest value of each input that meets each requirement, and all of them."""
    solutions = solve(design)
    rows: list[dict[str, Any]] = [
        {
            "input": answer.key,
            "requirement": answer.requirement,
            "outcome": answer.outcome,
            "current": solution.current,
            "largest": answer.value,
            "margin": answer.margin,
            "limited_by": answer.binding,
            "resolution_m": resolution_for(design, answer.value)
            if answer.key == "radar.aperture_time" and answer.value
            else None,
        }
        for solution in solutions
        for answer in (solution.together, *solution.each)
    ]
    for row in rows:
        if row["outcome"] == "no value":
            row["what_would"] = {answer.key: answer.value for answer in remedies(solutions, str(row["requirement"]))}
    return {"solved": rows}, [{k: v for k, v in row.items() if k != "what_would"} for row in rows]


def closed(design: Design, options: argparse.Namespace) -> tuple[Any, Rows]:
    """The smallest sets of levers that close a design, and each lever alone."""
    try:
        answer = closing_sets(
            design,
            allow=options.allow,
            lock=options.lock,
            at_most=options.at_most,
            reserve=options.reserve,
            imus=_entries("imu", options.imus),
            receivers=_entries("gnss", options.receivers),
        )
    except InputError as error:
        option = error.key.replace("_", "-")
        raise (error.under(f"--{option}") if option in _CLOSE else error) from error
    alone = [
        {
            "lever": each.lever.name,
            "group": each.lever.group,
            "changes": dict(each.lever.changes),
            "closes": each.set.worst_ratio <= 1 - answer.reserve,
            "worst_ratio": each.set.worst_ratio,
            "because": each.because,
        }
        for each in answer.alone
    ]
    whole = {
        "closes": answer.closes,
        "worst_ratio": answer.today.worst_ratio,
        "sets": [{**_set(each), "greater": [_set(more) for more in each.greater]} for each in answer.sets],
        "alone": alone,
        "nearest": None
        if answer.nearest is None
        else {
            **_set(answer.nearest),
            "failing": dict(answer.nearest.failing),
            "would_help": [_set(each) for each in answer.helps],
        },
    }
    flat = [
        {"levers": "; ".join(row["levers"]), **{name: row[name] for name in _SET}} for row in map(_set, answer.sets)
    ]
    return whole, flat


def _set(each: LeverSet) -> dict[str, Any]:
    return {
        "levers": [lever.name for lever in each.levers],
        "groups": list(each.groups),
        "changes": dict(each.changes),
        **{name: getattr(each, name) for name in _SET},
    }


def ranked(design: Design, options: argparse.Namespace) -> tuple[Any, Rows]:
    """Sensitivities of one figure to every input."""
    items = rank(design, options.result)
    rows = [
        {
            "input": item.key,
            "slope": item.slope,
            "change_when_halved": _finite(item.halved),
            "change_when_doubled": _finite(item.doubled),
            "sentence": sentence(item, label_of(options.result)),
        }
        for item in items
    ]
    return {"result": options.result, "inputs": rows, "at_zero": list(silent(design))}, rows


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def mapped(design: Design, options: argparse.Namespace) -> tuple[Any, Rows]:
    """A result over two inputs."""
    trade = trade_map(design, options.x, options.y, options.result, options.size)
    whole = {
        "x": {"input": trade.x_key, "values": trade.x.tolist()},
        "y": {"input": trade.y_key, "values": trade.y.tolist()},
        "result": trade.result,
        "confidence": 1.0 if trade.result == ALL else decisive(design, trade.result)[0],
        "limit": _finite(trade.limit),
        "values": [[_finite(value) for value in row] for row in trade.z.tolist()],
        "catalogue": [
            {"imu": p.name, "x": p.x, "y": p.y, "value": _finite(p.value), "met": p.met} for p in trade.points
        ],
    }
    rows = (
        {trade.x_key: x, trade.y_key: y, trade.result: _finite(float(trade.z[j, i]))}
        for j, y in enumerate(trade.y.tolist())
        for i, x in enumerate(trade.x.tolist())
    )
    return whole, rows


def searched(design: Design, options: argparse.Namespace) -> tuple[Any, Rows]:
    """Every IMU with every receiver class."""
    imus, receivers = _entries("imu", options.imus), _entries("gnss", options.receivers)
    offers = any(entry.offer for entry in (*imus.values(), *receivers.values()))
    rows = [candidate(row, offers) for row in search(design, imus, receivers, options.biases)]
    whole = {"residual_biases": options.biases, "candidates": rows, "left_out": left_out(imus, options.biases)}
    return whole, rows


def candidate(row: Candidate, offers: bool) -> dict[str, Any]:
    """A unit or a pair as a row, with what it is offered for where there are ``offers``."""
    price = {"price": row.price, "currency": row.currency, "mass_kg": row.mass, "power_w": row.power}
    return {
        **{name: getattr(row, name) for name in _CANDIDATE},
        **{f"margin_{name}": margin for name, margin in row.margins.items()},
        "not_confirmed": "; ".join(row.doubts),
        **(price if offers else {}),
    }


def _entries(kind: Kind, files: Iterable[str]) -> Mapping[str, Entry]:
    """The shipped catalogue with a user's own files on top."""
    entries = dict(catalogue(kind))
    for path in files:
        try:
            brought = offered(read_bytes(path).decode("utf-8-sig"), kind)
        except UnicodeDecodeError as error:
            raise InputError(path, f"not a text file (byte {error.start} is not UTF-8)") from error
        if not brought:
            raise InputError(path, f"has no [[{kind}]] entries")
        if apart := named_apart(brought):
            print(f"navbudget: {path}: {apart}", file=sys.stderr)
        if repeated := next((name for name in brought if name in entries), None):
            raise InputError(f"{kind}.{repeated}", f"is in another file too, and again in {path}; give one of them")
        entries |= brought
    return entries


def with_uncertainty(design: Design, options: argparse.Namespace) -> tuple[Any, Rows]:
    """The verdict as a probability."""
    inputs = {}
    for text in options.vary:
        key, equals, spec = text.partition("=")
        if not equals:
            raise InputError(text, 'is not a range. Write for example imu.angle_random_walk="0.1 °/√h .. 0.2 °/√h".')
        inputs[key.strip()] = read_uncertain(key.strip(), spec)
    verdict = uncertain_verdict(design, inputs, options.seed)
    rows = [
        {"requirement": name, "probability": p.value, "low_95": p.low, "high_95": p.high}
        for name, p in ((ALL, verdict.closes), *verdict.each.items())
    ]
    whole = {
        "designs": verdict.designs,
        "seed": options.seed,
        "probability": rows,
        "tightest_margin": dict(zip(("q05", "q50", "q95"), verdict.margin, strict=True)),
        "tightest": dict(verdict.limiting),
    }
    return whole, rows


def inverted(design: Design, options: argparse.Namespace) -> tuple[Any, Rows]:
    """The noise that rows of a vendor's table imply."""
    try:
        inversion = invert(design, options.rows)
    except InputError as error:
        raise (error.under("--row") if error.key == "row" else error) from error
    rows = [
        {"input": item.key, "value": item.value, "factor": item.factor, "at_most": item.at_most,
         "determined": item.value is not None}
        for item in inversion.implied
    ]  # fmt: skip
    contradictions = [
        {"outage_s": item.entry.outage, "entry": item.entry.column, "given": item.entry.value,
         "implied": item.implied, "factor": item.factor}
        for item in inversion.contradictions
    ]  # fmt: skip
    if options.csv and contradictions:
        print(
            "navbudget: the rows contradict each other; without --csv the answer names the entries", file=sys.stderr
        )
    whole = {
        "processing": {"mode": REAL_TIME},
        "agree": inversion.agree,
        "several": inversion.several,
        "implied": rows,
    }
    return {**whole, "contradictions": contradictions}, [{**row, "agree": inversion.agree} for row in rows]


def manoeuvred(design: Design, options: argparse.Namespace) -> tuple[Any, Rows]:
    """Options that would close the lines of the flight that fail."""
    from nav_model.explore.manoeuvre import manoeuvres

    try:
        with show_progress() as progress:
            answer = manoeuvres(design, options.line, progress=lambda share, what: progress(what, share))
    except InputError as error:
        raise (error.under("--line") if error.key == "line" else error) from error
    rows = [
        {
            **{name: getattr(option, name) for name in _OPTION},
            "lines": list(option.lines),
            "figures": _limited(option.figures),
            "changes": dict(option.changes),
        }
        for option in answer.options
    ]
    whole = {"line": answer.line, "lines": list(answer.lines), "closes": answer.closes,
             "figures": _limited(answer.figures), "options": rows, "note": answer.note}  # fmt: skip
    flat = [
        {**{name: row[name] for name in _OPTION}, "lines": "; ".join(row["lines"])}
        | {f"{name}.{part}": value for name, figure in row["figures"].items() for part, value in figure.items()}
        for row in rows
    ]
    return whole, flat


def _limited(figures: Mapping[str, Any]) -> dict[str, dict[str, float | None]]:
    return {
        name: {part: _finite(value) for part, value in figure._asdict().items()} for name, figure in figures.items()
    }


QUESTIONS: Mapping[str, Callable[[Design, argparse.Namespace], tuple[Any, Rows]]] = {
    "close": closed,
    "solve": solved,
    "rank": ranked,
    "map": mapped,
    "search": searched,
    "uncertainty": with_uncertainty,
    "invert": inverted,
    "manoeuvre": manoeuvred,
}


def explore(design: Design, options: argparse.Namespace) -> int:
    """Answer one question on standard output; 1 where rows of a vendor's table contradict each other, or nothing
    would close the design or its flight."""
    if options.question == "rank" and options.result is None:
        options.result = next(iter(limits(design)), next(iter(FIGURES)))
    whole, rows = QUESTIONS[options.question](design, options)
    # Answers are those of the straight leg; where the flight decides, they are before it.
    before = flown_names(design) if options.question in _JUDGED_BY_BUDGET else ()
    named = {"before_flight": list(before)} if before else {}
    whole = {"processing": {"mode": design.processing.mode}, **named, **whole}
    closing = whole.get("sets") or any(row["closes"] for row in whole.get("options", ()))
    failed = not whole.get("agree", True) or not (whole.get("closes", True) or closing)
    if not options.csv:
        return put_json(lambda: whole) or int(failed)
    in_rows = {
        "processing.mode": whole["processing"]["mode"],
        **({"before_flight": "; ".join(before)} if named else {}),
    }
    sys.stdout.write(csv_of({**row, **in_rows} for row in rows))
    return int(failed)


def sweep(options: argparse.Namespace) -> int:
    """Run a sweep file; progress on standard error."""
    plan = read_plan(options.file)
    with show_progress() as progress:
        stored = run_sweep(
            plan, options.output, options.workers, options.scheduler,
            lambda done, total: progress(f"{done} of {total} rows", done / total),
        )  # fmt: skip
    again = f" ({stored} kept from an earlier run)" if stored else ""
    print(f"wrote {Path(options.output)}: {plan.rows} rows{again}", file=sys.stderr)
    return 0
