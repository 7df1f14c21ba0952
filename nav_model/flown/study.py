"""Did the flight meet the budget? A solution of it, with or without a second one, against a design."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm

from nav_model.base.errors import InputError
from nav_model.budget.inputs import inputs_of
from nav_model.design import Design
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.flown.budgeted import Budgeted
from nav_model.flown.claims import claimed, claims_of, nees_of
from nav_model.flown.difference import Flown, line_of, together
from nav_model.flown.images import images_of
from nav_model.flown.jumps import jumps_of, step_sigma
from nav_model.flown.noise_fit import receiver_of
from nav_model.flown.noise_scale import Scale, scale_of
from nav_model.flown.relation import LEAST, RELATIONS, Compared, Relation, compare, guessed
from nav_model.flown.result import ALL, FlownLine, FlownResult, Series, overall
from nav_model.flown.solution import Solution
from nav_model.flown.spread import later_fixes
from nav_model.flown.states import AXES, Seen, claimed_by, seen_on, states_of
from nav_model.flown.track import Stretch, Track, track_of
from nav_model.trajectory.covariance import followed

FloatArray = NDArray[np.float64]
_KINDS = ("real-time", "post-processed")
Progress = Callable[[str, float], None]
_DOUBTED = 0.01  # probability below which a relation is named as denied
_LEAST_RATE, _IN_APERTURE = 10.0, 60.0
_ENOUGH = 100.0  # degrees of freedom, at which a sigma is known to 7 %


def flown_study(
    design: Design,
    solution: Solution,
    reference: Solution | None = None,
    *,
    relation: Relation | None = None,
    kind: str = "",
    remove_lag: bool = True,
    progress: Progress = lambda what, share: None,
) -> FlownResult:
    """A flight against the budget of its design: its solution beside a second one, or by its claims alone.

    Parameters
    ----------
    design : Design
        Instruments, radar and requirements; the lines of its plan, where they were flown, are judged.
    solution : Solution
        As `nav_model.flown.files.reader.read_solution` reads it.
    reference : Solution, optional
        The second solution. Without it, claims are set beside the budget, and the verdict cannot be told.
    relation : str, optional
        "smoothed", "reverse" or "independent"; by default what the files tell.
    kind : str, optional
        "real-time" or "post-processed", where the file does not tell or tells the wrong one.
    remove_lag : bool, optional
        False to leave a lag in the difference.
    progress : callable, optional
        Told what is done, and the share of the whole.

    Raises
    ------
    InputError
        Naming what cannot be compared or flown.
    ArithmeticError
        Where the covariance along the track is not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from nav_model import flown_study, parse_design
    >>> from nav_model.flown.solution import Claims, Solution
    >>> time = np.arange(120.0)
    >>> place = np.column_stack([0.8 + 30.0 * time / 6.37e6, 0.2 + 0.0 * time, 500.0 + 0.0 * time])
    >>> claims = Claims("sigma", position=np.full((120, 3), 0.8))
    >>> design = parse_design("requirements.horizontal_position = '1 m'")
    >>> result = flown_study(design, Solution("table", "real-time", time, "", place, claims=claims))
    >>> result.relation, result.verdict, result.reason
    ('claims', 'cannot be told', 'claimed to be met: a claim is no error')
    """
    solution, chosen, notes = _taken(solution, reference, relation, kind)
    progress("compared", 0.1)
    # The covariance follows the better of both along what they have in common.
    compared, flies, time = None, solution, solution.time_s
    if reference is not None:
        compared = compare(solution, reference, _rate(design), remove_lag=remove_lag)
        flies, time = _flown(solution, reference, compared), compared.time_s
        notes += compared.notes
    begin, end = float(time[0]), float(time[-1])
    if end - begin < LEAST:
        reason = f"lasts {end - begin:.1f} s; a flight needs {LEAST:.0f}. Give a longer part of it."
        raise InputError("solution", reason)
    at_fixes = solution.rate_hz * design.gnss.interval < 2.0
    track = track_of(design, flies, begin, end, at_fixes=at_fixes)
    progress("followed", 0.2)
    budgeted = _budgeted(design, track, chosen, solution.kind)
    claims = claims_of(solution, budgeted)
    alone = FlownResult(
        spec=track.spec, solution=solution, relation=chosen, guessed=relation is None, claims=claims,
        verdict="cannot be told", reason=claimed(claims), notes=(*notes, *track.notes),
    )  # fmt: skip
    if compared is None or reference is None:
        return alone
    return _beside(replace(alone, reference=reference, compared=compared), budgeted, compared, flies, progress)


def _beside(
    alone: FlownResult, budgeted: Budgeted, compared: Compared, reference: Solution, progress: Progress
) -> FlownResult:
    """The result with what the difference to a reference shows.

    Parameters
    ----------
    alone : FlownResult
        Of the solution.
    budgeted : Budgeted
    compared : Compared
    reference : Solution
        On the solution's clock.
    progress : callable
    """
    design, solution = budgeted.design, alone.solution
    jumps = jumps_of(compared, solution, design.gnss.interval, step_sigma(budgeted, compared))
    seen = {stretch: seen_on(stretch, budgeted, compared) for stretch in budgeted.track.stretches}
    scale, flown = _scale(budgeted, seen, reference), list[Flown]()
    for number, (stretch, on_it) in enumerate(seen.items()):
        progress(stretch.name, 0.4 + 0.5 * number / len(seen))
        states = states_of(on_it, budgeted, scale, reference) if on_it else {}
        flown.append(line_of(stretch, budgeted, images_of(stretch, budgeted, compared, jumps), states))
    lines = tuple(each.line for each in flown)
    if len(flown) > 1:
        lines = (*lines, together(flown, budgeted))
    verdict, reason = overall(lines)
    denied = _denied(budgeted.relation, reference, lines)
    progress("receiver", 0.95)
    return replace(
        alone,
        jumps=jumps,
        lines=lines,
        nees=nees_of(budgeted.relation, solution, reference, compared, lines),
        receiver=receiver_of(design, compared) if solution.attitude is None else {},
        noise=scale.factors,
        series=_series(budgeted, flown),
        verdict=verdict,
        reason=reason,
        notes=(*alone.notes, denied) if denied else alone.notes,
    )


def _taken(
    solution: Solution, reference: Solution | None, relation: Relation | None, kind: str
) -> tuple[Solution, Relation, list[str]]:
    """The solution with its kind, its relation to the reference, and remarks; InputError for what is not known."""
    if reference is None and relation is not None:
        raise InputError("relation", f"{relation!r} needs a reference. Give the second solution too.", relation)
    if relation is not None and relation not in RELATIONS:
        raise InputError("relation", f"must be one of {', '.join(RELATIONS)}", relation)
    if kind and kind not in _KINDS:
        raise InputError("kind", f"must be one of {', '.join(_KINDS)}", kind)
    solution = replace(solution, kind=kind or solution.kind)
    chosen = relation or guessed(solution, reference)
    notes = [*solution.notes]
    if not solution.kind:
        solution = replace(solution, kind="real-time" if chosen == "smoothed" else "post-processed")
        notes.append(f"taken as {solution.kind}")
    return solution, chosen, notes


def _budgeted(design: Design, track: Track, relation: Relation, kind: str) -> Budgeted:
    """The budget along a flown track, of a solution of this kind and relation to its reference."""
    difference = relation == "smoothed"
    post_processed = kind == "post-processed" and relation not in ("smoothed", "reverse")  # those are of a filter
    processings = (REAL_TIME, POST_PROCESSED) if difference else (POST_PROCESSED if post_processed else REAL_TIME,)
    along_it = followed(track.spec, processings, difference=difference)
    return Budgeted(design, track, along_it, later_fixes(along_it.model, along_it.run), relation, post_processed)


def _rate(design: Design) -> float:
    """Highest rate at which solutions are compared [Hz], so that an aperture has enough samples for its image."""
    return max(_LEAST_RATE, _IN_APERTURE / float(inputs_of(design).aperture))


def _flown(solution: Solution, reference: Solution, compared: Compared) -> Solution:
    """The reference on the solution's clock, with the solution's kinds of fix; its places are flown."""
    lag = compared.lag.value if compared.lag.removed else 0.0
    time = reference.time_s + compared.clock_shift + lag
    kinds = None
    if solution.fix is not None:
        kinds = solution.fix[np.clip(np.searchsorted(solution.time_s, time), 0, len(solution.fix) - 1)]
    return replace(reference, time_s=time, fix=kinds, fix_names=solution.fix_names)


def _scale(budgeted: Budgeted, seen: Mapping[Stretch, Seen | None], reference: Solution) -> Scale:
    """The noise of IMU and receiver over that of the design, by all lines."""
    known = [(stretch.stop - stretch.start, one) for stretch, one in seen.items() if one is not None]
    sources = budgeted.followed.model.states.sources
    if not known or budgeted.relation == "reverse":
        return Scale(np.ones(len(sources)), {})
    time, variances = sum(duration for duration, _ in known), budgeted.followed.states[budgeted.seen]
    of_budget, of_flight = np.zeros(variances.shape[::2]), np.zeros(AXES)
    for duration, one in known:
        of_budget += duration / time * variances[:, one.on].mean(axis=1)
        of_flight += duration / time * one.mean_square
        if budgeted.relation == "independent":  # whose error is no noise of these
            of_flight -= duration / time * claimed_by(reference, one)
    freedom = np.sum([[one.freedom(axis) for axis in range(AXES)] for _, one in known], axis=0)
    return scale_of(sources, of_budget, of_flight, freedom)


def _series(budgeted: Budgeted, flown: list[Flown]) -> Series:
    """The series along time."""
    names = dict.fromkeys(name for each in flown for name in each.apertures)
    apertures = {
        name: np.concatenate([each.apertures.get(name, np.full(len(each.aperture_s), np.nan)) for each in flown])
        for name in names
    }
    spread = budgeted.followed.states[budgeted.seen].sum(axis=0)
    at = np.concatenate([each.aperture_s for each in flown]) if flown else np.zeros(0)
    return Series(at, apertures, budgeted.track.clock.of_solution(budgeted.outputs_s), np.sqrt(spread))


def _denied(relation: Relation, reference: Solution, lines: Sequence[FlownLine]) -> str:
    """Why the data deny that the reference is smoothed, or on which condition the verdict stands."""
    if relation != "smoothed":
        return ""
    condition = "the verdict stands if the reference is the smoothed answer on the same data"
    if reference.kind == "real-time":
        return "the relation is denied: the reference is a real-time solution too"
    # One factor on all figures that noise of an IMU would move apart is none of noise. [P-17]
    logs, weights = list[float](), list[float]()
    for name in ("horizontal_position", "horizontal_velocity", "tilt"):
        known = [line.figures[name] for line in lines if name in line.figures and line.name != ALL]
        known = [one for one in known if one.ratio > 0.0]
        weight = sum(one.freedom for one in known)
        if weight >= _ENOUGH:
            logs.append(sum(one.freedom * math.log(one.ratio) for one in known) / weight)
            weights.append(2.0 * weight)  # the logarithm of a sigma of so many degrees has half their inverse
    if len(logs) < 2:
        return condition
    values, inverse = np.array(logs), np.array(weights)
    common = float(values @ inverse / inverse.sum())
    apart = float((inverse * (values - common) ** 2).sum())
    alike = chi2.sf(apart, len(logs) - 1) > _DOUBTED
    off = 2.0 * norm.sf(abs(common) * math.sqrt(inverse.sum())) < _DOUBTED
    if alike and off:
        factor = math.exp(common)
        return f"the relation is doubtful: all figures are {factor:.2f} times the budget's, which noise does not do"
    return condition
