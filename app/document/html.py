"""A report as one HTML file: interactive charts, nothing fetched from anywhere, opens from disk.

Jinja escapes every text; equations become MathML through Typst, so that they are written once for both faces.
"""

import json
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cache
from importlib.resources import files
from urllib.parse import quote

import numpy as np
import typst
from bokeh.document import Document
from bokeh.embed import components
from bokeh.resources import Resources
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from app.charts.kinds import AnyChart, BarChart, Chart, DotChart, Line, MapChart, PictureChart, Plotted, to_csv
from app.charts.legend import legend_html
from app.charts.screen.figures import to_bokeh
from app.charts.screen.pictures import picture_gallery
from app.document.bars import ROWS_SHEET, bars_html
from app.document.blocks import MARK, UNIT_GAP, Equations, Report, Symbols
from app.document.numbers import NONE, number
from app.document.pane import html_of
from app.document.ranks_html import ranks_html

_MATH = re.compile(r"<math.*?</math>", re.DOTALL)
_TYPST_MATH = """
#for item in json(bytes(sys.inputs.items)) { math.equation(block: item.block, eval(item.math, mode: "math")) }
"""
_ROOT = '<mrow><mo stretchy="false">√</mo><mrow style="border-top: 1px solid; padding: 1px 2px 0">'
_TABLE_ROWS = 11  # of a curve's table of data
_MAP_ROWS = 5  # and columns of a map's
_PLAIN = ",;:/()[]=+*!"  # of a text to take away: what an address may hold as it is
_HEIGHT = 340
_TALL = 440


def to_html(report: Report) -> str:
    """The report as the text of an HTML file."""
    plots, written = {}, {}
    for block in report.charts():
        if isinstance(block.chart, Plotted):
            plots[block.key] = to_bokeh(block.chart, _height(block.chart)).plot
            plots[block.key].name = block.key
        else:
            written[block.key] = _written(block.chart)
    document = Document()
    with document.models.freeze():  # looks through all charts once, and not again with every one that is added
        for plot in plots.values():
            document.add_root(plot)
    script, places = components(plots) if plots else ("", {})
    equations = {item.mark for block in report.blocks() if isinstance(block, Equations) for item in block.items}

    def linked(text: str) -> Markup:
        return _with_links(text, equations)

    environment = Environment(
        loader=PackageLoader("app", "document"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(
        linked=linked,
        rendered=lambda block: Markup(html_of(block, html=linked)),
        rows=_data_rows,
        kind=lambda block: type(block).__name__,
        data=_data_url,
        csv=to_csv,
        legend=lambda chart: Markup("" if isinstance(chart, BarChart) else legend_html(chart)),
    )
    page = environment.get_template("report.html").render(
        report=report,
        style=Markup(ROWS_SHEET + files("app.document").joinpath("report.css").read_text(encoding="utf-8")),
        library=Markup(_library() if plots else ""),
        script=Markup(script),
        places={key: Markup(place) for key, place in (places | written).items()},
        math=_math(report),
    )
    return page.lstrip()  # the macros' own lines come before the doctype


def _written(chart: BarChart | DotChart | PictureChart) -> str:
    """A chart that needs no canvas, as HTML."""
    if isinstance(chart, BarChart):
        return bars_html(chart)
    return ranks_html(chart) if isinstance(chart, DotChart) else picture_gallery(chart)


def _height(chart: Plotted) -> int:
    if isinstance(chart, MapChart) or (isinstance(chart, Chart) and chart.square):
        return _TALL
    return _HEIGHT


@cache
def _library() -> str:
    """BokehJS itself, without the widgets and tables a report has no use for.

    The script's text, not rendered tags: in a serving process these would refer to the server's own files.
    """
    scripts = Resources(mode="inline", components=["bokeh"]).js_raw
    return "\n".join(f'<script type="text/javascript">\n{script}\n</script>' for script in scripts)


def _with_links(text: str, marks: Iterable[str]) -> Markup:
    """Escaped text with its equation marks as links."""
    known = set(marks)

    def link(match: re.Match[str]) -> str:
        mark = match[1]
        return f'<a href="#{mark}">[{mark}]</a>' if mark in known else match[0]

    return Markup(MARK.sub(link, str(escape(UNIT_GAP.sub("\N{NO-BREAK SPACE}", text)))))


def _math(report: Report) -> dict[str, Markup]:
    """Typst math of the report's equations and symbols -> MathML."""
    wanted: dict[str, bool] = {}
    for block in report.blocks():
        if isinstance(block, Equations | Symbols):
            wanted |= {item.math: isinstance(block, Equations) for item in block.items}
    return {math: Markup(set_) for (math, _), set_ in mathml(tuple(wanted.items())).items()}


@cache
def mathml(items: tuple[tuple[str, bool], ...]) -> Mapping[tuple[str, bool], str]:
    """Items of Typst math -> MathML; each says whether it is a separate block."""
    data = json.dumps([{"math": math, "block": block} for math, block in items], ensure_ascii=False)
    page = typst.compile(_TYPST_MATH.encode(), format="html", sys_inputs={"items": data}).decode()
    # A browser without a mathematical font leaves out the sign of a root, which makes the equation a wrong one.
    page = page.replace("<msqrt>", _ROOT).replace("</msqrt>", "</mrow></mrow>")
    return dict(zip(items, _MATH.findall(page), strict=True))


def _data_url(text: str, kind: str) -> str:
    """A text to take away, percent-encoded: numbers stay as they are, which base64 makes a third longer."""
    return f"data:{kind};charset=utf-8,{quote(text, safe=_PLAIN)}"


def _data_rows(chart: AnyChart) -> list[tuple[str, ...]]:
    """A chart's numbers for reading: bars and dots whole, curves and maps at a few places; first the head."""
    return [tuple(map(_short, row)) for row in _at_a_few_places(chart).rows()]


def _at_a_few_places(chart: AnyChart) -> AnyChart:
    if isinstance(chart, MapChart):
        down, across = (slice(None, None, max(1, size // _MAP_ROWS)) for size in chart.values.shape)
        sampled = {name: getattr(chart, name)[down, across] for name in ("winner", "values")}
        return replace(chart, x=chart.x[across], y=chart.y[down], **sampled)
    if isinstance(chart, Chart):
        return replace(chart, bands=(), lines=tuple(map(_few_points, chart.lines)))
    return chart


def _few_points(line: Line) -> Line:
    seen = np.flatnonzero(~np.isnan(line.y))
    seen = seen[:: max(1, (len(seen) - 1) // (_TABLE_ROWS - 1))]
    return replace(line, x=line.x[seen], y=line.y[seen])


def _short(cell: str | float) -> str:
    return cell if isinstance(cell, str) else NONE if math.isnan(cell) else number(cell)
