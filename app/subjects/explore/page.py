"""The Explore page: what would close the design, what to improve first, and which sensors would close it."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Protocol

import panel as pn

from app.declared import held
from app.document.pane import html_of
from app.session import Session
from app.subjects.explore.map import MapPanel
from app.subjects.explore.ranking import RankPanel
from app.subjects.explore.search import SearchPanel
from app.subjects.explore.tables import answer, solved_blocks, unsolved
from app.subjects.explore.uncertainty import UncertaintyPanel
from app.ui.grid import cell, grid
from app.ui.html_pane import html_pane
from app.ui.turns import in_turns
from nav_model.budget import Budget
from nav_model.explore.solve import Solution, solve


class _Part(Protocol):
    def __panel__(self) -> pn.viewable.Viewable: ...

    def show(self, budget: Budget) -> None: ...


class ExplorePage(pn.viewable.Viewer):
    """Everything below the tab."""

    session = held(Session)

    def __init__(self, session: Session) -> None:
        super().__init__(session=session)
        self._answer = html_pane("")
        self._parts: list[_Part] = []
        cells = [cell(columns) for _, columns in _LAYOUT]
        self._view = pn.Column(self._answer, grid(*cells))
        self._solve(session.budget)

        def add(index: int) -> None:
            self._parts.append(_LAYOUT[index][0](session))
            cells[index].append(self._parts[-1])

        in_turns([partial(add, index) for index in range(len(_LAYOUT))])

    def __panel__(self) -> pn.Column:
        return self._view

    def show(self, budget: Budget) -> None:
        """Follow the budget in force."""
        self._solve(budget)
        for part in self._parts:
            part.show(budget)

    def _solve(self, budget: Budget) -> None:
        solutions: tuple[Solution, ...] = ()
        if budget.verdict.checks:
            try:
                solutions = solve(budget.design, verify="together")
            except ArithmeticError as error:  # a value that does not hold is not shown
                self._answer.object = html_of(unsolved(str(error)))
                return
        self._answer.object = html_of(answer(budget, solutions), *solved_blocks(budget, solutions))


# What makes each part, columns of twelve on a wide screen.
_LAYOUT: tuple[tuple[Callable[[Session], _Part], int], ...] = (
    (MapPanel, 7),
    (RankPanel, 5),
    (SearchPanel, 12),
    (UncertaintyPanel, 12),
)
