"""Question to a covariance along a flight: the simulator's study, the budget's inputs, and limits.

Immutable and in SI. `SimulationSpec` holds the instruments, the filter, the flight and its outages; `Inputs` has the
aperture at which the design looks to the right, wherever on the flight it lies.
"""

from dataclasses import dataclass, field

from nav_model.budget.contributors import Contributors
from nav_model.budget.inputs import Inputs
from nav_model.design.processing import REAL_TIME
from nav_model.simulation.specification import SimulationSpec

Most = tuple[tuple[str, float], ...]
"""Limits on one sigma, by name of the figure."""


@dataclass(frozen=True)
class FlightLine:
    """A part of the flight on which images are taken; start and stop [s]. most: limits that hold for it in place of
    the flight's."""

    name: str
    start: float
    stop: float
    most: Most = ()


@dataclass(frozen=True, eq=False)
class CovarianceSpec:
    """One covariance along a flight.

    study: its runs and seed mean nothing here. Without lines the whole flight is one. most: limits in the
    `processing` that is judged. contributors: of the user's own, by the figure they enter. every: whether the flight
    judges all requirements on figures that are known along it, not only those that a straight leg does not tell.
    moment: at which states are judged in real time, as `requirements.steady_state`; smoothed_after: how long after a
    fix smoothed ones are [s]. smoother_waits: how long the smoother waits for fixes after an aperture; flown_further:
    how long the flight goes on for it after what is judged [s].
    settled: the flight begins with the covariance of a filter that has settled on a straight leg of its first
    heading, correlations included, where only the heading is the study's initial one; else with the study's start.
    """

    study: SimulationSpec
    inputs: Inputs
    lines: tuple[FlightLine, ...] = ()
    processing: str = REAL_TIME
    most: Most = ()
    contributors: Contributors = field(default_factory=Contributors)
    every: bool = True
    settled: bool = False
    moment: str = "posterior"
    smoothed_after: float = 0.0
    smoother_waits: float = 0.0
    flown_further: float = 0.0
