"""The command `navbudget`. Results go to standard output, messages to standard error.

Exit codes: 0 done (for ``check``: every design closes), 1 a design does not close, 2 bad input. Nothing
heavier than the model itself is imported before a command needs it.
"""

from __future__ import annotations

import argparse
import getpass
import io
import json
import math
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

from app.files import put_file
from nav_model.budget import Budget, analyse
from nav_model.budget_json import to_json
from nav_model.catalogue import catalogue
from nav_model.design import Design
from nav_model.design_file import MAX_BYTES, parse_design, read_bytes
from nav_model.inputs import BaseQuantity, DesignError
from nav_model.parts import declaration_of
from nav_model.units import format_quantity

BAD_INPUT = 2

_OAUTH = ("auth0", "azure", "azurev2", "bitbucket", "generic", "gitlab", "github", "google", "okta")


class _Parser(argparse.ArgumentParser):
    """Refuses a wrong command line with one line, like any other bad input."""

    def error(self, message: str) -> NoReturn:
        self.exit(BAD_INPUT, f"{self.prog}: {message}\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    if isinstance(sys.stdout, io.TextIOWrapper):  # units and names need it, whatever the locale says
        sys.stdout.reconfigure(encoding="utf-8")
    try:
        return int(options.run(options))
    except DesignError as error:
        return _refuse(error)
    except BrokenPipeError:  # the reader has what it wanted (`| head`)
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def _refuse(error: DesignError) -> int:
    # One line whatever the file held: line ends and control characters of a key or path are escaped.
    line = "".join(c if c.isprintable() else repr(c)[1:-1] for c in str(error))
    print(f"navbudget: {line}", file=sys.stderr)
    return BAD_INPUT


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="navbudget", description="Navigation error budgets for airborne SAR.")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    _serve_arguments(commands.add_parser("serve", help="run the dashboard"))

    password = commands.add_parser("password", help="print a person's line for the password file")
    password.add_argument("name", metavar="NAME", help="the person; the password is asked for, or read from a pipe")
    password.set_defaults(run=_password)

    evaluate = commands.add_parser("evaluate", help="the whole budget of a design as JSON")
    _design_arguments(evaluate, one=True)
    evaluate.add_argument("--times", metavar="S,S,...", help="seconds since the last fix for the outage curves")
    evaluate.set_defaults(run=_evaluate)

    check = commands.add_parser("check", help="hold designs against their requirements")
    _design_arguments(check, one=False)
    check.set_defaults(run=_check)

    report = commands.add_parser("report", help="write a design report")
    _design_arguments(report, one=False)
    report.add_argument("-o", "--output", required=True, type=Path, metavar="FILE", help="FILE.html or FILE.pdf")
    _study_arguments(report)
    report.set_defaults(run=_report)

    suborbital = commands.add_parser(
        "suborbital",
        help="the star-tracker study of a suborbital flight as JSON",
        description="INS errors of a suborbital flight by source, with and without star tracker. Without a file the "
        "sensors are those of the set GP-1; a design's [imu] replaces white noise and constant biases; a study file "
        "(saved on the Suborbital page or with --save) states every input. --set takes keys of the design and "
        "inputs of the study, e.g. --set tracker.from_height='80 km'.",
    )
    _design_arguments(suborbital, one=True)
    suborbital.add_argument("--save", type=Path, metavar="FILE", help="also write the study's inputs as a study file")
    suborbital.add_argument("--inputs", action="store_true", help="list the inputs of the study and stop")
    suborbital.add_argument("--trajectory", metavar="FILE", help="a flight from a CSV file instead of the golden one")
    suborbital.add_argument("--from-height", metavar="HEIGHT", help='tracker from a height, e.g. "80 km"')
    suborbital.add_argument("--latency", metavar="TIME", help='age of an attitude, e.g. "10 ms"')
    suborbital.add_argument("--misalignment", metavar="ANGLES", help='camera to IMU, e.g. "60, 0, 0 arcsec"')
    suborbital.add_argument("--star-images", action="store_true", help="attitude from star images, not perfect")
    suborbital.add_argument("--method", metavar="NAME", help="TRIAD, N-vector, q-method, QUEST or SVD")
    suborbital.add_argument("--seed", metavar="N", help="of centroid noise and white noise (default 1)")
    suborbital.add_argument(
        "--noise-runs", type=int, default=0, metavar="N", help="also fly N INS with white noise alone (Monte Carlo)"
    )
    suborbital.set_defaults(run=_suborbital)
    simulate = commands.add_parser(
        "simulate",
        help="Monte Carlo of a design against the closed forms",
        description="Flies the design as a strapdown INS with a Kalman filter, many times over. --set takes keys of "
        "the design and sensor errors, receiver and tuning beyond it, e.g. --set gyro.bias_instability='25 °/h'.",
    )
    _design_arguments(simulate, one=True)
    simulate.add_argument("--inputs", action="store_true", help="list what --set takes beyond the design and stop")
    simulate.add_argument("--runs", type=int, default=100, metavar="N", help="independent runs (default 100)")
    simulate.add_argument("--seed", type=int, default=1, metavar="S", help="seed of every run (default 1)")
    simulate.add_argument(
        "--duration", type=float, metavar="S", help="length of a run (default 500 s, or the file's)"
    )
    simulate.add_argument(
        "--outage",
        dest="outages",
        action="append",
        default=[],
        metavar="START,STOP",
        help="seconds between which fixes are lost; may be repeated",
    )
    simulate.add_argument(
        "--trajectory",
        default="wandering",
        metavar="NAME-or-FILE",
        help="wandering, straight, turns, climb, or a CSV file",
    )
    simulate.add_argument(
        "--every", type=float, default=1.0, metavar="S", help="spacing of the results (default 1 s)"
    )
    simulate.add_argument("--states", type=int, choices=(9, 15, 21), default=9,
        help="of the filter; 15 estimates biases, 21 two kinds of them apart")  # fmt: skip
    simulate.add_argument("--workers", type=int, metavar="W", help="processes (default: all cores but one)")
    simulate.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster that flies the runs instead")
    simulate.add_argument("-o", "--output", type=Path, metavar="FILE", help="FILE.json, .npz (every run) or .csv")
    simulate.set_defaults(run=_simulate)

    _allan_arguments(commands.add_parser("allan", help="noise parameters from a static log (CSV or NPZ) as JSON"))
    sar = commands.add_parser("sar", help="image quality for every way of navigating through the aperture, as JSON")
    _design_arguments(sar, one=True)
    sar.add_argument("--runs", type=int, default=200, help="runs of the ensemble (default 200)")
    sar.add_argument("--seed", type=int, default=0, help="of the ensemble (default 0)")
    sar.add_argument(
        "--engine",
        choices=("fast", "simulator"),
        default="fast",
        help="per-axis error model, or full flights of the simulator with the error model beside them (default fast)",
    )
    sar.add_argument(
        "--workers", type=int, metavar="W", help="processes of the simulator (default: all cores but one)"
    )
    sar.add_argument("-o", "--output", type=Path, metavar="FILE", help="write there instead of standard output")
    sar.set_defaults(run=_sar)

    presets = commands.add_parser("presets", help="the catalogue, with sources")
    presets.add_argument("kind", choices=("imu", "radar", "gnss"))
    presets.add_argument("--json", action="store_true", help="as JSON")
    presets.set_defaults(run=_presets)
    _explore_arguments(commands)
    sweep = commands.add_parser("sweep", help="evaluate grids of designs, in closed form or flown, into a table")
    sweep.add_argument("file", metavar="FILE", help="what to vary, TOML")
    sweep.add_argument("-o", "--output", required=True, metavar="OUT", help="OUT.csv or OUT.parquet")
    sweep.add_argument(
        "--workers", type=_count, default=os.cpu_count() or 1, help="local processes (default: all cores)"
    )
    sweep.add_argument("--scheduler", metavar="ADDRESS", help="Dask scheduler whose workers do the work")
    sweep.set_defaults(run=_sweep)
    return parser


def _study_arguments(report: argparse.ArgumentParser) -> None:
    report.add_argument(
        "--with",
        dest="studies",
        default="",
        metavar="STUDY,...",
        help="run these and tell their results in each design's chapter: simulation, sar, suborbital",
    )
    add = report.add_argument_group("the studies of --with").add_argument
    add("--runs", type=int, metavar="N", help="of simulation and SAR (default 100 and 200)")
    add("--seed", type=int, default=1, metavar="S", help="of every study (default 1)")
    add("--trajectory", default="wandering", metavar="NAME-or-FILE", help="of the simulation, as in `simulate`")
    add("--duration", type=float, metavar="S",
        help="of a simulated run (default: 400 s with fixes, then the design's outage; or the file's)")  # fmt: skip
    add("--outage", dest="outages", action="append", default=[], metavar="START,STOP",
        help="of the simulation; may be repeated (default: the design's own, at the end)")  # fmt: skip
    add("--workers", type=int, metavar="W", help="processes of the simulation (default: all cores but one)")


def _explore_arguments(commands: Any) -> None:
    explore = commands.add_parser("explore", help="solve backwards, rank, map, search, uncertainty; JSON or CSV")
    questions = explore.add_subparsers(dest="question", required=True, metavar="QUESTION")
    helps = {
        "solve": "the largest noise, interval or time that still meets the requirements",
        "rank": "what a figure answers to, strongest first",
        "map": "two inputs against a result",
        "search": "every catalogue unit with every receiver class against the requirements",
        "uncertainty": "the probability that the design closes when inputs are ranges",
    }
    parsers = {name: questions.add_parser(name, help=text) for name, text in helps.items()}
    for parser in parsers.values():
        _design_arguments(parser, one=True)
        parser.add_argument("--csv", action="store_true", help="as CSV instead of JSON")
        parser.set_defaults(run=_explore)
    parsers["rank"].add_argument("--result", metavar="FIGURE", help="default: the design's first requirement")
    parsers["map"].add_argument("--x", default="imu.angle_random_walk", metavar="KEY")
    parsers["map"].add_argument("--y", default="gnss.position_noise", metavar="KEY")
    parsers["map"].add_argument("--result", default="all requirements", metavar="FIGURE")
    parsers["map"].add_argument("--size", type=_count, metavar="N", help="points along a side (default 200)")
    parsers["search"].add_argument("--imus", action="append", default=[], metavar="FILE", help="your own units")
    parsers["search"].add_argument(
        "--receivers", action="append", default=[], metavar="FILE", help="your own receivers"
    )
    parsers["uncertainty"].add_argument(
        "--vary",
        action="append",
        default=[],
        metavar="KEY=RANGE",
        help='e.g. imu.angle_random_walk="0.1 °/√h .. 0.2 °/√h", with log behind, or "0.15 °/√h */ 1.3"',
    )
    parsers["uncertainty"].add_argument("--seed", type=int, default=1)


def _count(text: str) -> int:
    number = int(text)
    if not 1 <= number <= 2000:
        raise ValueError(text)
    return number


def _serve_arguments(serve: argparse.ArgumentParser) -> None:
    add = serve.add_argument
    add("--port", type=int, default=5006, help="port (default 5006; 0 picks a free one)")
    add("--address", default="127.0.0.1", help="address to listen on (default 127.0.0.1, this machine only)")
    add(
        "--allow-origin",
        action="append",
        default=[],
        metavar="HOST[:PORT]",
        help="public host the page is reached under, when not the address itself; may be repeated",
    )
    add("--behind-proxy", action="store_true", help="believe X-Forwarded-For and X-Forwarded-Proto; only behind one")
    who = serve.add_argument_group("who may enter (needed when the address is not this machine only)")
    add = who.add_argument
    add("--password-file", type=Path, metavar="FILE", help="lines name:hash as `navbudget password NAME` prints them")
    add("--open", action="store_true", help="let everybody in who reaches the address")
    add("--cookie-secret-file", type=Path, metavar="FILE", help="signs the login; without it a restart logs all out")
    add("--login-hours", type=float, default=12.0, metavar="H", help="a login lasts so long (default 12)")
    add("--oauth-provider", metavar="NAME", choices=_OAUTH, help=f"sign in through: {', '.join(_OAUTH)}")
    add("--oauth-key", metavar="ID", help="client id; the secret comes from PANEL_OAUTH_SECRET in the environment, "
        "a key to encrypt tokens from PANEL_OAUTH_ENCRYPTION")  # fmt: skip
    add("--oauth-redirect-uri", metavar="URL", help="where the provider sends the visitor back to")
    add("--oauth-allow", action="append", default=[], metavar="WHO",
        help="user, @domain of a mail address, or * for every account; may be repeated")  # fmt: skip
    serve.add_argument(
        "--library",
        default="",
        metavar="PATH-or-URL",
        help="saved designs: a file, or postgresql://... (default: a file in the user's data folder)",
    )
    limits = serve.add_argument_group("limits")
    add = limits.add_argument
    add("--max-sessions", type=int, default=100, metavar="N", help="open pages at a time (default 100)")
    add("--session-lifetime", type=float, default=60.0, metavar="S",
        help="a page that lost its connection is kept so long (default 60)")  # fmt: skip
    add("--max-message", type=float, default=20.0, metavar="MB",
        help="largest message a browser may send, uploads included (default 20)")  # fmt: skip
    add("--workers", type=int, metavar="N", help="processes for heavy work such as reports and Monte Carlo runs "
        "(default: one less than cores); pages themselves are served by one process")  # fmt: skip
    add("--grace", type=float, default=10.0, metavar="S", help="on SIGTERM heavy work may end so long (default 10)")
    add("--log", choices=("text", "json"), default="text", help="text: warnings; json: every event, a line each")
    serve.set_defaults(run=_serve)


def _design_arguments(parser: argparse.ArgumentParser, *, one: bool) -> None:
    parser.add_argument("designs", nargs="*", metavar="DESIGN" if one else "DESIGN...", help="a file, or - for stdin")
    parser.add_argument(
        "--set",
        dest="changes",
        action="extend",
        nargs="+",
        default=[],
        metavar="KEY=VALUE",
        help='override the file, e.g. imu.angle_random_walk="0.3 °/√h"',
    )
    parser.set_defaults(one=one, parser=parser)


def _allan_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("log", metavar="LOG", help="a CSV or NPZ file, or - for stdin")
    parser.add_argument("--rate", type=float, metavar="HZ", help="samples a second, unless the file says it")
    parser.add_argument("--gyro-unit", metavar="UNIT", help='"deg/s", increments "rad", or per count "0.05 deg/s"')
    parser.add_argument("--accelerometer-unit", metavar="UNIT", help='"m/s2", "g", "m/s", or "0.00333 g" per count')
    parser.add_argument("--columns", metavar="NAME,...", help="a table's columns in order; - ignores one")
    parser.add_argument("--arrays", metavar="ROLE=NAME,...", help="an archive's arrays, e.g. gyro=w,accelerometer=f")
    parser.add_argument("--motion", action="store_true", help="the log was taken moving: effective noise, no fit")
    parser.add_argument("--bench-arw", metavar="QUANTITY", help='angle random walk at rest, "0.1 °/√h"')
    parser.add_argument("--bench-vrw", metavar="QUANTITY", help='velocity random walk at rest, "0.03 m/s/√h"')
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="write the JSON there")
    parser.set_defaults(run=_allan, parser=parser)


def _paths(options: argparse.Namespace) -> list[str]:
    """The designs named; a path that --set swallowed is given back."""
    paths, changes = list(options.designs), list(options.changes)
    while changes and "=" not in changes[-1]:
        paths.append(changes.pop())
    options.changes = changes
    if not paths:
        options.parser.error("no DESIGN given; name a file, or - for standard input")
    if options.one and len(paths) > 1:
        options.parser.error(f"one DESIGN expected, {len(paths)} given")
    return paths


def _read(path: str, changes: Sequence[str]) -> Design:
    return parse_design(*_content(path, MAX_BYTES), changes)


def _content(path: str, most: int) -> tuple[bytes, str]:
    """What a file or standard input holds, at most a byte more than it may, and what to call it."""
    if path == "-":
        return sys.stdin.buffer.read(most + 1), "standard input"
    return read_bytes(path, most), path


def _evaluate(options: argparse.Namespace) -> int:
    (path,) = _paths(options)
    budget = analyse(_read(path, options.changes), _times(options.times))
    json.dump(to_json(budget), sys.stdout, ensure_ascii=False, allow_nan=False, indent=1)
    sys.stdout.write("\n")
    return 0


def _times(text: str | None) -> list[float] | None:
    if text is None:
        return None
    try:
        return [float(part) for part in text.split(",")]
    except ValueError as error:
        raise DesignError("--times", f"{text!r} is not a list of seconds such as 0,10,20") from error


def _check(options: argparse.Namespace) -> int:
    worst = 0
    for path in _paths(options):
        try:
            budget = analyse(_read(path, options.changes))
        except DesignError as error:
            worst = _refuse(error)
            continue
        print("\n".join(check_lines(path, budget)))
        if not budget.verdict.closes:
            worst = max(worst, 1)
    return worst


def check_lines(path: str, budget: Budget) -> list[str]:
    """A line per requirement, then the verdict: what `navbudget check` prints for one design."""
    design, verdict = budget.design, budget.verdict
    lines = []
    for check in verdict.checks:
        key = f"requirements.{'quadratic_phase' if check.name.startswith('along') else check.name}"
        declaration = declaration_of(key)
        unit = design.unit(key)
        value, limit = (format_quantity(x, unit, declaration.dimension, 4) for x in (check.value, check.limit))
        lines.append(
            f"{path}: {'met    ' if check.met else 'NOT MET'} {check.name} {value} (limit {limit}, "
            f"margin {100 * check.margin:+.1f} %, {check.figure} {check.equation}, "
            f"dominated by {check.sensor} {100 * check.sensor_share:.0f} %)"
        )
    if not verdict.checks:
        lines.append(f"{path}: closes (no requirement given, nothing checked)")
    else:
        said = "closes" if verdict.closes else "DOES NOT CLOSE"
        tightest = verdict.tightest
        assert tightest is not None
        lines.append(
            f"{path}: {said} at {verdict.confidence:g} sigma; tightest {tightest.name}, "
            f"margin {100 * tightest.margin:+.1f} %"
        )
    return lines


def _report(options: argparse.Namespace) -> int:
    paths = _paths(options)
    from app.report_command import write_report_with

    write_report_with([_read(path, options.changes) for path in paths], options)
    print(f"wrote {options.output}", file=sys.stderr)
    return 0


def _suborbital(options: argparse.Namespace) -> int:
    from app.suborbital.command import list_inputs, run
    from nav_model.suborbital.study_file import MAX_BYTES as MAX_STUDY

    if options.inputs:
        return list_inputs()
    designs, changes = list(options.designs), list(options.changes)
    if designs or any("=" not in change for change in changes):
        designs = _paths(options)
        changes = list(options.changes)
    sections = ("imu.", "gnss.", "coast.", "radar.", "requirements.")
    of_design = [change for change in changes if change.startswith(sections)]
    asked = dict(part.split("=", 1) for part in changes if part not in of_design)
    asked |= {
        key: text
        for key, text in (
            ("tracker.from_height", options.from_height),
            ("tracker.latency", options.latency),
            ("tracker.misalignment", options.misalignment),
            ("camera.frames", "star images" if options.star_images else None),
            ("camera.method", options.method),
            ("seed", options.seed),
        )
        if text is not None
    }
    data, where = _content(designs[0], MAX_STUDY) if designs else (None, "")
    return run(data, where, of_design, asked, options.trajectory, options.noise_runs, options.save)


def _simulate(options: argparse.Namespace) -> int:
    from app.simulate_command import list_inputs, simulate_design
    from nav_model.simulation.study_inputs import read_study_inputs, split_changes

    if options.inputs:
        return list_inputs()
    (path,) = _paths(options)
    of_design, of_study = split_changes(options.changes)
    simulate_design(_read(path, of_design), read_study_inputs(of_study), options)
    return 0


def _allan(options: argparse.Namespace) -> int:
    from app.log_study import BenchNoise, LogRequest, read_options, study_log, study_to_json

    if not options.motion and (options.bench_arw or options.bench_vrw):
        options.parser.error("--bench-arw and --bench-vrw belong to --motion")
    request = LogRequest(
        source=sys.stdin.buffer.read() if options.log == "-" else options.log,
        file_name="standard input" if options.log == "-" else None,
        options=read_options(
            options.rate, options.gyro_unit, options.accelerometer_unit, options.columns, options.arrays
        ),
        motion=options.motion,
        bench=BenchNoise(
            _bench("--bench-arw", "imu.angle_random_walk", options.bench_arw),
            _bench("--bench-vrw", "imu.velocity_random_walk", options.bench_vrw),
        ),
    )
    return _put_json(study_to_json(study_log(request, _say_progress)), options.output)


def _say_progress(fraction: float, what: str) -> None:
    print(f"{100 * fraction:3.0f} % {what}", file=sys.stderr)


def _bench(option: str, key: str, text: str | None) -> float | None:
    if text is None:
        return None
    declaration = declaration_of(key)
    assert isinstance(declaration, BaseQuantity)
    try:
        return declaration.read(text).value
    except DesignError as error:
        raise DesignError(option, error.reason) from error


def _sar(options: argparse.Namespace) -> int:
    (path,) = _paths(options)
    from app.sar_command import sar

    return _put_json(sar(_read(path, options.changes), options), options.output)


def _put_json(data: dict[str, Any], output: Path | None) -> int:
    """To standard output, or whole into a file."""
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, indent=1) + "\n"
    if output is None:
        sys.stdout.write(text)
        return 0
    put_file(output, text.encode("utf-8"))
    print(f"wrote {output}", file=sys.stderr)
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
        print(json.dumps(plain, ensure_ascii=False, indent=1))
        return 0
    for entry in entries.values():
        print(entry.name + (f" ({entry.grade})" if entry.grade else ""))
        for key, value in (*entry.values.items(), *entry.extra.items()):
            mark = "" if value.confirmed else f"  [{value.status.upper()}]"
            kind = f", {value.kind}" if value.kind else ""
            print(f"  {key:22} {value.text}{kind}{mark}  -- {value.source}")
        if entry.note:
            print(f"  note: {entry.note}")
    return 0


def _explore(options: argparse.Namespace) -> int:
    (path,) = _paths(options)
    from app.explore_commands import explore

    return explore(_read(path, options.changes), options)


def _sweep(options: argparse.Namespace) -> int:
    from app.explore_commands import sweep

    return sweep(options)


def _serve(options: argparse.Namespace) -> int:
    from app.serving.rules import Rules, cookie_secret, oauth_from

    rules = Rules(
        address=options.address,
        port=options.port,
        allow_origin=tuple(options.allow_origin),
        open=options.open,
        password_file=options.password_file,
        cookie_secret=cookie_secret(options.cookie_secret_file),
        oauth=oauth_from(
            options.oauth_provider, options.oauth_key, options.oauth_redirect_uri, tuple(options.oauth_allow)
        ),
        behind_proxy=options.behind_proxy,
        max_sessions=options.max_sessions,
        session_lifetime=options.session_lifetime,
        login_hours=options.login_hours,
        max_message=round(1e6 * options.max_message) if math.isfinite(options.max_message) else 0,
        workers=options.workers,
        grace=options.grace,
        log=options.log,
    )
    rules.check()  # before the screen is loaded: a wrong command is refused at once
    from app.library.place import use_library
    from app.server import serve

    use_library(options.library)
    serve(rules)
    return 0


def _password(options: argparse.Namespace) -> int:
    from app.serving.passwords import password_line

    if sys.stdin.isatty():
        password = getpass.getpass("Password: ")
        if getpass.getpass("Again: ") != password:
            raise DesignError("password", "the two differ")
    else:
        password = sys.stdin.readline().rstrip("\r\n")
    print(password_line(options.name, password))
    return 0


if __name__ == "__main__":
    sys.exit(main())
