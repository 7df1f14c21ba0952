"""The spreadsheet, recalculated by two programs written by others, against the budget of the same inputs."""

import math
import random
import re
import subprocess
import zipfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import formulas
import numpy as np
import openpyxl
import pypdf
import pytest

from app.examples import EXAMPLES, example
from app.report.spreadsheet import LIVE, OTHER, TAKEN, workbook_bytes
from app.report.workings import Traces
from nav_model import Design, analyse
from nav_model.base.traced import Traced, Workings
from nav_model.budget.figures import figures
from nav_model.budget.inputs import inputs_of
from nav_model.budget.verdict import Check, Verdict
from nav_model.design.contributors import Contributor
from nav_model.design.figures import FIGURES, REQUIRED, RESPONSE, STEADY, of_kind
from nav_model.design.user_entries import UserEntries, read_limits

CHANGED = {
    "imu.angle_random_walk": (1e-6, 1e-4),
    "imu.velocity_random_walk": (1e-5, 3e-3),
    "gnss.position_noise": (0.02, 5.0),
    "gnss.interval": (0.2, 5.0),
    "radar.slant_range": (2e3, 2e4),
    "coast.duration": (5.0, 900.0),
    "flight.speed": (60.0, 200.0),
    "requirements.confidence": (1.0, 3.0),
    "requirements.quadratic_phase": (0.1, 3.0),
    "requirements.detrended_phase": (0.05, 1.0),
    "requirements.horizontal_position": (0.1, 3.0),
    "requirements.coast_horizontal_position": (1.0, 100.0),
    "requirements.ce90": (0.5, 10.0),
    "requirements.tilt": (1e-5, 1e-3),
}
"""Inputs that are changed, and from where to where."""


def drawn(base: Design, seed: int) -> Design:
    random_numbers = random.Random(seed)
    return base.replace(
        {key: math.exp(random_numbers.uniform(*map(math.log, span))) for key, span in CHANGED.items()}
    )


def write(path: Path, design: Design) -> Path:
    path.write_bytes(workbook_bytes(analyse(design)))
    return path


def entry(book: openpyxl.Workbook, key: str) -> str:
    """The address of an input's yellow cell."""
    return book.defined_names[key.replace(".", "_")].attr_text.rpartition("!")[2].replace("$D$", "B")


def entered(book: openpyxl.Workbook, key: str, value: float) -> float:
    """A value in SI as it is entered in the unit of its cell."""
    in_si = book["Inputs"][entry(book, key).replace("B", "D")].value
    if "10^" in in_si:
        return 20 * math.log10(value)
    factor = re.search(r"\*([\d.E-]+)\)$", in_si)
    return value / float(factor[1]) if factor else value


def expected(design: Design) -> dict[str, float]:
    """Every figure in real time that has a formula, and the verdict, under the names of the sheet's cells."""
    names = {name: name for name in REQUIRED}
    for n, limit in enumerate(design.limits, 1):
        ends = limit.at is None and limit.on in of_kind("outage")  # a figure has one cell
        if ends or limit.on not in (*STEADY, *RESPONSE):
            names[limit.name] = limit.on if ends or limit.on == "cep" else f"own_limit_{n}"
    values = figures(inputs_of(design.replace({"processing.mode": "real time"})), names)
    return {f"real_time_{names[name]}": float(value) for name, value in values.items()}


def extra() -> UserEntries:
    """Contributors, and limits on values of each kind."""
    limits = [
        {"name": "late heading", "on": "coast_heading", "limit": "0.02°", "at": "30 s", "confidence": 3},
        {"name": "climb", "on": "coast_vertical_velocity", "limit": "0.5 m/s"},
        {"name": "position", "on": "coast_horizontal_position", "limit": "1 NM", "at": "12.5 s"},
        {"name": "vertical tilt", "on": "tilt", "limit": "1 mrad", "confidence": 2},
        {"name": "lever", "on": "lever arm", "limit": "3 mm"},
        {"name": "half of the images", "on": "cep", "limit": "1 m"},
        {"name": "side lobe", "on": "pslr", "limit": "3 dB"},
        {"name": "loss", "on": "peak_loss", "limit": "3 dB"},
        {"name": "second order", "on": "detrended_phase_2", "limit": "5°"},
    ]
    return UserEntries(contributors(), read_limits(limits, contributors()))


def contributors() -> tuple[Contributor, ...]:
    """Some that enter phases, the image's place and navigation, random and systematic."""
    return (
        Contributor("=1+1", 1e-3, "quadratic_phase", "length"),
        Contributor("lever arm", 2e-3, "quadratic_phase", "length", kind="systematic", allowance=0.2),
        Contributor("mast", 1e-4, "detrended_phase_2", "length"),
        Contributor("time tag", 0.05, "detrended_phase", "angle", kind="systematic"),
        Contributor("atmosphere", 1.5, "ce90", "length"),
        Contributor("boresight", 1e-4, "tilt", "angle", processing="real time"),
        Contributor("datum", 0.3, "coast_horizontal_position", "length"),
        Contributor("fan", 0.02, "paired_echo", "level"),
        Contributor("converter", 0.05, "islr", "level", kind="systematic"),
        Contributor("after flight", 0.1, "horizontal_position", "length", processing="post-processed"),
    )


@pytest.mark.parametrize("entries", [UserEntries(), extra()], ids=["model", "own"])
@pytest.mark.parametrize("name", EXAMPLES)
def test_every_cell_is_written_with_the_value_of_the_budget(tmp_path: Path, name: str, entries: UserEntries) -> None:
    budget = analyse(example(name).replace({}, entries=entries))
    path = write(tmp_path / "budget.xlsx", budget.design)
    book = openpyxl.load_workbook(path, data_only=True)
    formulas_too = openpyxl.load_workbook(path)
    rows = {row[1].value: row for row in book["Workings"].iter_rows(min_row=2) if row[1].value}
    for symbol, value in expected(budget.design).items():
        assert rows[symbol][2].value == pytest.approx(value, rel=1e-9)
        assert rows[symbol][5].value == LIVE
    assert str(formulas_too["Workings"][rows["real_time_quadratic_phase"][2].coordinate].value).startswith("=")
    assert book["Budget"]["A2"].value == ("Closes" if budget.verdict.closes else "Does not close")
    checked = {row[0].value: row for row in book["Budget"].iter_rows(min_row=6)}
    for check in budget.verdict.checks:
        row = checked[check.label]
        assert row[6].value == pytest.approx(check.margin, abs=1e-9)
        assert row[7].value == ("met" if check.met else "not met")
        assert row[9].value == (TAKEN if check.on in ("pslr", "peak_loss") else LIVE)
        assert row[10].value == cause(check)
    post = {row[0].value: row for row in book["Post-processed"].iter_rows(min_row=6)}
    for check in budget.other_verdict.checks:
        assert post[check.label][6].value == pytest.approx(check.margin, abs=1e-9)
        assert post[check.label][9].value == (
            TAKEN if check.on in FIGURES and FIGURES[check.on].smoothed_mark else LIVE
        )
        assert post[check.label][10].value == cause(check)
    listed = {row[0].value: row for row in book["Sources"].iter_rows(min_row=4)}
    for line in budget.sight_lines():
        if line.quadratic:
            assert listed[line.source][1].value == pytest.approx(math.degrees(line.quadratic), rel=1e-9)
            assert listed[line.source][4].value == pytest.approx(line.share, rel=1e-9)
            assert "+" not in listed[line.source][4].number_format  # a share is no margin


def cause(check: Check) -> str:
    return f"{check.dominant}, {100 * check.dominant_share:.0f} % of the variance"


def budget_names(book: openpyxl.Workbook) -> Iterator[tuple[str, str]]:
    limits = [name for name in book.defined_names if name.startswith("real_time_own_limit")]
    for name in (
        *(f"real_time_{figure}" for figure in dict.fromkeys((*REQUIRED, "cep", *of_kind("outage")))),
        *limits,
        "verdict_in_real_time",
    ):
        sheet, _, cell = book.defined_names[name].attr_text.rpartition("!")
        yield name, f"{sheet.strip(chr(39))}!{cell.replace('$', '')}"


@pytest.mark.slow
def test_an_evaluator_of_workbooks_follows_changed_cells(tmp_path: Path) -> None:
    """As the spreadsheet program does, which every run of the tests asks."""
    base = drawn(example("mems_x_band"), 0).replace({}, entries=extra())
    path = write(tmp_path / "budget.xlsx", base)
    book = openpyxl.load_workbook(path)
    model = formulas.ExcelModel().loads(str(path)).finish()

    def at(sheet: str, cell: str) -> str:
        return f"'[budget.xlsx]{sheet.upper()}'!{cell}"

    names = {name: at(*place.split("!")) for name, place in budget_names(book)}
    states = [at("Budget", f"J{row}") for row in (6, 8)]
    old = at("Post-processed", "J6")
    as_written = model.calculate(outputs=[*names.values()])
    for name, value in expected(base).items():
        assert float(as_written[names[name]].value[0, 0]) == pytest.approx(value, rel=1e-6, abs=1e-12)
    for seed in range(1, 21):
        design = drawn(base, seed)
        inputs = {at("Inputs", entry(book, key)): entered(book, key, design[key]) for key in CHANGED}
        results = model.calculate(inputs=inputs, outputs=[*names.values(), *states, old])
        for name, value in expected(design).items():
            assert float(results[names[name]].value[0, 0]) == pytest.approx(value, rel=1e-6, abs=1e-12), (seed, name)
        closes = analyse(design).verdict.closes
        assert results[names["verdict_in_real_time"]].value[0, 0] == ("Closes" if closes else "Does not close")
        assert [results[state].value[0, 0] for state in states] == [LIVE, LIVE]
        assert results[old].value[0, 0] == OTHER


def convert(folder: Path, kind: str, *paths: Path) -> None:
    """Have the spreadsheet program write workbooks as files of this kind, with a profile that nothing else uses."""
    profile = paths[0].with_name("profile").as_uri()
    subprocess.run(
        ["soffice", f"-env:UserInstallation={profile}", "--headless", "--convert-to", kind, "--outdir", str(folder),
         *map(str, paths)],
        check=True, capture_output=True,
    )  # fmt: skip


def other_contributors(design: Design, seed: int) -> Design:
    """The same contributors with other values and allowances."""
    random_numbers = random.Random(seed)
    others = tuple(
        replace(c, value=c.value * random_numbers.uniform(0.3, 3), allowance=random_numbers.choice([0, 0.1, 0.5]))
        for c in design.contributors
    )
    return design.replace({}, entries=UserEntries(others, design.limits))


@pytest.mark.long
@pytest.mark.parametrize("count", [2, pytest.param(20, marks=pytest.mark.slow)])
def test_a_spreadsheet_program_follows_changed_cells(tmp_path: Path, count: int) -> None:
    """All workbooks in one start of the program; in every other one the model stays, as a smoother asks."""
    bases = [example(name).replace({}, entries=extra()) for name in EXAMPLES]
    wanted: dict[str, Design] = {}
    for seed in range(3 + count):
        base = bases[seed % 3]
        path = write(tmp_path / f"{seed}.xlsx", base)
        design = base if seed < 3 else other_contributors(base if seed % 2 else drawn(base, seed), seed)
        book = openpyxl.load_workbook(path)
        for key in CHANGED:
            if design[key] is not None:
                book["Inputs"][entry(book, key)] = entered(book, key, design[key])
        for number, contributor in enumerate(design.contributors, 1):
            for key, value in (
                (f"contributor_{number}", contributor.value),
                (f"contributor_{number}_allowance", contributor.allowance),
            ):
                book["Inputs"][entry(book, key)] = entered(book, key, value)
        book.save(path)  # without the values of formulas, which have to be computed
        wanted[path.name] = design
    done = tmp_path / "done"
    convert(done, "xlsx", *(tmp_path / name for name in wanted))
    for name, design in wanted.items():
        book = openpyxl.load_workbook(done / name, data_only=True)
        places = dict(budget_names(book))
        for symbol, value in expected(design).items():
            sheet, cell = places[symbol].split("!")
            assert book[sheet][cell].value == pytest.approx(value, rel=1e-9, abs=1e-12), (name, symbol)
        base = bases[int(Path(name).stem) % 3]
        model_stays = all(design[key] == base[key] for key in CHANGED)
        judged = analyse(design)
        for sheet, verdict in (
            ("Budget", judged.judged("real time")),
            ("Post-processed", judged.judged("post-processed")),
        ):
            if model_stays or sheet == "Budget":
                holds(
                    book[sheet],
                    verdict,
                    {check.name for check in analyse(base).verdict.checks},
                )
        if not model_stays:
            assert book["Post-processed"]["A2"].value in ("Does not close", "Not known for these inputs")
        errors = [cell.coordinate for sheet in book for row in sheet for cell in row if cell.data_type == "e"]
        assert not errors


def holds(sheet: Any, verdict: Verdict, with_cause: set[str]) -> None:
    """A sheet has the margins, the verdict and, of limits that were there when it was written, causes of a budget."""
    rows = {row[0].value: row for row in sheet.iter_rows(min_row=6)}
    for check in verdict.checks:
        if rows[check.label][9].value == OTHER:
            assert check.on in RESPONSE
            assert rows[check.label][7].value == rows[check.label][10].value == "not known"
        else:
            assert rows[check.label][6].value == pytest.approx(check.margin, rel=1e-9, abs=1e-9), check.label
            assert rows[check.label][7].value == ("met" if check.met else "not met")
            assert rows[check.label][10].value == (cause(check) if check.name in with_cause else None), check.label
    met = [row[7].value for row in rows.values()]
    unknown = "Not known for these inputs" if "not known" in met else "Closes"
    assert sheet["A2"].value == ("Does not close" if "not met" in met else unknown)


@pytest.mark.long
def test_a_spreadsheet_program_shows_every_number_with_its_sign(tmp_path: Path) -> None:
    path = write(tmp_path / "budget.xlsx", example("mems_x_band").replace({}, entries=extra()))
    convert(tmp_path, "pdf", path)
    text = "".join(page.extract_text() for page in pypdf.PdfReader(path.with_suffix(".pdf")).pages)
    assert "###" not in text
    assert re.search(rf"Paired echo\s*{20 * math.log10(0.02):.2f}", text)  # of the fan, a level of 0.02


@pytest.mark.parametrize(
    ("changes", "symbol"),
    [
        ({"gnss.velocity_noise": 0.05}, "real_time_coast_horizontal_position"),
        ({"gnss.correlated": True}, "real_time_quadratic_phase"),
        ({"motion.delay": 0.01, "motion.lines": ((30.0, 1e-4, "length"),)}, "real_time_quadratic_phase"),
    ],
)  # fmt: skip
def test_what_has_no_formula_says_so(tmp_path: Path, changes: dict[str, Any], symbol: str) -> None:
    design = example("mems_x_band").replace(changes)
    rows = {row.symbol: row for row in Traces(design).workings.rows}
    assert rows[symbol].taken
    for name, value in expected(design).items():
        assert rows[name].value == pytest.approx(value, rel=1e-9)
    write(tmp_path / "budget.xlsx", design)


def test_names_are_texts_and_there_is_no_macro_or_link(tmp_path: Path) -> None:
    for sign in "=+-@":
        design = example("mems_x_band").replace({"name": f'{sign}HYPERLINK("http://x","y")'})
        path = write(tmp_path / "budget.xlsx", design)
        title = openpyxl.load_workbook(path)["Budget"]["A1"]
        assert title.data_type == "s"
        assert str(title.value).startswith(f"{sign}HYPERLINK")
        with zipfile.ZipFile(path) as parts:
            assert not [name for name in parts.namelist() if "vba" in name or "externalLink" in name]
            assert not any(b"hyperlink" in parts.read(name) for name in parts.namelist() if "rels" in name)


def test_steps_are_named_and_not_printed(tmp_path: Path) -> None:
    book = openpyxl.load_workbook(
        write(tmp_path / "budget.xlsx", example("mems_x_band").replace({}, entries=extra()))
    )
    steps = [row[0].value for row in book["Steps"].iter_rows(min_row=4)]
    assert all(re.fullmatch(r".+, step \d+", label) for label in steps)
    assert {sheet.title for sheet in book if sheet.sheet_state == "hidden"} == {"Steps", "Rule"}
    assert all(sheet.print_area for sheet in book if sheet.sheet_state == "visible")


def test_names_of_cells_are_none_of_a_cell() -> None:
    for row in Traces(example("mems_x_band")).workings.rows:
        assert not re.fullmatch(r"[A-Za-z]{1,3}\d+|[RrCc]\d*", row.symbol)
        assert len(row.text) < 400


def test_a_formula_does_not_branch_by_value() -> None:
    angle = Traced("angle", np.float64(1.0), Workings())
    with pytest.raises(TypeError, match="cannot branch on angle>0"):
        bool(angle > 0)


@pytest.mark.long
def test_a_tighter_limit_on_a_figure_of_the_autofocus_acts(tmp_path: Path) -> None:
    """Entered in the workbook of a design that has none; a looser one does not."""
    base = example("mems_x_band").replace({"autofocus.method": "phase gradient", "autofocus.scene": "urban"})
    names = "phase_before_autofocus", "path_before_autofocus", "autofocus_estimation"
    tighter, looser = (dict(zip(names, limits, strict=True)) for limits in ((1.0, 1e-3, 0.01), (100.0, 10.0, 0.5)))
    wanted = {
        f"{number}.xlsx": {f"requirements.{name}": limit for name, limit in limits.items()}
        | {"requirements.confidence": confidence}
        for number, (limits, confidence) in enumerate(((tighter, 1.0), (tighter, 2.0), (looser, 2.0)))
    }
    for file, changes in wanted.items():
        path = write(tmp_path / file, base)
        book = openpyxl.load_workbook(path)
        for key, value in changes.items():
            book["Inputs"][entry(book, key)] = entered(book, key, value)
        book.save(path)
    done = tmp_path / "done"
    convert(done, "xlsx", *(tmp_path / file for file in wanted))
    for file, changes in wanted.items():
        rows = {
            row[0].value: row for row in openpyxl.load_workbook(done / file, data_only=True)["Budget"].iter_rows()
        }
        checks = {check.name: check for check in analyse(base.replace(changes)).judged("real time").checks}
        for name in names:
            cells, check = rows[checks[name].label], checks[name]
            assert cells[6].value == pytest.approx(check.margin, rel=1e-9), (file, name)
            assert cells[2].value == (check.confidence or 1.0)
            assert cells[7].value == ("met" if check.met else "not met")
    assert [analyse(base.replace(wanted[file])).verdict.closes for file in wanted] == [False, False, True]
