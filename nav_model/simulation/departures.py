"""Where the closed form and the simulation part, and why: findings a page or a report can print."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nav_model.simulation.result import STATES, SimulationResult
from nav_model.simulation.single_run import POSTERIOR

REASONS = {
    "settling": "the filter is still settling from its initial errors; the closed form is the steady state",
    "fixes": "just after a fix a sampled filter is better than the closed form, a mean over the cycle [T-8]",
    "filter": "the filter is not the closed form's: other states, tuning, or sensor errors [T-1]",
    "earth": "gravity with height, Coriolis and transport terms grow in the vertical channel [T-17]",
    "start": "the outage starts just after a fix, below the closed form, and Schuler's term acts [T-17]",
    "yaw": "turns and sideways acceleration make yaw observable, or the initial yaw differs, against [T-5]",
}


@dataclass(frozen=True)
class Departure:
    """One state over one phase of the flight: `ratio` is filter sigma over closed form where they differ
    most.

    group, axis: as in the JSON; start_s, stop_s: when they differ by more than the tolerance; reason: why, in
    words.
    """

    group: str
    axis: str
    start_s: float
    stop_s: float
    ratio: float
    reason: str


def departures(result: SimulationResult, tolerance: float = 0.1, settling_s: float = 60.0) -> list[Departure]:
    """Where filter sigma and closed form differ by more than `tolerance` (relative), one finding per state
    and phase.

    Compares the filter's sigma, which has no sampling noise, after the fix. The phases are the first
    `settling_s` seconds, the time with fixes, and the outages. Empty where no closed form was given.
    """
    if result.closed_form_sigma is None:
        return []
    coasting = result.coast_s > 0.0
    settling = (result.time_s < settling_s) & ~coasting
    found = []
    for column, (group, axis, _unit) in enumerate(STATES):
        ratio = result.filter_sigma[POSTERIOR, :, column] / result.closed_form_sigma[:, column]
        for phase, mask in (("settling", settling), ("aided", ~settling & ~coasting), ("coast", coasting)):
            apart = np.flatnonzero(mask & (np.abs(ratio - 1.0) > tolerance))
            if len(apart) == 0:
                continue
            worst = apart[np.argmax(np.abs(np.log(ratio[apart])))]
            reason = REASONS[_reason(phase, group, axis, float(ratio[worst]))]
            times = result.time_s[apart]
            found.append(Departure(group, axis, float(times[0]), float(times[-1]), float(ratio[worst]), reason))
    return found


def _reason(phase: str, group: str, axis: str, ratio: float) -> str:
    if axis == "yaw":
        return "yaw"
    if phase == "settling":
        return "settling"
    if phase == "aided":
        return "fixes" if 0.6 < ratio < 1.0 and group != "attitude" else "filter"
    if axis == "down":
        return "earth"
    return "start" if 0.8 < ratio < 1.0 else "filter"
