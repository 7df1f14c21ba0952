"""Answers worked out in the page's process or in a worker, which loads nothing of the page."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from nav_model.design import Design
from nav_model.design.catalogue import Entry
from nav_model.explore.closing import Closing, closing_sets
from nav_model.explore.levers import Biases
from nav_model.explore.search import Candidate, left_out, own_candidate, search
from nav_model.explore.solve import Solution, solve


@dataclass(frozen=True)
class Ranking:
    """Units or pairs in their order, and the design with the unit in it; the units that cannot be judged, with what
    their sheets lack; and of a ranking in which none passes with the design's residual biases, how many would with
    zero."""

    rows: tuple[Candidate, ...] = ()
    in_design: Candidate | None = None
    left_out: Mapping[str, str] = field(default_factory=dict)
    unbiased: int = 0


def ranked(design: Design, imus: Mapping[str, Entry], receivers: Mapping[str, Entry], biases: Biases) -> Ranking:
    """The ranking of every unit, with every receiver and the design's own.

    Raises InputError as `search`.
    """
    rows, unbiased = search(design, imus, receivers, biases), 0
    if biases == "design" and not any(row.closes for row in rows):
        unbiased = sum(row.closes for row in search(design, imus, receivers, "zero"))
    return Ranking(rows, own_candidate(design), left_out(imus, biases), unbiased)


def changes_that_close(design: Design, options: Mapping[str, Any]) -> tuple[tuple[Solution, ...], Closing]:
    """The largest value of each input, and the smallest sets of levers, `options` as `closing_sets` takes them."""
    return solve(design, verify=False), closing_sets(design, **options)
