"""The Allocate page: contributors, further requirements, and who owns how much of each limit."""

from html import escape
from itertools import zip_longest

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import required
from app.document.allocation import SPLIT_WORDS, entry_texts, outcome
from app.document.blocks import Text
from app.document.pane import html_of
from app.document.verdict import verdict_strip
from app.library.texts import counted
from app.session import Session
from app.subjects.budget.tables import CONTRIBUTORS_ENTER
from app.ui.answer_strip import AnswerStrip
from app.ui.fields import TextInput
from app.ui.html_pane import html_pane
from app.ui.row_editor import Field, RowEditor, Rows
from app.ui.theme import FRAME, PRINT_NOTHING
from app.ui.view import View
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.budget.allocation import allocate, check_of
from nav_model.design.contributors import KINDS, PROCESSINGS
from nav_model.design.figures import FIGURES, figure_in_sentence
from nav_model.design.ready_made import READY_MADE, ready_made
from nav_model.design.user_entries import Allotment, read_entries
from nav_model.explore.supplier import released

_FIGURES = tuple((name, figure.label) for name, figure in FIGURES.items())
_CONTRIBUTOR = (
    Field("name", "Contributor", "lever arm", needed=True),
    Field("value", "Value, 1σ", "1 mm", needed=True),
    Field("enters", "Enters", choices=_FIGURES),
    Field("kind", "Kind", choices=tuple((kind, kind) for kind in KINDS)),
    Field("processing", "Processing", choices=tuple((mode, mode) for mode in PROCESSINGS)),
    Field("allowance", "Allowance", "20 %"),
    Field("owner", "Owner", "mechanics"),
    Field("source", "Source", "survey, 2026-03"),
)
_BOX = {"width": 250, "sizing_mode": None}
_ENTRY = (
    *(Field(key, key.capitalize(), read=True) for key in ("source", "allocated", "estimated", "margin", "owner")),
    Field("lock", "Locked at", "free"),
)


def _limit_fields(entries: tuple[tuple[str, str], ...]) -> tuple[Field, ...]:
    return (
        Field("name", "Requirement", "heading after 30 s", needed=True),
        Field("on", "Limits", choices=_FIGURES + entries),
        Field("limit", "Limit", "0.1°", needed=True),
        Field("at", "After the last fix", "end of outage"),
        Field("confidence", "Sigmas", "as the design"),
    )


def _in_the_outage(rows: Rows) -> Rows:
    """Limits as rows, each with a time on the figure of the outage, where a person has named that of the cycle."""
    return [
        row | {"on": after} if row.get("at") and (after := f"coast_{row.get('on')}") in FIGURES else row
        for row in rows
    ]


def _frozen_in_words(plan: Allotment) -> str:
    values = counted(len(plan.required), "value")
    origin = f" with the design {plan.frozen}" if plan.frozen else ""
    return f"The suppliers' sheets require {values} that were frozen{origin}, and do not follow this design."


class AllocatePage(View):
    """Everything below the tab; what is entered becomes part of the design."""

    session = required(Session)

    def __init__(self, session: Session) -> None:
        super().__init__(session=session)
        self._strip = AnswerStrip(verdict_strip(session.budget))
        self._contributors = RowEditor(
            _CONTRIBUTOR, lambda rows: self._enter("contributors", rows), noun="contributor", caption="Contributors"
        )
        self._made = pmui.Select(label="Typical contributors", options=list(READY_MADE), **_BOX)
        self._boxes = [TextInput(max_length=50, **_BOX | {"width": 330}) for _ in range(2)]
        make = pmui.Button(label="Add", variant="outlined", margin=(12, 10))
        make.on_click(lambda _: self._make())
        self._added_note = html_pane("")
        self._made.param.watch(lambda _: self._ask(), "value")
        self._ask()
        ready = pn.FlexBox(
            self._made, *self._boxes, make, align_items="start", margin=(6, 0, 0, 0), stylesheets=[PRINT_NOTHING]
        )
        self._limits = RowEditor(
            _limit_fields(()), lambda rows: self._enter("limits", _in_the_outage(rows)), noun="requirement",
            caption="More requirements",
        )  # fmt: skip
        for editor, what in ((self._contributors, "contributor"), (self._limits, "limit")):
            editor.param.watch(lambda event, what=what: session.refuse(what, int(bool(event.new))), "refused")
        self._requirement = pmui.Select(label="Requirement", **_BOX)
        splits = {words.capitalize(): split for split, words in SPLIT_WORDS.items()}
        self._split = pmui.Select(label="Split", options=splits, **_BOX)
        self._reserve = TextInput(label="Reserve", max_length=20, **_BOX)
        self._entries = RowEditor(_ENTRY, self._lock, caption="Allocation")
        self._outcome = html_pane("")
        self._following = False
        self._requirement.param.watch(lambda _: self._allocate(), "value")
        for choice in (self._split, self._reserve):
            choice.param.watch(lambda _: self._plan(), "value")
        choices = pn.FlexBox(self._requirement, self._split, self._reserve, stylesheets=[PRINT_NOTHING])
        self._frozen = html_pane("")
        self._release = pmui.Button(label="Release required values", variant="outlined", margin=(4, 10))
        self._release.on_click(lambda _: self.session.change({}, entries=released(self.session.design)))
        sheets = pn.Column(self._frozen, self._release, stylesheets=[PRINT_NOTHING])
        cards = (self._contributors, ready, self._added_note), (self._limits,), (
            choices, self._entries, self._outcome, sheets,
        )  # fmt: skip
        self._view = pn.Column(
            self._strip,
            *(pn.Column(*card, styles=FRAME | {"padding": "8px 0"}, margin=(8, 10)) for card in cards),
        )
        self.show(session.budget)

    @param.depends("session.invalid", watch=True)
    def _warn(self) -> None:
        self.show_verdict(self.session.budget)

    def show_verdict(self, budget: Budget) -> None:
        """Follow the verdict alone, which its flight has changed."""
        self._strip.show(verdict_strip(budget).more(self.session.flight_words), self.session.refused)

    def show(self, budget: Budget) -> None:
        """Follow the current budget."""
        self.show_verdict(budget)
        entries, plan = budget.design.entries, budget.design.allocation or Allotment()
        tables = entries.tables()
        limits = tables.get("limits", [])
        if limits != self._limits.rows:  # one of them may be why a contributor was refused
            self._contributors.refused = ""
        names = tuple((part.name, f"Contributor {part.name}") for part in entries.contributors)
        self._contributors.rows = tables.get("contributors", [])
        self._limits.param.update(columns=[field._asdict() for field in _limit_fields(names)], rows=limits)
        self._following = True
        options = {check.label: check.name for check in budget.straight_leg().checks}
        chosen = self._requirement.value
        if chosen not in options.values():
            tightest = budget.straight_leg().tightest
            chosen = tightest.name if tightest else None
        self._requirement.param.update(options=options, value=chosen)
        self._split.value, self._reserve.value = plan.split, str(plan.record()["reserve"])
        self._release.visible = bool(plan.required)
        self._frozen.say(html_of(Text(_frozen_in_words(plan))) if plan.required else "")
        self._following = False
        self._allocate()

    def _allocate(self) -> None:
        """Show the allocation of the requirement that is chosen."""
        budget, requirement = self.session.budget, self._requirement.value
        if self._following:
            return
        plan = budget.design.allocation or Allotment()
        locks = {lock.name: lock.show() for lock in plan.locks if lock.requirement == requirement}
        try:
            check, allocation = check_of(budget, requirement), allocate(budget, requirement)
            texts = entry_texts(budget.design, check, allocation)
            rows = [row | {"lock": locks.get(row["source"], "")} for row in texts]
            text = outcome(budget.design, check, allocation)
        except InputError as error:
            rows = [{"source": source, "lock": lock} for source, lock in locks.items()]
            text = error.reason
        self._entries.rows = rows
        self._outcome.say(html_of(Text(text)))

    def _ask(self) -> None:
        """Ask for the numbers of the formula that is chosen."""
        made = READY_MADE[self._made.value]
        for box, asked in zip_longest(self._boxes, made.boxes):
            if asked:
                box.param.update(label=asked.label, helper_text=f"for example {asked.example}", value="")
            box.visible = asked is not None
        text = f"{made.formula}, enters {figure_in_sentence(made.enters)} [P-16]."
        self._added_note.say(html_of(Text(f"{text[:1].upper()}{text[1:]} {CONTRIBUTORS_ENTER}")))

    def _make(self) -> None:
        """Add the ready-made contributor."""
        refused: InputError | None
        try:
            texts = [box.value for box in self._boxes if box.visible]
            made = ready_made(self._made.value, texts, self.session.design)
            refused = self._enter("contributors", [*self._contributors.rows, made.record()])
        except InputError as error:
            refused = error
        if refused:
            self._added_note.say(f"<p role='alert'>{escape(str(refused))}</p>")
        else:
            self._ask()

    def _enter(self, key: str, table: object) -> InputError | None:
        """Put one of the tables of a design file in force."""
        try:
            return self.session.change({}, entries=read_entries(self.session.design.entries.tables() | {key: table}))
        except InputError as error:
            return error

    def _lock(self, rows: Rows) -> InputError | None:
        sources = [row["source"] for row in self._entries.rows]
        if len(rows) != len(sources):
            return InputError("locks", "The rows have changed meanwhile. Enter the lock again.")
        return self._plan({source: row["lock"] for source, row in zip(sources, rows, strict=True) if "lock" in row})

    def _plan(self, locks: dict[str, str] | None = None) -> InputError | None:
        """Put split, reserve and the `locks` of the requirement shown in force."""
        if self._following:
            return None
        plan = self.session.design.allocation or Allotment()
        by_requirement = dict(plan.record().get("locks", {}))
        if locks is not None:
            by_requirement[self._requirement.value] = locks
        chosen = {"split": self._split.value, "reserve": self._reserve.value, "locks": by_requirement}
        table = plan.record() | chosen  # with what is frozen
        refused = self._enter("allocation", table)
        refused = refused and refused.under(refused.key.split(".", 3)[-1])  # allocation.locks.requirement.source
        if locks is None and refused:
            self._outcome.say(f"<p role='alert'>{escape(str(refused))}</p>")
        return refused
