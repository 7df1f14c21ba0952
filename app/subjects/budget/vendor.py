"""The table that vendors of inertial systems print, of the design or another unit, and what a printed one implies."""

from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import declared, required
from app.document.blocks import Block, Bullets, TableBlock, Text, numbers, table
from app.document.numbers import NONE, in_one_unit, number, show
from app.document.pane import html_of
from app.document.wording import input_in_words
from app.session import Session
from app.ui.fields import TextArea
from app.ui.html_pane import html_pane
from app.ui.theme import PRINT_NOTHING
from app.ui.view import View
from app.work.pool import run_in_pool
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.catalogue import catalogue
from nav_model.design.figures import FIGURES
from nav_model.design.parts import declaration_of
from nav_model.explore.vendor_table import COLUMNS, Implied, Inversion, invert, vendor_table, with_unit

_OWN = "IMU of the design"
_EXAMPLE = "60 s: horizontal 17 m, vertical 0.56 m, velocity 0.57 m/s, roll and pitch 0.073°, heading 0.065°"
_NOTE = (
    "1σ per axis; a sheet's horizontal rms over both axes is √2 times as much. IMU and receiver alone, without "
    "contributors. Real time: before a fix, and at the end of the outage [T-17], [T-9]. Post-processed: the "
    "largest error while a smoother bridges the outage [P-3]. Heading: its growth, which fixes of a straight leg "
    "do not observe [T-5]."
)

_CAUSES = (
    "A sheet may round up, be post-processed, of a car with an odometer, of two antennas or of another receiver. "
    "Where it prints a horizontal rms of both axes, write 0.5 m DRMS."
)


def vendor_block(design: Design, key: str, unit: str = "") -> TableBlock:
    """The table of the design, or with another IMU of the catalogue."""
    rows = vendor_table(with_unit(design, unit) if unit else design)
    columns = (
        in_one_unit([row.values[name] for row in rows], FIGURES[of.outage].dimension) for name, of in COLUMNS.items()
    )
    cells = [
        (f"{row.outage:g} s" if row.outage else "None", row.processing, *values)
        for row, values in zip(rows, zip(*columns, strict=True), strict=True)
    ]
    heads = numbers(*(column.label for column in COLUMNS.values()), width=1)
    title = f"Errors {f'with {unit} ' if unit else ''}as data sheets print them, 1σ"
    return table(f"{key}-vendor", title, (("Outage", 0.7), ("Processing", 1), *heads), cells, _NOTE)


def implied_blocks(design: Design, inversion: Inversion) -> list[Block]:
    """Blocks of what rows imply, and of what contradicts what."""
    blocks: list[Block] = []
    if inversion.contradictions:
        others = "the closest noise gives" if inversion.several else "the others imply"
        contradictions = tuple(
            f"{item.entry.label} is a factor of {number(max(item.factor, 1 / item.factor))} "
            f"{'above' if item.factor > 1 else 'below'} what {others}, "
            f"{show(item.implied, FIGURES[COLUMNS[item.entry.column].outage].dimension)}."
            for item in inversion.contradictions
        )
        title = "The entries contradict each other in real time with this receiver"
        blocks.append(Bullets(contradictions, f"{title}{', several at once' if inversion.several else ''}"))
        blocks.append(Text(_CAUSES))

    def words(item: Implied) -> tuple[str, str]:
        if item.value is not None and item.factor is not None:
            return input_in_words(design, item.key, item.value, given=False), f"a factor of {number(item.factor)}"
        if item.at_most is None:
            return NONE, "not determined by these rows"
        return f"any up to {input_in_words(design, item.key, item.at_most, given=False)}", NONE

    rows = ((str(declaration_of(item.key).label), *words(item)) for item in inversion.implied)
    closest = "Closest noise" if inversion.contradictions else "Implied noise"
    blocks.append(table("implied", closest, ("Input", *numbers("Value, 1σ"), "To within"), rows))
    return blocks


class VendorPanel(View):
    """A choice of the IMU and its table; a box for printed rows, and what they imply for the design."""

    session = required(Session)
    unit: str = declared(param.Selector(default=_OWN, objects=[_OWN], label="IMU"))

    def __init__(self, session: Session) -> None:
        super().__init__(session=session)
        walks = {"angle_random_walk", "velocity_random_walk"}
        whole = [name for name, entry in catalogue("imu").items() if walks <= entry.values.keys()]
        self.param.unit.objects = [_OWN, *whole]
        self.table = html_pane("")
        self.rows = TextArea(
            label="Vendor's table in real time, one row per line, e.g. 60 s: horizontal 0.10 m",
            placeholder=_EXAMPLE, rows=3, max_length=3000, sizing_mode="stretch_width", margin=(12, 10, 4, 10),
        )  # fmt: skip
        self.ask = pmui.Button(label="Which noise does it imply?", variant="outlined", margin=(4, 10))
        self.take = pmui.Button(label="Use in the design", variant="contained", visible=False, margin=(4, 10))
        self.answer = html_pane("")
        self._inversion: Inversion | None = None
        self.ask.on_click(self._invert)
        self.take.on_click(self._take)
        chosen = pmui.Select.from_param(self.param.unit, width=260, margin=(8, 10))
        tools = pn.Column(self.rows, pn.Row(self.ask, self.take), stylesheets=[PRINT_NOTHING])
        self._view = pn.Column(chosen, self.table, tools, self.answer)
        self.show()

    @param.depends("unit", watch=True)
    def show(self, *_: Any) -> None:
        """Show the table of the current design."""
        unit = "" if self.unit == _OWN else self.unit
        try:
            self.table.say(html_of(vendor_block(self.session.design, "d", unit)))
        except InputError as error:
            self.table.say(html_of(Text(str(error))))

    async def _invert(self, _: Any) -> None:
        design = self.session.design
        rows = [line for line in (self.rows.value_input or self.rows.value or "").splitlines() if line.strip()]
        self.answer.object, self._inversion, self.take.visible = "<p role='status'>Solving …</p>", None, False
        try:
            self._inversion = await run_in_pool(invert, design, rows)
        except InputError as error:
            self.answer.object = html_of(Text(f"Not solved. {error.reason if error.key == 'row' else error}"))
            return
        self.answer.object = html_of(*implied_blocks(design, self._inversion))
        self.take.visible = self._inversion.determined

    def _take(self, _: Any) -> None:
        assert self._inversion is not None
        problem = self.session.change(*self._inversion.changes(self.session.design))
        message = (
            f"Not applied. {problem}"
            if problem
            else "Implied noise and its source copied to the design. You can undo."
        )
        self.answer.object = html_of(Text(message))
        self.take.visible = bool(problem)
