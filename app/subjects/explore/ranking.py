"""The ranking of sensors, worked out in the page's process or in a worker, which loads nothing of the page."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from nav_model.design import Design
from nav_model.design.catalogue import Entry
from nav_model.explore.search import Biases, Candidate, left_out, own_candidate, search


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
