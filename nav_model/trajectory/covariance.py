"""covariance(spec): the simulator's errors along a flight, in real time and smoothed, with the share of every source.

The passes along the flight, and their derivation, are in `nav_model.trajectory.passes`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.simulation.layout import BIASES
from nav_model.trajectory import aperture, passes, residual
from nav_model.trajectory.aperture import Apertures, apertures_of
from nav_model.trajectory.composition import all_sources, processed
from nav_model.trajectory.errors import MOST_STEPS, ErrorModel, error_model
from nav_model.trajectory.heading import heading_of
from nav_model.trajectory.lines import along, judge
from nav_model.trajectory.passes import FilterRun, Forward, Sums
from nav_model.trajectory.residual import since_fix
from nav_model.trajectory.result import LineResult, OnLines, Processed, TrajectoryResult
from nav_model.trajectory.specification import CovarianceSpec
from nav_model.trajectory.start import settled_start
from nav_model.trajectory.states import short_as_white

FloatArray = NDArray[np.float64]


def covariance(spec: CovarianceSpec, most_steps: int = MOST_STEPS) -> TrajectoryResult:
    """The covariance along the flight of `spec`, which takes `most_steps` steps at most.

    Raises InputError for a flight that cannot be flown or takes more steps, ArithmeticError where the covariance is
    not finite.
    """
    model, _, figures, _ = followed(spec, (REAL_TIME, POST_PROCESSED), most_steps)
    truth, sources = model.truth.at(model.outputs), all_sources(spec, model)
    real_time, post_processed = figures[REAL_TIME], figures[POST_PROCESSED]
    return TrajectoryResult(
        spec=spec,
        time_s=truth.time_s,
        truth=truth,
        sources=sources,
        real_time=real_time,
        post_processed=post_processed,
        lines=judge(spec, truth.time_s, figures[spec.processing], sources),
        heading=heading_of(replace(spec, study=short_as_white(spec.study)), truth, real_time.attitude[:, 2]),
    )


def lines_along(spec: CovarianceSpec, most_steps: int = MOST_STEPS) -> tuple[LineResult, ...]:
    """The lines of `covariance` alone, in the processing that is judged and where there are lines: less work."""
    on_lines = figures_on_lines(spec, (spec.processing,), most_steps)
    return judge(spec, on_lines.time_s, on_lines.figures[spec.processing], on_lines.sources)


def figures_on_lines(
    spec: CovarianceSpec, processings: Sequence[str] = (REAL_TIME, POST_PROCESSED), most_steps: int = MOST_STEPS
) -> OnLines:
    """The figures of `covariance` where there are lines, in some processings. Raises as that does."""
    model, _, figures, _ = followed(spec, processings, most_steps, only_lines=True)
    return OnLines(spec, model.time_s[model.outputs], all_sources(spec, model), figures)


class Followed(NamedTuple):
    """The errors along a flight, the filter's run, the figures by processing, and variances by source (sources,
    outputs, 9) of position, velocity and roll, pitch, yaw after each fix: by processing, and where that is asked for
    under `passes.DIFFERENCE` of the filter's output less the smoothed one."""

    model: ErrorModel
    run: FilterRun
    figures: Mapping[str, Processed]
    states: Mapping[str, FloatArray]


def followed(
    spec: CovarianceSpec,
    processings: Sequence[str],
    most_steps: int = MOST_STEPS,
    *,
    only_lines: bool = False,
    difference: bool = False,
) -> Followed:
    """`covariance` in parts, for who asks more of the errors along a flight. Raises as that does.

    Parameters
    ----------
    spec : CovarianceSpec
    processings : sequence of str
        Whose figures are asked for.
    most_steps : int, optional
        Steps of the flight at most.
    only_lines : bool, optional
        True for the outputs that count for a line alone.
    difference : bool, optional
        True for the difference of both processings, which are asked for.
    """
    spec = replace(spec, study=short_as_white(spec.study))
    if POST_PROCESSED not in processings:
        spec = replace(spec, flown_further=0.0)
    model = error_model(spec, most_steps)
    if spec.settled:
        start = settled_start(spec.study, model.states, model.truth.at(np.array([0])))
        model = replace(model, states=start)
    if only_lines:
        model = _of_lines(spec, model)
    run, apertures = passes.filtered(model), apertures_of(model, spec.inputs, spec.study.gnss.interval)
    smoothed, images = None, dict[str, Sums]()
    free_rest = aperture.free_rest(model.states, spec.inputs)
    if REAL_TIME in processings:
        images[REAL_TIME] = passes.free(model, run, apertures)
    if POST_PROCESSED in processings:
        ends, by_innovation = passes.end_weights(model, run, apertures)
        reached = aperture.smoother_reaches(free_rest, spec.inputs, spec.study.gnss)
        smoothed = passes.later(model, run, apertures, ends, whole_path=reached)
        passes.within(model, run, apertures, smoothed.images, by_innovation)
        images[POST_PROCESSED] = smoothed.images
    forward = passes.forward(model, run, apertures, images, smoothed, spec.moment, difference=difference)
    figures = {}
    for name in processings:
        _put_residual_biases(spec, model, apertures, forward, name)
        image, rest = forward.images[name], free_rest[:, None]
        if name == POST_PROCESSED and forward.path.shape[1]:
            whole = aperture.mean_square(forward.path, model.time_s, apertures, float(spec.inputs.aperture))
            rest = aperture.smoothed_rest(whole, image, free_rest)
        states, judged = forward.states[name], forward.judged[name]
        figures[name] = processed(spec, model, apertures, states, judged, image, rest, name)
    return Followed(model, run, figures, forward.states)


def _of_lines(spec: CovarianceSpec, model: ErrorModel) -> ErrorModel:
    """The model with the outputs that count for a line."""
    time_s, ends = model.time_s[model.outputs], [(line.start, line.stop) for line in spec.lines]
    on = np.full(len(time_s), not ends)
    for start, stop in ends:
        stop = min(stop, spec.study.duration) if start < spec.study.duration else stop
        on |= along(start, stop, spec, time_s, image=True) | along(start, stop, spec, time_s, image=False)
    of_outputs = ("outputs", "before", "after", "middle", "output_rows")
    return replace(model, **{name: getattr(model, name)[on] for name in of_outputs})


def _put_residual_biases(
    spec: CovarianceSpec, model: ErrorModel, apertures: Apertures, forward: Forward, processing: str
) -> None:
    """Put what residual biases make in place of what their sources have, but for the heading. [S-5]

    Parameters
    ----------
    spec : CovarianceSpec
    model : ErrorModel
    apertures : Apertures
    forward : Forward
        Changed.
    processing : str
    """
    x, interval, smoothed = spec.inputs, spec.study.gnss.interval, processing == POST_PROCESSED
    fixes, place = model.time_s[model.of_position], {name: n for n, name in enumerate(model.states.sources)}
    since = since_fix(fixes, model.time_s[model.outputs], interval)
    for source, made in residual.of_states(x, since, smoothed=smoothed).items():
        for variances in (forward.states[processing], forward.judged[processing]):
            variances[place[source], :, : BIASES - 1] = made
        forward.path[place[source]] = 0.0
    nodes = np.minimum(apertures.first[:, None] + np.arange(apertures.weights.shape[1]), len(model.time_s) - 1)
    ends = np.concatenate([[0.0], fixes])
    last = ends[np.searchsorted(ends, apertures.begin + 1e-6, side="right") - 1]
    after = model.time_s[nodes] - last[:, None]
    for source, made in residual.of_images(x, after, apertures.weights).items():
        forward.images[processing][place[source]] = 0.0 if smoothed else made
