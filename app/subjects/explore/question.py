"""Base class of the questions of the page Close it: a view, and an answer for the strip above it."""

from abc import abstractmethod
from typing import ClassVar

import panel as pn
import param

from app.declared import declared, required
from app.document.blocks import Answer
from app.document.closing import ON_FLIGHT
from app.session import Session
from nav_model.budget import Budget
from nav_model.budget.verdict import flown_names
from nav_model.explore.levers import Biases

_ALONG = Answer("Judged along the flight alone", "open", (ON_FLIGHT,))
NO_LIMIT = Answer(
    "No requirement is set", "open", ("Give a limit under Requirements to see which values and sensors meet it.",)
)


def unlimited(budget: Budget) -> Answer:
    """The answer where the straight leg judges nothing: a flight does alone, or nothing is limited."""
    return _ALONG if flown_names(budget.design) else NO_LIMIT


class Question(pn.viewable.Viewer, param.ParameterizedABC):
    """One of the page's views: the page hands it each budget while it is in view."""

    session = required(Session)
    of_design: ClassVar[bool] = True
    """True if the answer is always of the current design, its processing too."""
    biases: Biases = "design"
    """Residual biases that the answer assumes."""
    answer: Answer = declared(param.ClassSelector(class_=Answer, default=NO_LIMIT, instantiate=False))

    @abstractmethod
    def show(self, budget: Budget) -> None:
        """Follow the current budget."""
