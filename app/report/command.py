"""The command `report`: a report on designs and their studies."""

import argparse
import sys
from pathlib import Path
from typing import Any

from app.console.arguments import design_arguments, paths_of, read_design
from app.console.files import whole_file
from app.console.flight import flown_arguments, flown_budget
from app.report import SPREADSHEET, document_bytes, kind_of, report_bytes
from app.subjects import OF_DESIGNS
from nav_model.base.errors import InputError


def add_to(commands: Any) -> None:
    """Declare the command."""
    report = commands.add_parser("report", help="write a design report")
    design_arguments(report, single=False)
    flown_arguments(report)
    add = report.add_argument
    add("-o", "--output", required=True, type=Path, metavar="FILE", help="FILE.html, FILE.pdf or FILE.xlsx")
    add("--with", dest="studies", default="", metavar="STUDY,...",
        help=f"studies to run and add to each design's chapter: {', '.join(OF_DESIGNS)}")  # fmt: skip
    add("--show", default="", metavar="HOW",
        help="figures of the budget: 1s (1σ), 2s, 95 or cep, else as required; 95.si in SI")  # fmt: skip
    add("--supplier", choices=("imu", "gnss"), help="write the one-page sheet for a supplier of the unit instead")
    add = report.add_argument_group("the studies of --with").add_argument
    add("--runs", type=int, metavar="N", help="runs of the simulation and of SAR (default 100 and 200)")
    add("--seed", type=int, default=1, metavar="S", help="seed of every study (default 1)")
    add("--trajectory", default="wandering", metavar="NAME-or-FILE", help="flight to simulate, as in `simulate`")
    add("--duration", type=float, metavar="S",
        help="length of a run (default: 400 s with fixes, then the design's outage; or the file's)")  # fmt: skip
    add("--outage", dest="outages", action="append", default=[], metavar="START,STOP",
        help="outage of the simulation; may be repeated (default: the design's own, at the end)")  # fmt: skip
    add("--workers", type=int, metavar="W", help="processes of the simulation (default: all cores but one)")
    report.set_defaults(run=_report)


def _report(options: argparse.Namespace) -> int:
    """Write the report; progress of its studies on standard error."""
    from app.document.display import display_of
    from app.document.wording import chapter_key, design_labels
    from app.report.studies import study_sections
    from nav_model.budget import analyse

    display_of(options.show)  # refused now, not after the studies
    paths = paths_of(options)
    designs = [read_design(path, options.changes) for path in paths]
    kind, wanted = kind_of(options.output), _wanted(options.studies)
    if (kind == SPREADSHEET or options.supplier) and (len(designs) > 1 or wanted or options.show):
        what = "a requirement sheet" if options.supplier else "a spreadsheet"
        raise InputError("-o", f"{what} is of one design, without --with and --show")
    if options.supplier:
        from app.report.supplier import supplier_report

        if kind == SPREADSHEET:
            raise InputError("-o", "a requirement sheet is a page: FILE.html or FILE.pdf")
        sheet = supplier_report(designs[0], options.supplier)
    budgets = [analyse(design) for design in designs]
    if not options.supplier:
        budgets = [flown_budget(budget, options) for budget in budgets]
    with whole_file(options.output) as file:  # refused now, not after the studies
        if options.supplier:
            file.write(document_bytes(sheet, kind))
        else:
            studies = []
            for design, label in zip(designs, design_labels(len(designs)), strict=True):
                findings = {key: OF_DESIGNS[key].load("report").study(design, options) for key in wanted}
                studies.append(study_sections(findings, design, chapter_key(label)))
            file.write(report_bytes(budgets, kind, studies=studies, display=options.show))
    print(f"wrote {options.output}", file=sys.stderr)
    return 0


def _wanted(text: str) -> list[str]:
    """The keys of the studies named, in the order of the report."""
    named = [name.strip() for name in text.split(",") if name.strip()]
    for name in named:
        if name not in OF_DESIGNS:
            raise InputError("--with", f"{name!r} is not a study; {', '.join(OF_DESIGNS)}")
    return [key for key in OF_DESIGNS if key in named]
