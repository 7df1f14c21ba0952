"""Results of a flown flight beside its budget: by line and figure, with the band in which the truth lies."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from nav_model.flown.noise_scale import Factor
from nav_model.flown.relation import Compared, Relation
from nav_model.flown.solution import Solution
from nav_model.trajectory.specification import CovarianceSpec

FloatArray = NDArray[np.float64]
FlownVerdict = Literal["met", "not met", "open", "cannot be told", ""]
"""Of a figure; empty where nothing limits it."""
ALL = "all lines"
FEW = "degrees of freedom; a verdict needs"
CONSISTENT, MORE, LESS = "consistent", "more", "less"


@dataclass(frozen=True)
class Measured:
    """One figure on one line, in SI, all at the confidence of its limit.

    limit: None where nothing limits it. budget: of the design along this track. flown: of the flight, with low_95 and
    high_95 the band in which it lies; nan where there is nothing to tell. freedom: degrees of freedom of its mean
    square. apertures: how many it has, 0 of a state. against_budget: "consistent" where the budget lies in the band,
    else "more" or "less"; empty without a band. ratio: of flown to budget, of navigation alone. reason: why it is
    open or cannot be told.
    """

    limit: float | None
    budget: float
    flown: float
    low_95: float
    high_95: float
    freedom: float
    apertures: int
    verdict: FlownVerdict
    against_budget: str
    ratio: float
    reason: str = ""


@dataclass(frozen=True)
class FlownLine:
    """A line or a straight stretch: start and stop by the solution's clock [s], its figures, and how many apertures
    were left out for a jump, a gap or a change of fix. `ALL` is the name of all lines together."""

    name: str
    start_s: float
    stop_s: float
    figures: Mapping[str, Measured]
    apertures_left_out: int = 0


@dataclass(frozen=True)
class Claimed:
    """Claimed and budgeted sigma of a figure on a line, in SI, both at the confidence and of the worst axis; limit:
    None where nothing limits it."""

    claimed: float
    budget: float
    limit: float | None

    @property
    def claimed_to_be_met(self) -> bool | None:
        """True where the claim is within the limit; None without one."""
        return None if self.limit is None else self.claimed <= self.limit


@dataclass(frozen=True)
class Jump:
    """A jump: when by the solution's clock [s], how far the difference steps [m], 0 for a gap, and why."""

    time_s: float
    size_m: float
    cause: str


@dataclass(frozen=True, eq=False)
class Series:
    """Series along time, by the solution's clock [s]: middles of the apertures (n) and the value of each figure there
    (n), one sigma; and one sigma of the difference by the budget at `budget_s`, of position, velocity and roll,
    pitch, yaw (outputs, 9)."""

    aperture_s: FloatArray
    apertures: Mapping[str, FloatArray]
    budget_s: FloatArray
    budget: FloatArray


@dataclass(frozen=True, eq=False)
class FlownResult:
    """A solution against the budget of a design along its own track.

    guessed: whether the files gave the relation. claims: by line and figure. What follows on the reference is empty
    without one. nees: mean normalised square of the position's difference by the claims over its dimension, its band,
    and the factor that would make the claims true; empty without claims on both sides. receiver: as `noise_fit` gives
    it. noise: how many times as noisy "imu" and "gnss" were as their design.
    """

    spec: CovarianceSpec
    solution: Solution
    relation: Relation
    guessed: bool
    claims: Mapping[str, Mapping[str, Claimed]]
    verdict: FlownVerdict
    reason: str
    notes: tuple[str, ...] = ()
    reference: Solution | None = None
    compared: Compared | None = None
    jumps: tuple[Jump, ...] = ()
    lines: tuple[FlownLine, ...] = ()
    nees: Mapping[str, float] = field(default_factory=dict)
    receiver: Mapping[str, Any] = field(default_factory=dict)
    noise: Mapping[str, Factor] = field(default_factory=dict)
    series: Series | None = None

    @property
    def decisive(self) -> tuple[FlownLine, str, Measured] | None:
        """The limited figure that decides, on its line: the worst against its limit of those with the verdict's
        state; None where nothing is limited."""
        given = [each for each in _deciding(self.lines) if each[2].verdict == self.verdict]
        return max(given, key=lambda each: _size(each[2]), default=None)


def _size(measured: Measured) -> float:
    assert measured.limit is not None
    value = measured.high_95 if math.isfinite(measured.high_95) else measured.budget
    return value / measured.limit


def deciding(lines: tuple[FlownLine, ...], name: str) -> tuple[FlownLine, ...]:
    """The lines whose verdicts on a limited figure count.

    Each stands for itself. Where one is too short to tell and none is beyond its limit, all together decide, as they
    are one measurement of one sigma.
    """
    there = [line for line in lines if name in line.figures and line.figures[name].limit is not None]
    alone = tuple(line for line in there if line.name != ALL)
    whole = tuple(line for line in there if line.name == ALL and line.figures[name].verdict in ("met", "not met"))
    figures = [line.figures[name] for line in alone]
    undecided = [one for one in figures if one.verdict == "open" or FEW in one.reason]
    if not whole or not undecided or any(one.verdict == "not met" for one in figures):
        return alone
    beyond = any(one.limit is not None and one.flown > one.limit for one in undecided)
    return alone if beyond and whole[0].figures[name].verdict == "met" else whole


def _deciding(lines: tuple[FlownLine, ...]) -> list[tuple[FlownLine, str, Measured]]:
    names = dict.fromkeys(name for line in lines for name in line.figures)
    return [(line, name, line.figures[name]) for name in names for line in deciding(lines, name)]


def overall(lines: tuple[FlownLine, ...]) -> tuple[FlownVerdict, str]:
    """The verdict over all lines and limited figures, and its reason in a sentence."""
    limited = _deciding(lines)
    if not lines:
        return "cannot be told", "no straight stretch is as long as an aperture"
    if not limited:
        return "cannot be told", "the design limits no figure that a flight shows"
    order: tuple[FlownVerdict, ...] = ("not met", "cannot be told", "open", "met")
    verdict = min((one.verdict for _, _, one in limited), key=order.index)
    line, name, one = max((each for each in limited if each[2].verdict == verdict), key=lambda each: _size(each[2]))
    return verdict, f"{name} on {line.name}" + (f": {one.reason}" if one.reason else "")


def to_json(result: FlownResult) -> dict[str, Any]:
    """The result as plain data for JSON, in SI; null for what is not known."""
    content = {
        "solution": _solution(result.solution),
        "reference": None if result.reference is None else _solution(result.reference),
        "relation": result.relation,
        "relation_guessed": result.guessed,
        **_fitted(result.compared),
        "jumps": [asdict(jump) for jump in result.jumps],
        "lines": [asdict(line) for line in result.lines],
        "claims": {
            line: {name: asdict(one) | {"claimed_to_be_met": one.claimed_to_be_met} for name, one in figures.items()}
            for line, figures in result.claims.items()
        },
        "nees": result.nees,
        "receiver": result.receiver,
        "noise": {name: asdict(factor) for name, factor in result.noise.items()},
        "notes": list(result.notes),
        "verdict": result.verdict,
        "reason": result.reason,
    }
    return dict(_plain(content))


def _fitted(compared: Compared | None) -> dict[str, Any]:
    """The numbers that were fitted between two solutions."""
    if compared is None:
        return {"lag_s": None, "offset_m": None, "offset_sigma_m": None, "lever_arm_m": None, "remark": ""}
    offset = dict(zip(("north", "east", "down"), compared.offset, strict=True))
    arms = zip(("forward", "right", "down"), compared.lever_arm or (), strict=False)
    return {
        "lag_s": asdict(compared.lag),
        "offset_m": {axis: one.value for axis, one in offset.items()},
        "offset_sigma_m": {axis: one.sigma for axis, one in offset.items()},
        "lever_arm_m": {axis: asdict(arm) for axis, arm in arms} or None,
        "remark": compared.remark,
    }


def _solution(solution: Solution) -> dict[str, Any]:
    return {
        "format": solution.format,
        "kind": solution.kind,
        "rate_hz": solution.rate_hz,
        "duration_s": solution.duration_s,
        "gaps": [list(gap) for gap in solution.gaps],
        "notes": list(solution.notes),
    }


def _plain(values: Any) -> Any:
    """Plain data with null for what is not finite."""
    if isinstance(values, Mapping):
        return {key: _plain(one) for key, one in values.items()}
    if isinstance(values, list | tuple):
        return [_plain(one) for one in values]
    return None if isinstance(values, float) and not math.isfinite(values) else values
