"""The page of a study: one run, its settings in the link, its result, and a strip that says what it is of."""

import asyncio
from dataclasses import replace
from typing import Any, ClassVar, Generic, NamedTuple, TypeVar

import panel as pn
import param

from app.declared import required
from app.document.blocks import Answer
from app.document.moved_inputs import moved_inputs
from app.session import Session
from app.ui.answer_strip import AnswerStrip
from app.ui.follower import Follower
from app.ui.run_bar import RunBar
from app.ui.study_settings import StudySettings
from app.ui.view import View
from app.work.result_cache import cached, keep
from app.work.run import Run
from nav_model.budget import Budget
from nav_model.design import Design
from nav_model.design.declaration import in_sentence

_T = TypeVar("_T")


class _Inputs(NamedTuple):
    """The design and the page's settings that a result is of."""

    design: Design
    settings: dict[str, Any]


class StudyPage(View, Generic[_T]):
    """Begins, recalls, shows and keeps the result of one kind of study.

    A subclass names its ``kind`` (in links, caches and reports), ``settings`` (its parameters that a link holds) and
    ``moving`` (those of them that a result follows from), makes its strip, bar and view, then calls `_open`. It says
    how a study is run (`_study`), what a result means (`_verdict`), what of a design it follows from (`_subject`),
    and writes its charts (`_write`).
    """

    run = required(Run)
    kind: ClassVar[str]
    settings: ClassVar[tuple[str, ...]] = ()
    moving: ClassVar[tuple[str, ...]] = ()
    outdated: ClassVar[str] = "The runs are older than {moved}. Run again."
    of_design: ClassVar[bool] = True
    """True if a study follows from the design, so that an invalid input of it greys the strip."""
    waiting: ClassVar[Answer]
    refusal: ClassVar[str] = "Not run"
    coming: ClassVar[str] = "Appears with the first result."

    _bar: RunBar
    _settings: StudySettings

    def __init__(self, session: Session, **params: Any) -> None:
        super().__init__(run=session.new_run(), **params)
        self._session = session
        self._by_itself = False  # whether the page, not a person, has started the last run
        self._earlier: _T | None = None  # the result when the last run began
        self._drawn: _T | None = None
        self._asked: tuple[str, ...] = ()  # key of the run under way
        self._inputs_of_run: _Inputs | None = None  # of the run under way
        self._inputs: _Inputs | None = None  # of the result that is shown
        self._compared: tuple[_Inputs | None, _Inputs | None, str] = (
            None,
            None,
            "",
        )  # the last two, and what has moved
        self._strip = AnswerStrip(self.waiting)
        self._of_result: Follower[_T] = Follower(lambda: self._result, f"<p class='quiet fine'>{self.coming}</p>")

    def _open(self) -> None:
        """Follow the link, and show what the server still has, or begin: when the page has been made."""
        if self.settings:
            self._settings = StudySettings(self._session, self.kind, self, self.settings, self._recall)
        self._session.param.watch(self.show_verdict, "invalid")
        self._write()
        if not self._recall() and pn.state.curdoc:
            pn.state.onload(self._begin_by_itself)

    def show(self, _: Budget) -> None:
        """Follow the current budget: with a result that the server has, or with a mark on the one of before."""
        if self._result is None or self._outdated:
            self._recall()
        if self.run.running and self._by_itself:  # of a design that is no longer there
            self._begin_by_itself()
        with pn.io.hold():
            self._write()

    def show_verdict(self, _: object) -> None:
        """Follow the verdict alone, which the design's flight or an invalid input has changed."""
        self._strip.show(*self._answer())

    # --- what a subclass says -----------------------------------------------------------------------------

    async def _study(self, run: Run) -> _T:
        """Run the study at the current settings; an InputError or ArithmeticError is told to the person."""
        raise NotImplementedError

    def _verdict(self, result: _T) -> Answer:
        raise NotImplementedError

    def _subject(self, design: Design) -> object:
        """All of a design that a result follows from, to be compared; an InputError where there is none."""
        return design.input_hash

    def _write(self) -> None:
        """Strip, charts and what was unfolded; a text that stays the same is not sent."""
        self._strip.show(*self._answer())

    def _finding(self, result: _T) -> Any:
        """The finding that a report may show of a result; None for nothing."""
        return result

    @property
    def _key(self) -> tuple[str, ...] | None:
        """All that a result follows from, for the cache; None where it is of a file, which has no name there."""
        return self._settings.asked

    @property
    def _invalid(self) -> str:
        """The inputs of the design that are invalid as they were typed, in words; empty if none is."""
        return self._session.refused if self.of_design else ""

    @property
    def _refused(self) -> str:
        """Why an input of the page is refused; empty if none is."""
        return ""

    # --- the run ------------------------------------------------------------------------------------------

    @property
    def _result(self) -> _T | None:
        result: _T | None = self.run.result
        return result

    def begin(self, settle: float = 0.0, *, by_itself: bool = False) -> asyncio.Task[None]:
        """Start the study at the current settings after `settle` seconds; one under way is cancelled.

        ``by_itself``: no person asked for it, and it makes way for a result that the server has.
        """
        self._by_itself, self._earlier = by_itself, self._result

        async def work(run: Run) -> _T:
            await asyncio.sleep(settle)
            self._ask()
            return await self._study(run)

        return self.run.start(work)

    def _ask(self) -> None:
        """Remember the current inputs as those of the run that begins, or of the result that is recalled."""
        self._asked, self._inputs_of_run = self._key or (), self._current_inputs

    @property
    def _current_inputs(self) -> _Inputs:
        return _Inputs(self._session.design, {name: getattr(self, name) for name in self.moving})

    @property
    def _outdated(self) -> str:
        """The inputs that have moved since the result that is shown, in a sentence; empty if it is current."""
        before, now = self._inputs, self._current_inputs
        if before is None or before == now:
            return ""
        if self._compared[:2] != (before, now):
            named = (self.param[name].label for name in self.moving if before.settings[name] != now.settings[name])
            moved = " and ".join(map(in_sentence, named)) or moved_inputs(before.design, now.design, self._subject)
            self._compared = before, now, self.outdated.format(moved=moved) if moved else ""
        return self._compared[2]

    def _begin_by_itself(self) -> None:
        self.begin(by_itself=True)

    def _recall(self) -> bool:
        """Show what this server still has of these settings, unless a person waits for a run. Whether it has any."""
        result = cached(*self._key) if self._key and (self._by_itself or not self.run.running) else None
        if result is None:
            return False
        self._ask()
        self.run.take(result)
        return True

    @param.depends("run.result", "run.running", "run.message", watch=True)
    def _follow_run(self) -> None:
        with pn.io.hold():
            result = self._result
            if result is not None and result is not self._drawn:
                self._drawn = result
                self._inputs = self._inputs_of_run or self._current_inputs
                self._receive(result)
            self._write()

    def _receive(self, result: _T) -> None:
        """Have a new result known to reports and to whoever asks the same."""
        if (finding := self._finding(result)) is not None:
            self._session.keep(self.kind, finding)
        if self._asked:
            keep(result, *self._asked)

    # --- what the strip says ------------------------------------------------------------------------------

    @param.depends("run.progress", watch=True)
    def _tell_progress(self) -> None:
        self._strip.show(*self._answer())

    def _answer(self) -> tuple[Answer, str]:
        """The verdict; in grey, with a note, where it belongs to other inputs than the page has now."""
        result, progress = self._result, self.run.progress
        before = result is self._earlier
        problem = self._refused or (self.run.message if before else "")
        running = f"Running: {progress.words if progress else 'starting'}"
        if result is None:
            if self.run.running:
                return Answer(running, "open", ("The charts follow with the first result.",)), ""
            return (Answer(self.refusal, "warn", (problem,)) if problem else self.waiting), ""
        verdict = self._verdict(result)
        grey = replace(verdict, word=verdict.word.lstrip("✓✗ "), tone="open")
        if self.run.running and before:
            return grey, f"{running}. Showing the previous result."
        outdated = self._outdated
        if problem and (self._refused or outdated or not self.run.cancelled):
            return Answer(self.refusal, "open", (problem, f"The charts show the previous result: {grey.word}.")), ""
        if outdated:
            return grey, outdated
        cancelled = "The last run was cancelled. Showing the previous result." if problem else ""
        return verdict, self._invalid or cancelled

    # --- parts --------------------------------------------------------------------------------------------

    def _say(self, text: str) -> None:
        self._bar.message = text

    def _refuse(self, why: object) -> None:
        self._say(f"Not used. {why}")
