"""The state of one user's page: the current design, its budget, and undo.

No widget lives here. Controls call `change`; pages watch `budget`. A refused change leaves everything unchanged and
returns the message to show.
"""

import asyncio
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import param

from app.declared import declared, optional, required
from app.examples import EXAMPLES, example
from app.work.flight import DesignFlight
from app.work.run import Run
from nav_model.base.errors import InputError
from nav_model.budget import Budget, analyse
from nav_model.budget.verdict import flown_names
from nav_model.design import Design, Value
from nav_model.design.declaration import BaseQuantity
from nav_model.design.link import SETTINGS, STUDY_PREFIX, split_link, to_query
from nav_model.design.offers import KINDS, Offers
from nav_model.design.parts import declaration_of
from nav_model.design.several import with_unit
from nav_model.design.user_entries import UserEntries

_SHOWN = "show="
_MOST_TO_SHARE = 2000  # characters that mail programs and chats do not break
_MERGE_SECONDS = 1.0  # steps of one slider closer than this are one step to undo
_HISTORY = 200


class Lineage:
    """The origin of a design and all its changes: ``base`` is the saved revision they came from, if any."""

    def __init__(self) -> None:
        self.base: Any = None


@dataclass(frozen=True)
class Compared:
    """The budget that the current one is compared with, and a name; empty: it was before the last change."""

    budget: Budget
    name: str = ""


class Session(param.Parameterized):
    """The current design and its history.

    ``budget`` changes with every accepted change; ``design`` is always ``budget.design``. ``lineage`` changes when a
    whole design takes the place of another, and is triggered when its base is another. ``running`` is for long work
    of this person alone.

    The flight that the verdict needs is computed in a worker once a design has come to rest. Then the budget has its
    checks, and ``flown`` changes, not ``budget``: what does not read the verdict stays as it is.
    """

    lineage = required(Lineage, constant=False)
    budget = required(Budget, constant=False)
    running = param.Boolean(default=False, doc="Whether a long run of this session is under way.")
    flown = param.Integer(
        default=0, doc="How often the flight of the design has ended: what reads the verdict follows."
    )
    display = param.String(doc="How figures are told, as a link says it (`app.document.display`); empty: as usual.")
    author = param.String(default="", doc="The name typed by whoever saves, signs and keeps; a login goes before it.")
    study_link = param.String(doc="The suborbital study as a link says it; empty until one is linked or changed.")
    settings: dict[str, str] = declared(
        param.Dict(default={}, doc="Kind of study -> its settings as a link says them; usual ones are left out.")
    )
    findings: dict[str, Any] = declared(
        param.Dict(default={}, doc="Kind -> its last finished study, of whatever design.")
    )
    compared = optional(
        Compared, "What the budget is held against: the value before the last change, or a design that was chosen."
    )
    narrow = param.Boolean(default=False, doc="Whether the window was narrow when the page was made, as on a phone.")
    invalid: dict[str, int] = declared(
        param.Dict(default={}, doc="What was typed and refused, and how many: what was valid before counts.")
    )
    adopted = param.Integer(default=0, doc="How often a whole design took the place of another.")
    can_undo = param.Boolean(default=False)
    can_redo = param.Boolean(default=False)

    def __init__(self, design: Design) -> None:
        super().__init__(budget=analyse(design), lineage=Lineage())
        self.start = design
        self.offers: Offers = {kind: {} for kind in KINDS}  # the user's own sensors, beside the catalogue's
        self._past: list[tuple[Design, Lineage]] = []
        self._future: list[tuple[Design, Lineage]] = []
        self._last: tuple[frozenset[str], float] = (frozenset(), 0.0)
        self._follows_changes = True
        self.flight = DesignFlight()
        self.last_flown = self.budget  # with the checks of the last flight, of whatever design
        self._runs: list[Run] = [self.flight.run]
        self.flight.run.param.watch(self._follow_flight, ["result", "message"])
        self._fly()

    def compare(self, chosen: Compared | None) -> None:
        """Compare the budget with a design until another is chosen; None: compare with nothing."""
        self._follows_changes = False
        self.compared = chosen

    def compare_with_changes(self) -> None:
        """Compare the budget with that before the last change, and follow further changes."""
        self._follows_changes = True
        self.compared = self._before(self.budget)

    def _before(self, budget: Budget) -> Compared | None:
        """The design before the last change; the same object as long as the change goes on."""
        if not self._past or self._past[-1][0] == budget.design:
            return None
        old = self._past[-1][0]
        if self.compared is not None and self.compared.budget.design is old:
            return self.compared
        return Compared(self.last_flown if self.last_flown.design == old else analyse(old))

    def new_run(self) -> Run:
        """A run of this session: `running` follows it, and it ends with the session."""
        run = Run()
        self._runs.append(run)
        run.param.watch(self._follow_runs, "running")
        return run

    def _follow_runs(self, *_: Any) -> None:
        self.running = any(run.running for run in self._runs)

    def _fly(self) -> None:
        """Have the design's flight computed once it has come to rest, where the verdict needs it."""
        if self.budget.flight is None and flown_names(self.design):
            self.flight.rest(self.design)
        else:
            self.flight.drop()

    def _follow_flight(self, *_: Any) -> None:
        """Give the budget the checks of its flight; one of a design that has gone meanwhile counts for nothing."""
        flown = self.flight.known(self.design)
        if flown is None and not self.flight.run.message:
            return
        if flown is not None:
            self.keep("trajectory", flown)
            with param.parameterized.discard_events(self):
                self.budget = self._with_flight(self.budget)
        self.flown += 1

    def _with_flight(self, budget: Budget) -> Budget:
        """A budget with the checks of its flight, where the verdict needs one and the last was of its design."""
        flown = self.flight.known(budget.design) if flown_names(budget.design) else None
        if flown is None:
            return budget
        self.last_flown = replace(budget, flight=flown.checks)
        return self.last_flown

    @property
    def flight_words(self) -> str:
        """The reason why checks of the flight are open, in a sentence; empty where none is."""
        if self.budget.flight is not None or not flown_names(self.design):
            return ""
        run = self.flight.run
        return f"The flight is not computed. {run.message}" if run.message else "The flight is being computed."

    async def with_flight(self) -> Budget:
        """The current budget with the checks of its flight, once they are known or cannot be."""
        while self.flight_words and not self.flight.run.message:
            changed = asyncio.Event()
            watcher = self.param.watch(lambda _, changed=changed: changed.set(), ["flown", "budget"])
            try:
                self.flight.begin(self.design)
                await changed.wait()
            finally:
                self.param.unwatch(watcher)
        return self.budget

    def close(self) -> None:
        """End every run, and have nobody follow any more: the person has left, and the charts are gone."""
        for run in self._runs:
            run.drop()
        for followed in (self, *self._runs):
            followed.param.watchers = {}

    def keep(self, kind: str, finding: Any) -> None:
        """Keep a finished study for the report, in place of an earlier one of its kind (`app.report.studies`)."""
        self.findings = {**self.findings, kind: finding}

    def refuse(self, what: str, count: int) -> None:
        """Remember how many of a kind, such as "input", are refused as they were typed."""
        others = {each: number for each, number in self.invalid.items() if each != what}
        invalid = others | {what: count} if count else others
        if invalid != self.invalid:
            self.invalid = invalid

    @property
    def refused(self) -> str:
        """The inputs that are invalid as they were typed, in words; empty if none is."""
        parts = [f"{count} {what}{'' if count == 1 else 's'}" for what, count in self.invalid.items()]
        if not parts:
            return ""
        verb = "is" if sum(self.invalid.values()) == 1 else "are"
        return f"{' and '.join(parts)} {verb} invalid: last valid values used."

    @property
    def design(self) -> Design:
        """The current design."""
        return self.budget.design

    @property
    def link(self) -> str:
        """The current design and its studies' settings, as a link's query."""
        display = f"{_SHOWN}{self.display}" if self.display else ""
        parts = (to_query(self.design), self.study_link, *self.settings.values(), display)
        return "&".join(part for part in parts if part)

    @property
    def short_link(self) -> str:
        """A link to give to others: without the description of an example, or one that makes it long."""
        link = self.link
        if len(link) <= _MOST_TO_SHARE and all(
            self.design.description != example(name).description for name in EXAMPLES
        ):
            return link
        return "&".join(part for part in link.split("&") if not part.startswith("description="))

    def take_studies(self, link: str) -> None:
        """Take the settings of studies from a link (the second part of `split_link`)."""
        parts = link.split("&")

        def of(prefix: str) -> str:
            return "&".join(part for part in parts if part.startswith(prefix))

        self.param.update(study_link=of(STUDY_PREFIX), settings={kind: of(f"{kind}.") for kind in SETTINGS})

    def came_from(self, revision: Any) -> None:
        """The current design is a saved revision: the base of what becomes of it."""
        if self.lineage.base != revision:
            self.lineage.base = revision
            self.param.trigger("lineage")

    def change(
        self,
        changes: Mapping[str, Value],
        written: Mapping[str, str] | None = None,
        origins: Mapping[str, str] | None = None,
        entries: UserEntries | None = None,
    ) -> InputError | None:
        """Apply changes, as `Design.replace` takes them; returns the error message, if any."""
        return self._adopt(
            lambda: self.design.replace(changes, written, origins, entries), frozenset(changes), self.lineage
        )

    def enter(self, key: str, given: Any) -> InputError | None:
        """Apply a text as a person types it, or the rows of a table; returns the error message, if any.

        A bare number takes the unit in force, an empty text leaves out what may be left out.
        """
        declared, unit = declaration_of(key), ""
        try:
            if not isinstance(declared, BaseQuantity):
                value = declared.read(given)
            elif not given.strip() and declared.allow_None:
                value = None
            else:
                value, unit = declared.read(
                    with_unit(given.strip(), self.design.scale(key)), baseline=self.design.baseline
                )
        except InputError as refused:
            return refused
        return self.change({key: value}, {key: unit} if unit else None)

    def adopt(self, design: Design) -> InputError | None:
        """Replace the whole design, which begins a lineage: an opened file, an example, a link."""
        problem = self._adopt(lambda: design, frozenset(), Lineage())
        if problem is None:
            self.adopted += 1
        return problem

    def _adopt(self, make: Callable[[], Design], keys: frozenset[str], lineage: Lineage) -> InputError | None:
        before = self.design
        try:
            design = make()
            if design == before:
                # A unit was chosen, or another origin named: shown, not undone.
                if (design.written, design.origins) != (before.written, before.origins):
                    self.budget = self._with_flight(analyse(design))
                return None
            budget = analyse(design)
        except InputError as error:
            return error
        last_keys, when = self._last
        now = time.monotonic()
        if not (keys and keys == last_keys and now - when < _MERGE_SECONDS and self._past):
            self._past = [*self._past[1 - _HISTORY :], (before, self.lineage)]
        self._last = (keys, now)
        self._future = []
        self._show(budget, lineage)
        return None

    def undo(self) -> None:
        """Back to the design before the last change."""
        if self._past:
            self._future.append((self.design, self.lineage))
            self._step(*self._past.pop())

    def redo(self) -> None:
        """Redo the design that was undone."""
        if self._future:
            self._past.append((self.design, self.lineage))
            self._step(*self._future.pop())

    def reset(self) -> InputError | None:
        """Back to the design the session started with; can be undone."""
        return self.adopt(self.start)

    def _step(self, design: Design, lineage: Lineage) -> None:
        self._last = (frozenset(), 0.0)
        self._show(analyse(design), lineage)

    def _show(self, budget: Budget, lineage: Lineage) -> None:
        budget = self._with_flight(budget)
        with param.parameterized.batch_call_watchers(self):  # "update" looks at every parameter
            if self._follows_changes:
                self.compared = self._before(budget)
            self.budget = budget
            self.can_undo, self.can_redo = bool(self._past), bool(self._future)
            if lineage is not self.lineage:  # what is set counts as changed, be it the same
                self.lineage = lineage
        self._fly()


def link_parts(query: str) -> tuple[str, str, str]:
    """A link's query in three: the design's part, the studies' settings, and the display of figures."""
    of_design, of_study = split_link(query)
    parts = of_design.split("&")
    display = next((part.removeprefix(_SHOWN) for part in parts if part.startswith(_SHOWN)), "")
    return "&".join(part for part in parts if not part.startswith(_SHOWN)), of_study, display
