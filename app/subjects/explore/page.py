"""The page Close it: its questions one at a time, each with its answer above it."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import panel as pn
import param

from app.declared import declared, required
from app.document.blocks import Answer
from app.document.verdict import SAID, verdict_along
from app.session import Session
from app.subjects.explore.closing import ClosingPanel
from app.subjects.explore.map import MapPanel
from app.subjects.explore.question import NO_LIMIT, Question
from app.subjects.explore.search import SearchPanel
from app.subjects.explore.sweep import SweepPanel
from app.subjects.explore.tables import biases_text
from app.subjects.explore.uncertainty import UncertaintyPanel
from app.ui.answer_strip import AnswerStrip
from app.ui.first_screen import screen_of_views
from app.ui.named_views import NamedViews
from app.ui.study_settings import StudySettings
from app.ui.turns import defer
from app.ui.view import View
from nav_model.budget import Budget
from nav_model.budget.verdict import flown_names

QUESTIONS: Mapping[str, type[Question]] = {
    "What would close it": ClosingPanel,
    "Sensors that pass": SearchPanel,
    "Trade-off map": MapPanel,
    "Probability": UncertaintyPanel,
    "Sweep": SweepPanel,
}


class ExplorePage(View):
    """Everything below the tab. A question is made when first asked and follows the design while it is in view."""

    session = required(Session)
    asked: str = declared(param.Selector(objects=list(QUESTIONS), doc="Name of the question in view."))

    def __init__(self, session: Session) -> None:
        super().__init__(session=session)
        self._strip = AnswerStrip(NO_LIMIT)
        self._asked: dict[str, Question] = {}
        self._settings = StudySettings(session, "explore", self, ("asked",), lambda: self.go_to(self.asked))
        self.views = NamedViews("Question", {name: partial(self._ask, name) for name in QUESTIONS})
        self.views.chosen = self.asked
        self.views.param.watch(self._turn, "chosen")
        self.show(session.budget)
        self._view = screen_of_views(self._strip, self.views)

    def _ask(self, name: str) -> Question:
        question = self._asked[name] = QUESTIONS[name](session=self.session)
        question.param.watch(lambda _: self._tell(), "answer")
        return question

    @property
    def question(self) -> Question:
        """The question whose answer is in view."""
        return self._asked[self.views.chosen]

    def show(self, budget: Budget) -> None:
        """Follow the current budget."""
        self.question.show(budget)
        self._tell()

    def _turn(self, event: Any) -> None:
        """Clear the answer to the last question while this one is computed, as a map takes seconds."""
        self.asked, location = event.new, pn.state.location
        if location and "-" in str(location.hash):  # the name of the last question, which would come back
            location.hash = "#close"
        self._strip.show(Answer(event.new, "open", ("Computing …",)))
        defer(lambda: self.show(self.session.budget))

    def show_verdict(self, _: Budget) -> None:
        """Follow the verdict alone, which the design's flight has changed."""
        self._tell()

    @param.depends("session.invalid", watch=True)
    def _tell(self) -> None:
        """Show the answer; where a flight decides too, it is one before the flight, beside the whole verdict."""
        answer, budget = self.question.answer, self.session.budget
        verdict = budget.straight_leg()
        if verdict.checks and self.question.of_design:
            assumed = biases_text(self.session.design, self.question.biases)
            answer = answer.more(f"{assumed}, {SAID[verdict.processing]}.")
            if flown_names(budget.design):
                word = answer.word.lstrip("✓✗ ")
                answer = replace(answer, word=f"Before the flight: {word[:1].lower()}{word[1:]}", tone="open")
        if self.question.of_design and flown_names(budget.design):
            whole = verdict_along(budget.verdict)
            answer = answer.more(f"With the flight: {whole.word}. {whole.sentences[0]}", self.session.flight_words)
        self._strip.show(answer, self.session.refused)

    def go_to(self, place: str) -> None:
        """Ask the question whose name begins like the end of an address, such as "sensors" of "#close-sensors"."""
        place = place.lower().replace(" ", "-")
        name = next((name for name in QUESTIONS if name.lower().replace(" ", "-").startswith(place)), None)
        if name:
            self.views.chosen = name
