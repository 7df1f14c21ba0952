"""The strategies for one design: an ensemble of runs and the closed forms, and their conclusions.

`design_study` does all of it at once. A page that shows progress does the same in steps: `design_case`,
`choose_tuning`, `run_chunk` for each of `chunks(runs, engine)`, `typical_history`, then `gather`. Each chunk has its
own seeds, so the result does not depend on where or in which order they run; they exchange plain data.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import repeat
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.aperture.geometry import metres_to_phase
from nav_model.base.arrays import Array
from nav_model.base.errors import InputError
from nav_model.budget import Budget, analyse
from nav_model.budget.verdict import decisive
from nav_model.design import Design
from nav_model.design.figures import DETRENDED
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.sar.advice import Advice, advise, left_by, spread_of
from nav_model.sar.decomposition import MedianBand, autofocus, band
from nav_model.sar.design_case import DesignCase, Engine, able, conditions, design_case
from nav_model.sar.flown_engine import fly_axes
from nav_model.sar.focusing import focused
from nav_model.sar.line_of_sight import range_error
from nav_model.sar.strategies import NAMES, STRATEGIES, STRATEGY_KEYS, Strategy, StrategyErrors, Tuning
from nav_model.sar.study import RunMeasures, choose_tuning, measure_runs, simulate_axes, typical_run
from nav_model.sar.winners import MAP_STRATEGIES, WORTH, strategy_variances

_CHUNK: dict[Engine, int] = {"fast": 50, "simulator": 10}  # about a second of work
MOST_RUNS = 20_000
# Quadratic phase beyond which 1024 aperture samples are too few for the response: it fills the line.
_NO_IMAGE_RAD = 800.0


@dataclass(frozen=True)
class ClosedForms:
    """Results of the formulas: the advice, and for 2, 3, 5, 5w and 9 the sigmas [m] along the line of sight as it
    turns.

    ``quadratic``: of the coefficient at the aperture's ends; ``detrended``: rms over the aperture of what the
    autofocus leaves. None where fewer than three fixes determine no quadratic.
    """

    advice: Advice
    quadratic: dict[str, float | None]
    detrended: dict[str, float | None]
    required_phase: float | None


class TypicalRun(NamedTuple):
    """Error of each strategy (10, n) in one run, m: less its ``line``, and what the autofocus leaves of it."""

    line: Array
    residual: Array


@dataclass(frozen=True)
class Chunk:
    """Some of the runs: their measures, the residual of each only as its sum of squares (10, n)."""

    measures: RunMeasures
    square: Array
    runs: int


@dataclass(frozen=True)
class SarStudy:
    """Every strategy on one noise realisation a run; strategies first, metres along the line of sight as it turns.

    ``parts``, ``responses``: name -> band (10,); a response is NaN where there is no image. ``rms``: root mean
    square over the runs of the residual after autofocus, ``quadratic_rms`` of the quadratic coefficient: what a
    closed form is compared with; ``rms_error``, ``quadratic_rms_error`` their standard errors.
    ``unfocused``: as ``rms``, with the line alone removed. ``beyond`` (10,): whether the limits of an autofocus are
    not met, so that it removes nothing.
    ``time`` (n,), ``typical``: the run whose free INS is the median one; ``spread`` (10, n): rms over the runs.
    ``engine``: which engine made the runs.
    """

    budget: Budget
    runs: int
    seed: int
    closed: ClosedForms
    parts: dict[str, MedianBand]
    responses: dict[str, MedianBand]
    rms: Array
    rms_error: Array
    unfocused: Array
    beyond: NDArray[np.bool_]
    quadratic_rms: Array
    quadratic_rms_error: Array
    jump_rms: MedianBand
    fix_harmonics: MedianBand
    fixes: int
    time: Array
    typical: TypicalRun
    spread: Array
    tuning: Tuning
    engine: Engine = "fast"

    def best(self, *, causal: bool = False) -> Strategy:
        """The simplest strategy whose residual, rms over the runs, is within 5 % of the least; ``causal``: of those
        that work in flight, before the aperture has ended.

        The whole-leg smoother counts if the design is post-processed.
        """
        keys = self._able(causal)
        least = min(map(self.residual, keys))
        return _named(next(key for key in keys if self.residual(key) <= (1 + WORTH) * least))

    def _able(self, causal: bool = False) -> list[str]:
        """Keys of the candidates, the simplest first."""
        return [key for key in able(self.budget.design) if not causal or _named(key).causal]

    def composed(self, figure: str, sigmas: Array) -> Array:
        """Errors of a phase, strategies first [m], with the design's contributors to it, but for the ideal."""
        to_phase = metres_to_phase(1.0, self.budget.sar.wavelength)
        whole = sigmas.copy()
        for row, strategy in enumerate(STRATEGIES[1:], start=1):
            processing = POST_PROCESSED if strategy.timing == POST_PROCESSED else REAL_TIME
            whole[row] = self.budget[figure, processing].around(to_phase * sigmas[row]).sigma / to_phase
        return whole

    @cached_property
    def residuals(self) -> Array:
        """Residual of each strategy after autofocus, rms over the runs, contributors included [m]."""
        return self.composed(DETRENDED, self.rms)

    def residual(self, key: str) -> float:
        """Residual of one strategy."""
        return float(self.residuals[STRATEGY_KEYS.index(key)])

    @property
    def sentence(self) -> str:
        """A sentence on the strategy that the runs recommend, and whether the formulas agree."""
        smoothed = "9" in self._able()
        best, now, advised = self.best(), self.best(causal=True), self.closed.advice.strategy
        what = "flights of the simulator" if self.engine == "simulator" else "runs"
        least = self.residual(best.key) <= min(map(self.residual, self._able()))
        why = "the least" if least else "the simplest within 5 % of the least"
        spread = spread_of(decisive(self.budget.design, DETRENDED)[0])
        sentence = (
            f"Over {self.runs} {what}, {best.name} leaves {self._in_words(best.key)} {spread} "
            f"{left_by(self.budget)}, {why}."
        )
        if best.timing == POST_PROCESSED:
            sentence += " It needs post-processing."
        if now.key != best.key:
            sentence += f" The best in flight is {now.name} with {self._in_words(now.key)}."
        if not smoothed:
            sentence += f" Post-processed, {NAMES['9']} leaves {self._in_words('9')}."
        if advised not in (best.key, now.key):
            sentence += (
                f" By the formulas, which cover five of the strategies, the best is {NAMES[advised]} "
                f"({self._in_words(advised)})."
            )
        return sentence

    def _in_words(self, key: str) -> str:
        """Residual of a strategy at the confidence of the limit on it, as the advice has it."""
        confidence, _ = decisive(self.budget.design, DETRENDED)
        return f"{1000 * confidence * self.residual(key):.3g} mm"


def _named(key: str) -> Strategy:
    return STRATEGIES[STRATEGY_KEYS.index(key)]


def closed_forms(budget: Budget) -> ClosedForms:
    """The closed forms of a design: a few milliseconds."""
    inputs = conditions(budget)
    variances = strategy_variances(inputs)
    confidence, limit = decisive(budget.design, DETRENDED)
    return ClosedForms(
        advice=advise(inputs, budget.sar.wavelength, limit, confidence),
        quadratic=_by_strategy(variances.quadratic),
        detrended=_by_strategy(variances.detrended),
        required_phase=None if limit is None else limit / confidence,
    )


def chunks(runs: int, engine: Engine = "fast") -> list[int]:
    """Runs of each chunk: whole chunks, then the rest.

    Raises
    ------
    InputError
        For fewer than 20 runs, which give no 5-95 % band, or more than 20,000.
    """
    if not 20 <= runs <= MOST_RUNS:
        raise InputError("runs", f"{runs} is not allowed. Enter 20 to {MOST_RUNS}.", runs)
    size = _CHUNK[engine]
    return [size] * (runs // size) + [runs % size] * (runs % size > 0)


def run_chunk(case: DesignCase, tuning: Tuning, seed: int, index: int, runs: int) -> Chunk:
    """One chunk; deterministic in (seed, index, runs).

    Parameters
    ----------
    case : DesignCase
        The design.
    tuning : Tuning
        Gains of the strategies 6 and 7.
    seed, index, runs : int
        Of the study, place of the chunk in it, and its runs.
    """
    measures = measure_runs(
        _simulated(case, tuning, seed, index, runs), case.geometry, case.wavelength, case.models[1].fix_interval,
        case.window, case.autofocus_order, case.focusing,
    )  # fmt: skip
    square = np.sum(measures.residual**2, axis=1)
    return Chunk(replace(measures, residual=measures.residual[:, :0]), square, runs)


def typical_place(parts: Sequence[Chunk]) -> tuple[int, int, int]:
    """Place of the run to draw: chunk, runs of that chunk, index in it."""
    run = typical_run(_joined([chunk.measures.parts["residual_rms"] for chunk in parts]))
    index, within = divmod(run, parts[0].runs)
    return index, parts[index].runs, within


def typical_history(case: DesignCase, tuning: Tuning, seed: int, index: int, runs: int, within: int) -> TypicalRun:
    """One run, simulated again from its chunk's seed; an autofocus with limits of its own is at work on it.

    Parameters
    ----------
    case, tuning, seed, index, runs
        As `run_chunk`.
    within : int
        Place of the run in its chunk.
    """
    along, across, down = _simulated(case, tuning, seed, index, runs)
    errors = (axis.error[:, within] for axis in (along, across, down))
    error = range_error(case.geometry, along.time, *errors)
    line = autofocus(error)
    if case.focusing is None:
        return TypicalRun(line, autofocus(error, case.autofocus_order))
    to_phase = 4 * np.pi / case.wavelength
    rows = [focused(to_phase * row, case.focusing, seed + place) / to_phase for place, row in enumerate(line)]
    return TypicalRun(line, np.stack(rows))


def gather(
    budget: Budget, case: DesignCase, tuning: Tuning, seed: int, parts: Sequence[Chunk], history: TypicalRun
) -> SarStudy:
    """The study from all its chunks.

    Parameters
    ----------
    budget : Budget
        Of the design.
    case, tuning, seed
        As `run_chunk`.
    parts : sequence of Chunk
        In order.
    history : TypicalRun
        The `typical_history` of its `typical_place`.
    """
    runs = sum(chunk.runs for chunk in parts)
    values = {name: _joined([c.measures.parts[name] for c in parts]) for name in parts[0].measures.parts}
    responses = {name: _joined([c.measures.responses[name] for c in parts]) for name in parts[0].measures.responses}
    quadratic, quadratic_error = _root_mean_square(values["quadratic"])
    beyond = quadratic > (np.inf if case.focusing is None else case.focusing.largest)
    values["residual_rms"] = np.where(beyond[:, None], values["detrended_rms"], values["residual_rms"])
    bands = {name: band(value) for name, value in values.items()}
    to_phase = 4 * np.pi / case.wavelength
    residual = bands["residual_rms"].high
    if case.autofocus_order == 1 and case.focusing is None:
        residual = bands["quadratic"].high
    smeared = (to_phase * residual > _NO_IMAGE_RAD) | beyond
    first = parts[0].measures
    rms, rms_error = _root_mean_square(values["residual_rms"])
    unfocused, _ = _root_mean_square(values["detrended_rms"])
    return SarStudy(
        budget=budget,
        runs=runs,
        seed=seed,
        closed=closed_forms(budget),
        parts=bands,
        responses={name: _without(band(value), smeared) for name, value in responses.items()},
        rms=rms,
        rms_error=rms_error,
        unfocused=unfocused,
        beyond=beyond,
        quadratic_rms=quadratic,
        quadratic_rms_error=quadratic_error,
        jump_rms=band(np.concatenate([c.measures.jump_rms for c in parts])),
        fix_harmonics=band(np.moveaxis(_joined([c.measures.fix_harmonics for c in parts]), 1, -1)),
        fixes=first.fixes,
        time=first.time,
        typical=history,
        spread=np.sqrt(sum(chunk.square for chunk in parts) / runs),
        tuning=tuning,
        engine=case.engine,
    )


def image_study(
    design: Design,
    runs: int = 200,
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
    *,
    engine: Engine = "fast",
    pool: Executor | None = None,
) -> SarStudy:
    """The whole study of one design, in this process or with the chunks sent to a pool.

    Parameters
    ----------
    design : Design
        The design.
    runs, seed : int, optional
        Number of runs, and the seed of their noise.
    progress : callable, optional
        Takes runs done and runs in all.
    engine : str, optional
        The error model or the simulator.
    pool : Executor, optional
        Of the processes that fly the chunks.

    Raises
    ------
    InputError
        See `design_case`.
    ValueError
        See `chunks`.
    ArithmeticError
        Where a flight's filter does not hold.

    Examples
    --------
    >>> from nav_model import image_study, read_design
    >>> design = read_design("examples/mems_x_band.toml")
    >>> image_study(design, runs=20).rms.shape  # m along the line of sight, of ten strategies
    (10,)
    """
    sizes = chunks(runs, engine)
    budget = analyse(design)
    case = design_case(budget, engine)
    tuning = choose_tuning(case.models[1], case.aperture_time, seed)
    parts = []
    run = map if pool is None else pool.map
    for part in run(run_chunk, repeat(case), repeat(tuning), repeat(seed), range(len(sizes)), sizes):
        parts.append(part)
        if progress is not None:
            progress(sum(sizes[: len(parts)]), runs)
    history = typical_history(case, tuning, seed, *typical_place(parts))
    return gather(budget, case, tuning, seed, parts, history)


def _simulated(case: DesignCase, tuning: Tuning, seed: int, index: int, runs: int) -> list[StrategyErrors]:
    if case.flight is None:
        sequence = np.random.SeedSequence([seed, 0, index])
        return simulate_axes(case.models, case.aperture_time, case.coast_time, runs, sequence, case.rate, tuning)
    first = index * _CHUNK["simulator"]
    return fly_axes(case.flight, case.models, case.aperture_time, case.rate, seed, first, runs, tuning)


def _joined(values: Sequence[Array]) -> Array:
    return np.concatenate(values, axis=1)


def _root_mean_square(values: Array) -> tuple[Array, Array]:
    """Over the runs (last axis), with its standard error to first order."""
    square = values**2
    mean = square.mean(axis=-1)
    root = np.sqrt(mean)
    error = square.std(axis=-1) / np.sqrt(values.shape[-1])
    return root, np.divide(error, 2 * root, out=np.zeros_like(root), where=root > 0)


def _without(values: MedianBand, smeared: NDArray[np.bool_]) -> MedianBand:
    return MedianBand(*(np.where(smeared, np.nan, part) for part in (values.median, values.low, values.high)))


def _by_strategy(variances: Array) -> dict[str, float | None]:
    sigma = np.sqrt(variances)
    return {
        key: float(value) if np.isfinite(value) else None for key, value in zip(MAP_STRATEGIES, sigma, strict=True)
    }
