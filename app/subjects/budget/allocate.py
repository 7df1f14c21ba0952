"""The Allocate page: contributors, further requirements, and who owns how much of each limit."""

import panel as pn

from app.declared import required
from app.document.verdict import verdict_strip
from app.session import Session
from app.subjects.budget.contributors import ContributorsView
from app.ui.answer_strip import AnswerStrip
from app.ui.view import View
from nav_model.budget import Budget


class AllocatePage(View):
    """Everything below the tab."""

    session = required(Session)

    def __init__(self, session: Session) -> None:
        super().__init__(session=session)
        self._strip = AnswerStrip(verdict_strip(session.budget))
        self._contributors = ContributorsView(session)
        self._view = pn.Column(self._strip, self._contributors)
        self.show(session.budget)

    def show(self, budget: Budget) -> None:
        """Follow the current budget."""
        self._strip.show(verdict_strip(budget))
        self._contributors.show(budget)
