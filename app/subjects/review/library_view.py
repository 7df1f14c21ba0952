"""The library's part of the Review page: save, find, pick, archive, export and import."""

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass
from functools import partial
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import declared, held
from app.document.blocks import Answer
from app.document.wording import shortened
from app.library.exchange import MAX_ARCHIVE, export_archive, import_archive
from app.library.place import library
from app.library.store import Library, Revision, Saved
from app.library.texts import counted, moment
from app.subjects.review.desk import BUTTON, LOOK, Desk, button, listed
from app.ui.downloads import download
from app.ui.html_pane import html_pane
from app.ui.upload import upload
from app.ui.view import View
from nav_model.base.errors import InputError
from nav_model.design.file import parse_design

_LIBRARY = Answer("Library", "open", ("Opening the library …",))
_SHOWN = 25  # designs listed at once; a search narrows
_ANY = "any tag"
_HINT = '<p class="quiet">Tick designs above to select them, then compare, open, review or export.</p>'
_OPENING = '<p class="quiet">Opening the library …</p>'
_EMPTY = (
    "<p><b>No design saved yet.</b> Enter your name, then press <i>Save as new design</i>. It saves the design "
    "on the left with its verdict. Each later save is a revision that can be compared and reviewed. "
    "For an example, load one from <i>Open, Examples</i> and save it as well.</p>"
)


class LibraryView(View):
    """Actions on the current design above the list, actions on the chosen ones below it."""

    desk = held(Desk)
    answer: Answer = declared(param.ClassSelector(class_=Answer, default=_LIBRARY, instantiate=False))

    def __init__(self, desk: Desk, compare: Callable[[], Awaitable[None]]) -> None:
        super().__init__(desk=desk)
        self._open_designs: set[str] = set()
        self._ticks: list[tuple[str, pmui.Checkbox]] = []  # a design's latest revision may have two
        self._putting = False  # ticks are being set to what is picked
        self._note = pmui.TextInput(label="Note", max_length=4000, width=260, **LOOK)
        self._new = button("Save as new design", partial(self._save, True), variant="contained")
        self._next = button("Save as next revision", partial(self._save, False), visible=False)
        self._search = pmui.TextInput(label="Search name, note, author, tag", width=260, **LOOK)
        self._tag = pmui.Select(label="Tag", options=[_ANY], value=_ANY, width=150, **LOOK)
        self._archived = pmui.Switch(label="Archived", margin=(12, 8))
        self._rows = pn.Column(html_pane(_OPENING), margin=(2, 0))
        self._asked: object = None
        self._listed: _Listing | InputError | None = None
        self._tags = pmui.TextInput(label="Tags, separated by commas", width=220, **LOOK)
        self._bring = upload(
            "Import (zip)", ".zip", MAX_ARCHIVE, self._brought,
            lambda why: self.desk.say(f"Not imported. {why}", wrong=True), icon=None, variant="text", margin=(6, 6),
        )  # fmt: skip
        self._compare = button("Compare", compare, variant="contained")
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
            self._rows,
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
        try:
            listing: _Listing | InputError = await asyncio.to_thread(
                lambda: _listing(library(), search, tag, archived, unfolded)
            )
        except InputError as error:
            listing = error
        if self._asked is not asked or listing == self._listed:  # rows that stay keep the pointer and the focus
            return
        self._listed = listing
        self.answer = _answer(listing)
        if isinstance(listing, InputError):
            self._rows.objects = [html_pane(f"<p>The library cannot be opened. {escape(str(listing))}</p>")]
            return
        self._ticks = []
        rows = [row for saved in listing.found[:_SHOWN] for row in self._design_rows(saved, listing.histories)]
        if not listing.found:
            rows = [html_pane("<p>No design matches.</p>" if listing.narrowed else _EMPTY)]
        if len(listing.found) > _SHOWN:
            rows.append(
                html_pane(
                    f"<p class='quiet'>{_SHOWN} of {len(listing.found)} designs. Search to narrow the list.</p>"
                )
            )
        if listing.read_only:
            rows.insert(0, html_pane("<p>This library is read-only: its file or folder cannot be written.</p>"))
        self._rows.objects = rows
        if self._tag.options != [_ANY, *listing.tags]:
            self._tag.options = [_ANY, *listing.tags]

    def _design_rows(self, saved: Saved, histories: Mapping[str, tuple[Revision, ...]]) -> list[Any]:
        many = saved.number > 1
        shown = saved.design in histories
        history = button(
            f"{'Hide' if shown else 'Show'} {saved.number} revisions" if many else "1 revision",
            partial(self._toggle, saved.design), variant="text", disabled=not many, margin=(0, 4), width=150,
        )  # fmt: skip
        tags = "".join(f'<span class="tag">{escape(tag)}</span>' for tag in saved.tags)
        when = f"<span>{moment(saved.saved)}</span>"
        cells = f'{_verdict(saved.closes, saved.verdict)}<span class="who">{escape(saved.author)}</span>{when}{tags}'
        rows = [self._row(saved, shortened(saved.name, 60), cells, history)]
        if shown and many:
            rows += [
                self._row(r, f"Revision {r.number}: {shortened(r.name, 44)}", _revision_cells(r), None, indent=28)
                for r in histories[saved.design]
            ]
        return rows

    def _row(self, revision: Revision, label: str, cells: str, extra: Any, indent: int = 0) -> pn.FlexBox:
        picked = revision.key in {own.key for own in self.desk.picked}
        tick = pmui.Checkbox(label=label, value=picked, width=330 - indent, margin=(0, 4, 0, 6 + indent))

        def ticked(event: Any) -> None:
            if self._putting:
                return
            if event.new:
                self.desk.pick(revision)
            else:
                self.desk.put_back(revision.key)
            self._picks()  # also where one too many was refused

        tick.param.watch(ticked, "value")
        self._ticks.append((revision.key, tick))
        parts = [tick, html_pane(f'<div class="line">{cells}</div>', margin=(2, 6)), *([extra] if extra else [])]
        parts[1].param.update(sizing_mode=None, styles={"flex": "1 1 280px"})
        return pn.FlexBox(*parts, align_items="center", styles=_RULE)

    async def _toggle(self, design: str) -> None:
        self._open_designs ^= {design}
        await self.refresh()

    # --- the chosen ones -------------------------------------------------------------------------------

    @param.depends("desk.picked", watch=True)
    def _picks(self) -> None:
        picked = {own.key for own in self.desk.picked}
        with pn.io.hold():
            self._putting = True
            try:
                for key, tick in self._ticks:
                    tick.value = key in picked
            finally:
                self._putting = False
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
            said = f"{counted(len(designs), 'design')} {'archived' if hide else 'restored'}; nothing is deleted."
            self.desk.say(said)

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
        self.desk.say(f"Saved: revision {saved.number} of {saved.name}. {saved.verdict}")

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
        done = await self.desk.ask(lambda place: import_archive(place, content, author))
        if done is not None:
            await self.refresh()
            self.desk.say(
                f"Imported {counted(done.designs, 'design')}, {counted(done.revisions, 'revision')}; "
                f"{done.known} here already."
            )


@dataclass(frozen=True)
class _Listing:
    """What a look into the library brings: designs, all tags, the histories that are unfolded, and whether only some
    designs were looked for."""

    found: tuple[Saved, ...]
    tags: tuple[str, ...]
    histories: Mapping[str, tuple[Revision, ...]]
    narrowed: bool
    read_only: bool


def _listing(place: Library, search: str, tag: str, archived: bool, unfolded: frozenset[str]) -> _Listing:
    found = place.designs(search, tag, archived=archived)
    shown = [saved.design for saved in found[:_SHOWN] if saved.design in unfolded]
    histories = {design: place.revisions(design) for design in shown}
    return _Listing(found, place.tags(), histories, bool(search or tag or archived), place.read_only)


def _answer(listing: _Listing | InputError) -> Answer:
    """What is in the library, in a line."""
    if isinstance(listing, InputError):
        return Answer("The library cannot be opened", "bad", (str(listing),))
    closing = sum(saved.closes is True for saved in listing.found)
    what = counted(len(listing.found), "design") + (" found" if listing.narrowed else " saved")
    said = f"{closing} of {len(listing.found)} close." if closing else "None closes."
    said = said if listing.found else "Save the current design."
    return Answer(what, "open", (said,))


_RULE = {"border-bottom": "1px solid color-mix(in srgb, currentColor 12%, transparent)"}


def _verdict(closes: bool | None, whole: str) -> str:
    word = {True: "✓ closes", False: "✗ does not close", None: "– not checked"}[closes]
    return f'<span class="mark" title="{escape(whole)}">{word}</span>'


def _revision_cells(revision: Revision) -> str:
    note = f'<span class="quiet">{escape(shortened(revision.note, 120))}</span>' if revision.note else ""
    origin = " (imported)" if revision.origin else ""
    return (
        f'{_verdict(revision.closes, revision.verdict)}<span class="who">{escape(revision.author)}{origin}</span>'
        f'<span>{moment(revision.saved)}</span><span class="quiet">{revision.content_hash[:12]}</span>{note}'
    )
