"""The library's part of the Review page: save, find, pick, archive, export and import."""

from collections.abc import Awaitable, Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import declared, required
from app.document.blocks import Answer, Block, Cell, Row, Text, table
from app.document.pane import html_of
from app.document.wording import shortened
from app.library.exchange import MAX_ARCHIVE, add_histories, export_archive, read_archive
from app.library.store import LONGEST_SEARCH, Library, Revision, Saved, flight_of
from app.library.texts import counted, moment
from app.subjects.review.desk import BUTTON, LOOK, Desk, button, listed
from app.ui.downloads import download
from app.ui.fields import TextInput
from app.ui.html_pane import html_pane
from app.ui.sortable_table import WHOLE, SortableTable
from app.ui.upload import upload
from app.ui.view import View
from app.work.pool import run_in_pool
from nav_model.base.errors import InputError
from nav_model.budget.verdict import flies
from nav_model.design.file import parse_design

_LIBRARY = Answer("Library", "open", ("Opening the library …",))
_CLOSED = Answer("The library cannot be opened", "bad", ("The reason is given below.",))
_SHOWN = 25  # designs listed at once; a search narrows
_ANY = "any tag"
_HINT = '<p class="quiet">Tick designs above to select them, then compare, open, review or export.</p>'
_OPENING = '<p class="quiet">Opening the library …</p>'
_HEADS = (("Design", 1.4), ("Verdict", 1.6), "By", "Saved", ("Tags, note", 1.2), "Revisions")
_EMPTY = (
    "No design saved yet. Enter your name, then press “Save as new design”. It saves the current design with its "
    "verdict. Each later save is a revision that can be compared and reviewed. For an example, load one from “Open, "
    "Examples” and save it as well."
)


class LibraryView(View):
    """Actions on the current design above the list, actions on the chosen ones below it."""

    desk = required(Desk)
    answer: Answer = declared(param.ClassSelector(class_=Answer, default=_LIBRARY, instantiate=False))

    def __init__(self, desk: Desk, compare: Callable[[], Awaitable[None]]) -> None:
        super().__init__(desk=desk)
        self._open_designs: set[str] = set()
        self._note = TextInput(label="Note", max_length=4000, width=260, **LOOK)
        self._new = button("Save as new design", partial(self._save, True), variant="contained")
        self._next = button("Save as next revision", partial(self._save, False), visible=False)
        self._search = TextInput(label="Search name, note, author, tag", max_length=LONGEST_SEARCH, width=260, **LOOK)
        self._tag = pmui.Select(label="Tag", options=[_ANY], value=_ANY, width=150, **LOOK)
        self._archived = pmui.Switch(label="Archived", margin=(12, 8))
        self._table = SortableTable(self._toggle, html=_OPENING, margin=(2, 10), stylesheets=[WHOLE])
        self._table.param.watch(self._ticked, "ticked")
        self._asked: object = None
        self._listed: _Listing | None = None
        self._tags = TextInput(label="Tags, separated by commas", width=220, **LOOK)
        self._bring = upload(
            "Import (zip)", ".zip", MAX_ARCHIVE, self._brought,
            lambda why: self.desk.say(f"Not imported. {why}", wrong=True), icon=None, variant="text", margin=(6, 6),
        )  # fmt: skip
        self._compare = button("Compare selected", compare, variant="contained")
        self._actions = [
            self._compare,
            button("Load into editor", self._open),
            button("Archive or restore", self._archive),
            button("Clear", self._clear),
            button("Set tags", self._retag),
        ]
        self._export = download("Export (zip)", "navbudget-library.zip", self._zip, margin=BUTTON["margin"])
        self._chosen = html_pane("", margin=(4, 10))
        self._view = pn.Column(
            pn.FlexBox(self._note, self._new, self._next, align_items="center", margin=(6, 4)),
            pn.FlexBox(
                self._search,
                self._tag,
                self._archived,
                self._bring,
                self._export,
                align_items="center",
                margin=(0, 4),
            ),
            self._table,
            self._chosen,
            pn.FlexBox(*self._actions[:-1], self._tags, self._actions[-1], align_items="center", margin=(0, 4)),
        )
        self._say_picked()
        for field in (self._search, self._tag, self._archived):
            field.param.watch(self._look_again, "value")
        self._based()

    async def _look_again(self, _: Any) -> None:
        await self.refresh()

    # --- the list --------------------------------------------------------------------------------------

    async def refresh(self) -> None:
        """List what the library holds now; where several ask at once, the last one's answer is shown."""
        self._asked = asked = object()
        tag = "" if self._tag.value == _ANY else self._tag.value
        search, archived, unfolded = self._search.value or "", self._archived.value, frozenset(self._open_designs)
        listing = await self.desk.ask(lambda place: _listing(place, search, tag, archived, unfolded))
        if self._asked is not asked or (listing and listing == self._listed):  # rows that stay keep the focus
            return
        self._listed = listing
        self.answer = _answer(listing) if listing else _CLOSED
        self._table.html = html_of(*_blocks(listing)) if listing else ""
        if listing and self._tag.options != [_ANY, *listing.tags]:
            self._tag.options = [_ANY, *listing.tags]

    async def _toggle(self, design: str) -> None:
        self._open_designs ^= {design}
        await self.refresh()

    # --- the chosen ones -------------------------------------------------------------------------------

    def _ticked(self, event: Any) -> None:
        """Pick what was ticked, unless as many are picked as go side by side."""
        revisions = self._listed.revisions if self._listed else ()
        known = {revision.key: revision for revision in (*self.desk.picked, *revisions)}
        self.desk.pick([revision for key, revision in known.items() if key in event.new])
        self._picks()  # also where one too many was refused

    @param.depends("desk.picked", watch=True)
    def _picks(self) -> None:
        self._table.ticked = [revision.key for revision in self.desk.picked]
        self._say_picked()

    def _say_picked(self) -> None:
        picked = self.desk.picked
        self._chosen.object = listed(picked, "Selected designs") if picked else _HINT
        for action in self._actions:
            action.disabled = not picked
        self._compare.disabled = len(picked) < 2

    async def _clear(self) -> None:
        self.desk.picked = ()

    async def _open(self) -> None:
        last = self.desk.picked[-1]
        try:
            problem = self.desk.session.adopt(parse_design(last.text, f"revision {last.number}"))
        except InputError as error:
            problem = error
        if problem is not None:
            self.desk.say(f"Not opened. {problem}", wrong=True)
            return
        self.desk.session.came_from(last)
        self.desk.say(f"Revision {last.number} of {last.name} is loaded into the editor. You can undo.")

    async def _archive(self) -> None:
        designs = {revision.design for revision in self.desk.picked}
        hide = not self._archived.value

        def work(place: Library) -> bool:
            for design in designs:
                place.archive(design, hide)
            return True

        if await self.desk.ask(work):
            self.desk.picked = ()
            await self.refresh()
            text = f"{counted(len(designs), 'design')} {'archived' if hide else 'restored'}; nothing is deleted."
            self.desk.say(text)

    async def _retag(self) -> None:
        designs = {revision.design for revision in self.desk.picked}
        line = self._tags.value or ""
        if await self.desk.ask(lambda place: [place.retag(design, line) for design in designs]):
            self._tags.value = ""
            await self.refresh()

    # --- saving, in and out ----------------------------------------------------------------------------

    @param.depends("desk.session.lineage", watch=True)
    def _based(self) -> None:
        base = self.desk.base
        self._next.visible = base is not None
        if base is not None:
            self._next.label = f"Save as revision {base.number + 1} of {shortened(base.name, 30)}"

    async def _save(self, new: bool) -> None:
        base = None if new else self.desk.base
        budget, author, note = self.desk.session.budget, self.desk.who, self._note.value or ""
        if flies(budget.design) and budget.flight is None:
            budget = replace(budget, flight=await run_in_pool(flight_of, budget))

        def work(place: Library) -> Revision:
            if base is None:
                return place.save(budget, author, note)
            return place.save(budget, author, note, design=base.design, base=base.number)

        saved = await self.desk.ask(work)
        if saved is None:
            if base is not None:
                await self._catch_up(base)
            return
        self._note.value = ""
        self.desk.session.came_from(saved)
        await self.refresh()
        self.desk.say(f"Saved: revision {saved.number} of {saved.name}.")

    async def _catch_up(self, base: Revision) -> None:
        """After somebody else's save: the next save is on top of theirs, as the button then says."""
        history = await self.desk.ask(lambda place: place.revisions(base.design))
        if history and history[0].number != base.number:
            self.desk.session.came_from(history[0])
            await self.refresh()

    async def _zip(self) -> bytes:
        picked = [revision.design for revision in self.desk.picked]

        def work(place: Library) -> bytes:
            everything = (*place.designs(), *place.designs(archived=True))
            return export_archive(place, picked or [saved.design for saved in everything])

        return await self.desk.ask(work) or b""

    async def _brought(self, _: str, content: bytes) -> None:
        author = self.desk.who or "not stated"
        try:
            histories = await run_in_pool(read_archive, content, author)
        except InputError as error:
            self.desk.say(f"Not imported. {error}", wrong=True)
            return
        done = await self.desk.ask(lambda place: add_histories(place, histories))
        if done is not None:
            await self.refresh()
            self.desk.say(
                f"Imported {counted(done.designs, 'design')}, {counted(done.revisions, 'revision')}; "
                f"{done.known} here already."
            )


@dataclass(frozen=True)
class _Listing:
    """Result of a look into the library: designs, all tags, the histories that are unfolded, and whether only some
    designs were looked for."""

    designs: tuple[Saved, ...]
    tags: tuple[str, ...]
    histories: Mapping[str, tuple[Revision, ...]]
    narrowed: bool
    read_only: bool

    @property
    def revisions(self) -> Iterator[Revision]:
        """Rows of the list: each design, with its revisions where they are unfolded."""
        for saved in self.designs[:_SHOWN]:
            yield saved
            yield from self.histories.get(saved.design, ())


def _listing(place: Library, search: str, tag: str, archived: bool, unfolded: frozenset[str]) -> _Listing:
    designs = place.designs(search, tag, archived=archived)
    names = [saved.design for saved in designs[:_SHOWN] if saved.design in unfolded and saved.number > 1]
    histories = {design: place.revisions(design) for design in names}
    return _Listing(designs, place.tags(), histories, bool(search or tag or archived), place.read_only)


def _blocks(listing: _Listing) -> Iterator[Block]:
    """The list, or why it is empty."""
    if listing.read_only:
        yield Text("This library is read-only: its file or folder cannot be written.")
    if not listing.designs:
        yield Text("No design matches." if listing.narrowed else _EMPTY)
        return
    many = len(listing.designs) > _SHOWN
    more = f"{_SHOWN} of {len(listing.designs)} designs. Search to narrow the list." if many else ""
    rows = (_row(revision, listing) for revision in listing.revisions)
    yield table("library", "Saved designs", _HEADS, rows, more, ticks=True)


def _row(revision: Revision, listing: _Listing) -> Row:
    whole = isinstance(revision, Saved)
    name = shortened(revision.name, 60) if whole else f"Revision {revision.number}: {shortened(revision.name, 44)}"
    more, unfold = f"{revision.content_hash[:12]} {shortened(revision.note, 120)}", Cell("")
    if isinstance(revision, Saved):
        more, unfold = ", ".join(revision.tags), Cell("1 revision")
        if revision.number > 1:
            verb = "Hide" if revision.design in listing.histories else "Show"
            unfold = Cell(f"{verb} {revision.number} revisions", value=revision.design)
    return (
        Cell(name, value=revision.key),
        revision.verdict.partition(" Tightest: ")[0],
        f"{revision.author}{' (imported)' if revision.origin and not whole else ''}",
        moment(revision.saved),
        more,
        unfold,
    )


def _answer(listing: _Listing) -> Answer:
    """Content of the library, in a line."""
    closing = sum(saved.closes is True for saved in listing.designs)
    what = counted(len(listing.designs), "design") + (" found" if listing.narrowed else " saved")
    sentence = f"{closing} of {len(listing.designs)} close." if closing else "No design closes."
    if unknown := sum(saved.closes is None for saved in listing.designs):
        sentence += f" {counted(unknown, 'design')} without a verdict."
    sentence = sentence if listing.designs else "Save the current design."
    return Answer(what, "open", (sentence,))
