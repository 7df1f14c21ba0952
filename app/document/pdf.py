"""A report as PDF: Typst lays out the page, Matplotlib draws the charts, no browser and no internet.

Everything a person wrote travels as JSON and is set as text, never read as markup. The faces
inside the Typst wheel are used, so pages are the same on every machine. The file is tagged (PDF/UA-1).
"""

import json
import tempfile
from datetime import datetime
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any, Literal

import typst

from app.charts.print.svg import to_svg
from app.document.blocks import ChartBlock, Report

_TEMPLATE = "report.typ"


def to_pdf(report: Report) -> bytes:
    """The report as a PDF file."""
    charts = {block.key: to_svg(block.chart) for block in report.charts()}
    with tempfile.TemporaryDirectory(prefix="navbudget-") as folder:
        root = Path(folder)
        (root / _TEMPLATE).write_bytes(files("app.document").joinpath(_TEMPLATE).read_bytes())
        content = json.dumps(report, default=_plain, ensure_ascii=False)
        (root / "report.json").write_text(content, encoding="utf-8")
        for key, svg in charts.items():
            (root / f"{key}.svg").write_text(svg, encoding="utf-8")
        return _compiled(root, datetime.fromisoformat(report.written))


def _compiled(root: Path, written: datetime) -> bytes:
    """The page as PDF. Characters that the wheel's fonts lack, such as Chinese, are taken from the system's fonts.

    If these lack them too, a box is shown and the file does not claim PDF/UA-1, which forbids boxes (and private code
    points).
    """
    tries: tuple[tuple[bool, Literal["ua-1"] | None], ...] = ((False, "ua-1"), (True, "ua-1"), (True, None))
    for system_fonts, standard in tries:
        try:
            return typst.compile(
                str(root / _TEMPLATE),
                root=str(root),
                font_paths=_fonts(system_fonts),
                format="pdf",
                pdf_standards=standard,
                timestamp=written,
            )
        except typst.TypstError as error:
            if standard is None or "PDF/UA-1 error" not in str(error):
                raise
    raise AssertionError("the last try either returns or raises")


@cache
def _fonts(system: bool) -> typst.Fonts:
    return typst.Fonts(include_system_fonts=system)


def _plain(block: Any) -> dict[str, Any]:
    """A part of the report as JSON takes it: it says its kind, and a chart is the name of its drawing."""
    kind = type(block).__name__
    if isinstance(block, ChartBlock):
        chart = block.chart
        return {"kind": kind, "key": block.key, "title": chart.title, "knowledge": chart.knowledge, "alt": block.alt}
    return {"kind": kind, **vars(block)}
