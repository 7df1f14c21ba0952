"""Runs of one aperture: three axes, exact line of sight, every strategy, and the measures of each run."""

from dataclasses import dataclass

import numpy as np

from nav_model.aperture.window import Window
from nav_model.base.arrays import Array
from nav_model.sar.axis_model import AxisModel
from nav_model.sar.decomposition import Decomposition, autofocus, decompose, fix_rate_harmonics, run_responses
from nav_model.sar.fast_engine import simulate_axis, simulate_histories
from nav_model.sar.focusing import Focusing, after_autofocus
from nav_model.sar.line_of_sight import ApertureGeometry, range_error
from nav_model.sar.strategies import StrategyErrors, Tuning, damping_loop, tracking_filter

FIX_HARMONICS = 3
# Gains the reconstructions are chosen from: wn T and kp T (towards zero both become free INS or an untouched
# position), and ki as a part of kp^2 / 4.
_TRACKING_TURNS = (0.1, 0.3, 1.0, 2.0, 4.0, 8.0, 16.0)
_DAMPING_RATES = (0.1, 0.3, 1.0, 2.0, 4.0, 8.0, 16.0)
_INTEGRAL_PARTS = (0.0, 0.5)


@dataclass(frozen=True)
class RunMeasures:
    """The measures of each run, strategies first; metres of line of sight.

    ``residual`` (10, runs, n): along the line of sight as it turns, after autofocus. ``parts``: name -> (10, runs),
    of the error along the line of sight as it turns, and ``along_track_quadratic``, what the turn adds to the
    quadratic. ``responses``: name ->
    (10, runs). Signed coefficients are given by their magnitude. ``jump_rms`` (runs,): of the filter's jumps at the
    fixes, along the line of sight of mid-aperture. ``fix_harmonics`` (10, runs, h): the ripple's amplitude at 1, 2, 3
    times the fix rate, fewer where half the sampling rate cuts them off. ``fixes``: in the aperture; below three 5
    and 5w are the same as 2.
    """

    time: Array
    residual: Array
    parts: dict[str, Array]
    responses: dict[str, Array]
    jump_rms: Array
    fix_harmonics: Array
    fixes: int


def simulate_axes(
    models: tuple[AxisModel, AxisModel, AxisModel],
    aperture_time: float,
    coast_time: float,
    runs: int,
    seed: np.random.SeedSequence,
    rate: float,
    tuning: Tuning,
) -> list[StrategyErrors]:
    """Every strategy on each axis (along, across, down), each with its own seed.

    Parameters
    ----------
    models : tuple of AxisModel
        Of the axes.
    aperture_time, coast_time, runs, seed, rate, tuning
        As `fast_engine.simulate_axis`.
    """
    return [
        simulate_axis(model, aperture_time, coast_time, runs, axis_seed, rate, tuning)
        for model, axis_seed in zip(models, seed.spawn(3), strict=True)
    ]


def measure_runs(
    axes: list[StrategyErrors],
    geometry: ApertureGeometry,
    wavelength: float,
    fix_interval: float,
    window: Window = "uniform",
    autofocus_order: int = 1,
    focusing: Focusing | None = None,
) -> RunMeasures:
    """Measure strategies already applied to each axis, by either engine.

    Parameters
    ----------
    axes : list of StrategyErrors
        Along, across, down.
    geometry : ApertureGeometry
        Of the aperture.
    wavelength : float
        m.
    fix_interval : float
        Seconds.
    window : str, optional
        Weighting.
    autofocus_order : int, optional
        Of the polynomial that is removed.
    focusing : Focusing, optional
        An autofocus in its place, whose error of estimation is in ``parts["residual_rms"]``.
    """
    along, across, down = axes
    error = range_error(geometry, along.time, along.error, across.error, down.error)
    line = geometry.target / geometry.slant_range
    steady = -sum(part * axis.error for part, axis in zip(line, axes, strict=True))
    jumps = np.sqrt(sum(part**2 * axis.jump_rms**2 for part, axis in zip(line, axes, strict=True)))
    parts = decompose(error, autofocus_order)
    residual = autofocus(error, autofocus_order) if focusing is None else after_autofocus(error, focusing.used)
    measured = {name: np.abs(getattr(parts, name)) for name in Decomposition.__dataclass_fields__}
    if focusing is not None:
        measured["residual_rms"] = np.sqrt(np.mean(residual**2, axis=-1) + focusing.estimation**2)
    measured["along_track_quadratic"] = np.abs(decompose(error - steady).quadratic)
    sampled = int(fix_interval / (2 * (along.time[1] - along.time[0])) + 1e-9)
    return RunMeasures(
        time=along.time,
        residual=residual,
        parts=measured,
        responses=run_responses(4 * np.pi / wavelength * residual, window, autofocus_order),
        jump_rms=np.asarray(jumps),
        fix_harmonics=fix_rate_harmonics(residual, along.time, fix_interval, min(FIX_HARMONICS, sampled)),
        fixes=across.fixes,
    )


def typical_run(rms: Array) -> int:
    """The run (of (10, runs)) whose free INS, strategy 2, is the median one."""
    free = rms[1]
    return int(np.argsort(free)[len(free) // 2])


def choose_tuning(model: AxisModel, aperture_time: float, seed: int = 0, runs: int = 60) -> Tuning:
    """Gains of the reconstructions 6 and 7 with the least median detrended rms, on separate seeds.

    A grid search on one axis; the seeds are never those of a study's runs.

    Parameters
    ----------
    model : AxisModel
        Noise and fixes of the axis.
    aperture_time : float
        Seconds.
    seed, runs : int, optional
        Of the search.
    """
    sequence = np.random.SeedSequence([seed, 1])
    rate = max(min(25.0, 2000.0 / aperture_time), 200.0 / aperture_time)
    h = simulate_histories(model, aperture_time, 0.0, runs, sequence, rate)

    def score(output: Array) -> float:
        return float(np.median(np.sqrt(np.mean(autofocus(output) ** 2, axis=-1))))

    def track(turns: float) -> float:
        tuning = Tuning(natural_frequency=turns / aperture_time)
        return score(tracking_filter(h.time, h.ins_velocity, h.filter_position, h.filter_velocity, tuning))

    def damp(gains: tuple[float, float]) -> float:
        tuning = Tuning(proportional_gain=gains[0], integral_gain=gains[1])
        return score(damping_loop(h.time, h.filter_position, h.fix_time, h.filter_correction, tuning))

    natural = min(_TRACKING_TURNS, key=track) / aperture_time
    pairs = [
        (k / aperture_time, part * (k / aperture_time) ** 2 / 4) for k in _DAMPING_RATES for part in _INTEGRAL_PARTS
    ]
    proportional, integral = min(pairs, key=damp)
    return Tuning(natural_frequency=natural, proportional_gain=proportional, integral_gain=integral)
