"""covariance(spec): the simulator's errors along a flight, in real time and smoothed, with the share of every source.

    time     0 --------- node k-1 ------------ node k ------------ node k+1 ------- end
    forward  P, z:       after its fix,  Phi:  before, then  K, H: after its fix          `_filtered`, `_forward`
    back     L, N:       before its fix, Phi': after,  then (I - K H)': before its fix    `_later`
    aperture             |--- weights on position and velocity at its nodes ---|          `_ends`, `_within`
             A z at its start                                             D n at its end

The gains come from the covariance that the filter believes; every source goes through the same gains, considered
errors among them: one with noise as its own covariance, a constant one as what a sigma of it does to every state. The
smoother is that of Bryson and Frazier, which gives what that of Rauch, Tung and Striebel gives [P-14]: the smoothed
error is e - P λ, with λ a sum over later innovations. Going back along the flight, λ = L z + n, z the errors at that
node and n what later noises add, of which N is the covariance by source.

An image figure is a weighted sum of smoothed errors at the nodes of its aperture, and so a sum of the errors at its
start, the noises within, and n at its end: three parts, independent of each other. In real time the INS is free from
the start on. Sources: Bryson and Ho, *Applied Optimal Control*, ch. 13; Gelb, *Applied Optimal Estimation*, ch. 7.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.simulation.layout import BIASES
from nav_model.trajectory import aperture, residual
from nav_model.trajectory.aperture import COLUMNS, Apertures, apertures_of
from nav_model.trajectory.composition import all_sources, processed
from nav_model.trajectory.errors import MOST_STEPS, ErrorModel, error_model
from nav_model.trajectory.heading import heading_of
from nav_model.trajectory.lines import along, judge
from nav_model.trajectory.residual import since_fix
from nav_model.trajectory.result import LineResult, OnLines, Processed, TrajectoryResult
from nav_model.trajectory.specification import CovarianceSpec
from nav_model.trajectory.start import settled_start
from nav_model.trajectory.states import RADAR_TIME, short_as_white

FloatArray = NDArray[np.float64]
Indices = NDArray[np.int64]
_AXES = 9  # position, velocity, attitude
_BLOCK = 256  # apertures at a time, for memory


class _Filter(NamedTuple):
    """The filter along the flight (k nodes): its covariance after each fix (k, m, m), gain (k, m, r), and H' S⁻¹
    (k, m, r)."""

    covariance: FloatArray
    gain: FloatArray
    weight: FloatArray


class _Sums(NamedTuple):
    """Sums of errors, q at each of some nodes: rows (nodes, q, n) on the errors there, and the variance that later
    noises add by source (noisy, nodes, q)."""

    rows: FloatArray
    added: FloatArray


def covariance(spec: CovarianceSpec, most_steps: int = MOST_STEPS) -> TrajectoryResult:
    """The covariance along the flight of `spec`, which takes `most_steps` steps at most.

    Raises InputError for a flight that cannot be flown or takes more steps, ArithmeticError where the covariance is
    not finite.
    """
    model, figures = _followed(spec, most_steps, (REAL_TIME, POST_PROCESSED))
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
    model, figures = _followed(spec, most_steps, processings, only_lines=True)
    return OnLines(spec, model.time_s[model.outputs], all_sources(spec, model), figures)


def _followed(
    spec: CovarianceSpec, most_steps: int, processings: Sequence[str], *, only_lines: bool = False
) -> tuple[ErrorModel, Mapping[str, Processed]]:
    """The errors along a flight, and its figures by processing."""
    spec = replace(spec, study=short_as_white(spec.study))
    if POST_PROCESSED not in processings:
        spec = replace(spec, flown_further=0.0)
    model = error_model(spec, most_steps)
    if spec.settled:
        start = settled_start(spec.study, model.states, model.truth.at(np.array([0])))
        model = replace(model, states=start)
    if only_lines:
        model = _of_lines(spec, model)
    run, apertures = _filtered(model), apertures_of(model, spec.inputs, spec.study.gnss.interval)
    n, noisy = model.states.size, model.states.noisy
    states, path = (
        _Sums(np.zeros((0, _AXES, n)), np.zeros((noisy, 0, _AXES))),
        _Path(np.zeros((0, 6, n)), np.zeros((noisy, 0, 3, 6))),
    )
    free_rest, images = aperture.free_rest(model.states, spec.inputs), list[_Sums]()
    if REAL_TIME in processings:
        images.append(_free(model, run, apertures))
    if POST_PROCESSED in processings:
        ends, by_innovation = _ends(model, run, apertures)
        reached = aperture.smoother_reaches(free_rest, spec.inputs, spec.study.gnss)
        states, smooth, path = _later(model, run, apertures, ends, whole_path=reached)
        _within(model, run, apertures, smooth, by_innovation)
        images.append(smooth)
    moment = spec.moment if REAL_TIME in processings else ""
    variances, judged, of_images, squares = _forward(model, run, apertures, states, images, path, moment)
    figures = {}
    for name, image in zip(processings, of_images, strict=True):
        _put_residual_biases(spec, model, apertures, name, (variances, judged), image, squares)
        rest, place = free_rest[:, None], int(name == POST_PROCESSED)
        if place and len(path.rows):
            whole = aperture.mean_square(squares, model.time_s, apertures, float(spec.inputs.aperture))
            rest = aperture.smoothed_rest(whole, image, free_rest)
        figures[name] = processed(spec, model, apertures, variances[place], judged[place], image, rest, name)
    return model, figures


def _of_lines(spec: CovarianceSpec, model: ErrorModel) -> ErrorModel:
    """The model with the outputs that count for a line."""
    time_s, ends = model.time_s[model.outputs], [(line.start, line.stop) for line in spec.lines]
    on = np.full(len(time_s), not ends)
    for start, stop in ends:
        stop = min(stop, spec.study.duration) if start < spec.study.duration else stop
        on |= along(start, stop, spec, time_s, image=True) | along(start, stop, spec, time_s, image=False)
    of_outputs = ("outputs", "before", "after", "middle", "output_rows")
    return replace(model, **{name: getattr(model, name)[on] for name in of_outputs})


def _free(model: ErrorModel, run: _Filter, apertures: Apertures) -> _Sums:
    """Sums of the apertures in real time: nothing later is known, and the INS is free from the start on."""
    count = len(apertures.output)
    free = _Sums(np.zeros((count, COLUMNS, model.states.size)), np.zeros((model.states.noisy, count, COLUMNS)))
    _within(model, run, apertures, free, None)
    return free


def _filtered(model: ErrorModel) -> _Filter:
    (k, r, _), m = model.rows.shape, model.states.estimated
    run = _Filter(np.empty((k, m, m)), np.zeros((k, m, r)), np.zeros((k, m, r)))
    identity, p = np.eye(m), model.states.believed
    for node, phi in enumerate(_transitions(model, m)):
        if node:
            p = phi @ p @ phi.T + model.filter_noise[node - 1]
        if model.is_fix[node]:
            rows, variance = model.rows[node, :, :m], model.variance[node]
            cross = p @ rows.T
            inverse = np.linalg.inv(rows @ cross + np.diag(variance))
            gain = cross @ inverse
            update = identity - gain @ rows  # I - K H; by Joseph's form, P stays positive
            p = update @ p @ update.T + (gain * variance) @ gain.T
            run.gain[node], run.weight[node] = gain, rows.T @ inverse
        p = 0.5 * (p + p.T)
        run.covariance[node] = p
    if not np.all(np.isfinite(p)):
        raise ArithmeticError("the filter's covariance is not finite at the end of the flight")
    return run


def _transitions(model: ErrorModel, size: int, *, back: bool = False) -> Iterator[FloatArray]:
    """The transitions to each node from the one before of the first `size` states; to the first node it is zero."""
    blocks = [range(first, min(first + _BLOCK, len(model.time_s))) for first in range(0, len(model.time_s), _BLOCK)]
    for nodes in reversed(blocks) if back else blocks:
        phi = np.zeros((len(nodes), size, size))
        after = slice(1 if nodes.start == 0 else 0, None)
        steps = slice(max(nodes.start - 1, 0), nodes.stop - 1)
        phi[after, :_AXES] = model.phi[steps, :, :size]
        phi.reshape(len(nodes), -1)[after, _AXES * (size + 1) :: size + 1] = model.decay_factor[steps, : size - _AXES]
        yield from reversed(phi) if back else phi


def _along(apertures: Apertures, *, back: bool = False) -> Iterator[tuple[int, Indices, Indices]]:
    """All apertures, node by node along each: which node of it, of which apertures, and that node of the flight."""
    steps = range(apertures.weights.shape[1])
    for block in np.array_split(np.arange(len(apertures.output)), len(apertures.output) // _BLOCK + 1):
        for step in reversed(steps) if back else steps:
            on = block[apertures.first[block] + step <= apertures.last[block]]
            yield step, on, apertures.first[on] + step


def _ends(model: ErrorModel, run: _Filter, apertures: Apertures) -> tuple[FloatArray, FloatArray]:
    """What smoothing adds to the sums of the apertures: weights on λ at the end of each (apertures, COLUMNS, m), and
    on the innovations at its nodes (nodes, apertures, COLUMNS, r)."""
    m, (count, nodes) = model.states.estimated, apertures.weights.shape[:2]
    ends = np.zeros((count, COLUMNS, m))  # D
    by_innovation = np.zeros((nodes, count, COLUMNS, model.rows.shape[1]))
    for step, on, node in _along(apertures):
        d = ends[on]
        if step:
            # λ at the node before is Phi' (H' S⁻¹ r + (I - K H)' λ), with λ and the innovation r of this one.
            moved = d @ model.phi[node - 1, :, :m].swapaxes(1, 2)
            d = np.concatenate([moved, d[:, :, _AXES:] * model.decay_factor[node - 1, None, : m - _AXES]], axis=2)
            by_innovation[step, on] = d @ run.weight[node]
            d -= (d @ model.rows[node, :, :m].swapaxes(1, 2)) @ run.gain[node].swapaxes(1, 2)
        # Smoothing takes P λ off position and velocity here, which have the aperture's weights.
        ends[on] = d - apertures.weights[on, step] @ run.covariance[node, :6]
    return ends, by_innovation


class _Path(NamedTuple):
    """Smoothed position and velocity at every node, as `_Sums`: rows (nodes, 6, n), and what later noises add to the
    covariance of position with both (noisy, nodes, 3, 6)."""

    rows: FloatArray
    added: FloatArray


def _smoothed_at(model: ErrorModel) -> Indices:
    """Nodes at which states are smoothed: those of the outputs, then `middle` of each unless they are the same."""
    same = np.array_equal(model.middle, model.outputs)
    return model.outputs if same else np.concatenate([model.outputs, model.middle])


def _later(
    model: ErrorModel, run: _Filter, apertures: Apertures, ends: FloatArray, *, whole_path: bool
) -> tuple[_Sums, _Sums, _Path]:
    """Position, velocity and roll, pitch, yaw smoothed as of `_smoothed_at`; what λ at the end of each aperture
    adds to its sums, on the errors there; and the smoothed path, of no node unless asked for."""
    m, n, noisy = model.states.estimated, model.states.size, model.states.noisy
    at_nodes, count = _smoothed_at(model), len(model.outputs)
    states = _Sums(np.zeros((len(at_nodes), _AXES, n)), np.zeros((noisy, len(at_nodes), _AXES)))
    images = _Sums(np.zeros((len(ends), COLUMNS, n)), np.zeros((noisy, len(ends), COLUMNS)))
    nodes = len(model.time_s) if whole_path else 0
    path = _Path(np.zeros((nodes, 6, n)), np.zeros((noisy, nodes, 3, 6)))
    driven = [error.source for error in model.states.drives]
    ending, output_of = _by_node(apertures.last), _by_node(at_nodes)
    L, N = np.zeros((m, n)), np.zeros((noisy, m, m))  # at the end of the flight nothing comes later
    last = len(model.time_s) - 1
    for node, phi in zip(range(last, -1, -1), _transitions(model, n, back=True), strict=True):
        # What is asked for at this node: a sum s of the errors here, less s P λ.
        for at in output_of.get(node, ()):
            output_rows = model.output_rows[at % count]
            sums = output_rows[:, :m] @ run.covariance[node]
            states.rows[at] = output_rows - sums @ L
            states.added[:, at] = ((sums @ N) * sums).sum(axis=2)
        for index in ending.get(node, ()):
            images.rows[index] = ends[index] @ L
            images.added[:, index] = ((ends[index] @ N) * ends[index]).sum(axis=2)
        if whole_path:
            p = run.covariance[node, :6]
            path.rows[node] = np.eye(6, n) - p @ L
            path.added[:, node] = p[:3] @ N @ p.T
        if node == 0:
            break
        # Back over the fix: its noise v is in the innovation H z - v, and through the gain in all later ones.
        if model.is_fix[node]:
            rows, gain = model.rows[node], run.gain[node]
            update = np.eye(m) - rows[:, :m].T @ gain.T  # (I - K H)'
            by_noise = update @ L[:, :m] @ gain - run.weight[node]
            L, N = update @ L - by_noise @ rows, update @ N @ update.T
            N[model.measuring] += (by_noise * model.noise[node, :, None, :]) @ by_noise.T
        # Back over the step: z here is Phi z of the node before, and the noise in between.
        factors = L[:, : model.states.moving] @ _factors(model, node)
        N[driven] += factors @ factors.swapaxes(1, 2)
        L, N = phi[:m, :m].T @ L @ phi, phi[:m, :m].T @ N @ phi[:m, :m]
    return states, images, path


def _within(
    model: ErrorModel, run: _Filter, apertures: Apertures, sums: _Sums, by_innovation: FloatArray | None
) -> None:
    """Take the sums from the errors at the end of each aperture to those at its start, with the noises between."""
    radar = model.states.first.get(RADAR_TIME)
    for step, on, node in _along(apertures, back=True):
        # The sum is A z, of the errors z at this node. Position and velocity here have weights of their own; a radar
        # that is late by one second takes them where the aircraft was then.
        A = sums.rows[on]
        A[:, :, :6] += apertures.weights[on, step]
        if radar is not None:
            A[:, :, radar] += np.einsum("acx,ax->ac", apertures.weights[on, step], model.rates[node, :6])
        if step:
            # Back over the fix, of a smoothed sum: z after it is (I - K H) z + K v. In real time the INS is free.
            if by_innovation is not None:
                by_noise = A[:, :, : model.states.estimated] @ run.gain[node] - by_innovation[step, on]
                for place, source in enumerate(model.measuring):
                    sums.added[source, on] += (by_noise**2 * model.noise[node, place][:, None]).sum(axis=2)
                A -= by_noise @ model.rows[node]
            # Back over the step: its noise adds a variance to each sum, its Phi takes z to the node before.
            for place, error in enumerate(model.states.drives):
                factor = model.factors[node - 1, place]
                driven = A[:, :, :_AXES] @ factor[:, :_AXES]
                if error.first >= _AXES:
                    driven += A[:, :, error.first : error.first + 3] @ factor[:, _AXES:]
                sums.added[error.source, on] += (driven**2).sum(axis=2)
            moved = A[:, :, :_AXES] @ model.phi[node - 1]
            moved[:, :, _AXES:] += A[:, :, _AXES:] * model.decay_factor[node - 1, None]
            A = moved
        sums.rows[on] = A


def _forward(
    model: ErrorModel,
    run: _Filter,
    apertures: Apertures,
    states: _Sums,
    images: Sequence[_Sums],
    path: _Path,
    moment: str,
) -> tuple[Sequence[FloatArray], Sequence[FloatArray], FloatArray, FloatArray]:
    """Every source through the same gains.

    Returns in real time and smoothed, where there are such `states`, variances of position, velocity and roll, pitch,
    yaw (sources, outputs, 9) and those by which a flight is judged, at the `moment` of the fix interval, zeros
    without one, and in the middle (sources, outputs, 9); of the sums of the apertures (images, sources, apertures,
    COLUMNS), and covariances of the smoothed position with position and velocity at the nodes of the path (sources,
    nodes, 3, 6).
    """
    errors = model.states
    m, n, s, size, sources = errors.estimated, errors.size, errors.noisy, errors.moving, len(errors.sources)
    count, at_nodes = len(model.outputs), _smoothed_at(model)[: len(states.rows)]
    free, smooth = np.zeros((sources, count, _AXES)), np.zeros((sources, len(at_nodes), _AXES))
    judged = np.zeros_like(free)
    of_images = np.zeros((len(images), sources, len(apertures.output), COLUMNS))
    smooth[:s], of_images[:, :s] = states.added, [part.added for part in images]
    squares = np.zeros((sources, len(path.rows), 3, 6))
    squares[:s] = path.added
    lasts = errors.owner >= s
    owned = np.eye(sources - s)[errors.owner[lasts] - s].T
    constant = errors.initial[:, lasts]  # what each sigma of the constant sources does to every state
    # Z, the covariance of each noisy source, state before source: so both of its products are of large matrices.
    Z = np.zeros((size, s, size))
    for column in np.flatnonzero(~lasts):
        Z[:, errors.owner[column]] += np.outer(errors.initial[:size, column], errors.initial[:size, column])

    def by_source(rows: FloatArray) -> FloatArray:
        """Variances (sources, q) of sums, rows (q, n)."""
        product = (rows[:, :size] @ Z.reshape(size, -1)).reshape(-1, s, size)
        noisy = (product * rows[:, None, :size]).sum(axis=2)
        return np.hstack([noisy, (rows @ constant) ** 2 @ owned.T]).T

    none = np.empty(0, dtype=np.int64)
    starting, smoothed_of = _by_node(apertures.first), _by_node(at_nodes)
    output_of = _by_node(model.outputs if moment else none)
    before_of = _by_node(model.before if moment in ("prior", "closed") else none)
    after_of = _by_node(model.after if moment in ("posterior", "closed") else none)
    driven = [error.source for error in model.states.drives]
    # What comes after the last of these matters to the smoother alone.
    ends = (model.outputs, model.before, at_nodes, apertures.last)
    last = max(int(np.max(nodes, initial=0)) for nodes in ends)
    for node, phi in enumerate(_transitions(model, n)):
        if node > last:
            break
        if node:
            constant, phi = phi @ constant, phi[:size, :size]
            Z = ((phi @ Z.reshape(size, -1)).reshape(-1, size) @ phi.T).reshape(size, s, size)
            factors = _factors(model, node)
            Z[:, driven] += (factors @ factors.swapaxes(1, 2)).swapaxes(0, 1)
        for at in before_of.get(node, ()):
            judged[:, at] += by_source(model.output_rows[at])
        # Over the fix: (I - K H) Z (I - K H)' + K R K', with the true noise R of each source that is measured.
        if node and model.is_fix[node]:
            rows, gain = model.rows[node], run.gain[node]
            constant[:m] -= gain @ (rows @ constant)
            rows = rows[:, :size]
            Z[:m] -= (gain @ (rows @ Z.reshape(size, -1))).reshape(m, s, size)
            Z[:, :, :m] -= ((Z.reshape(-1, size) @ rows.T) @ gain.T).reshape(size, s, m)
            Z[:m, model.measuring, :m] += ((gain * model.noise[node, :, None, :]) @ gain.T).swapaxes(0, 1)
        # Sums of the errors at this node: states, and apertures that start here.
        add_to: list[tuple[FloatArray, FloatArray]] = []
        add_to += [(free[:, at], model.output_rows[at]) for at in output_of.get(node, ())]
        add_to += [(judged[:, at], model.output_rows[at]) for at in after_of.get(node, ())]
        add_to += [(smooth[:, at], states.rows[at]) for at in smoothed_of.get(node, ())]
        for index in starting.get(node, ()):
            add_to += [(part[:, index], sums.rows[index]) for part, sums in zip(of_images, images, strict=True)]
        if add_to:  # all at once, for speed
            whole, first = by_source(np.concatenate([rows for _, rows in add_to])), 0
            for variances, rows in add_to:
                variances += whole[:, first : first + len(rows)]
                first += len(rows)
        if len(path.rows):
            rows = path.rows[node]
            noisy = (rows[:3, :size] @ Z.reshape(size, -1)).reshape(3 * s, size) @ rows[:, :size].T
            squares[:s, node] += noisy.reshape(3, s, 6).swapaxes(0, 1)
            fixed = rows @ constant
            squares[s:, node] += ((fixed[:3, None] * fixed) @ owned.T).transpose(2, 0, 1)
    if moment == "closed":
        judged /= 2.0
    return (free, smooth[:, :count]), (judged, smooth[:, -count:]), of_images, squares


def _put_residual_biases(
    spec: CovarianceSpec,
    model: ErrorModel,
    apertures: Apertures,
    processing: str,
    variances: tuple[Sequence[FloatArray], Sequence[FloatArray]],
    image: FloatArray,
    squares: FloatArray,
) -> None:
    """Put what residual biases make in place of what their sources have, but for the heading. [S-5]

    Parameters
    ----------
    variances : pair
        Of states at the outputs, and of those that are judged, each (sources, outputs, 9) by processing. Changed.
    image : array (sources, apertures, COLUMNS)
        Variances of the sums of the apertures. Changed.
    squares : array (sources, nodes, 3, 6)
        Covariances of the smoothed path, of which they have none. Changed.
    """
    x, interval, smoothed = spec.inputs, spec.study.gnss.interval, processing == POST_PROCESSED
    fixes, place = model.time_s[model.of_position], {name: n for n, name in enumerate(model.states.sources)}
    since = since_fix(fixes, model.time_s[model.outputs], interval)
    for source, made in residual.of_states(x, since, smoothed=smoothed).items():
        for by_processing in variances:
            by_processing[smoothed][place[source], :, : BIASES - 1] = made
        squares[place[source]] = 0.0
    nodes = np.minimum(apertures.first[:, None] + np.arange(apertures.weights.shape[1]), len(model.time_s) - 1)
    ends = np.concatenate([[0.0], fixes])
    last = ends[np.searchsorted(ends, apertures.begin + 1e-6, side="right") - 1]
    after = model.time_s[nodes] - last[:, None]
    for source, made in residual.of_images(x, after, apertures.weights).items():
        image[place[source]] = 0.0 if smoothed else made


def _factors(model: ErrorModel, node: int) -> FloatArray:
    """Factors (drives, moving, 9) of what process noise adds in the step to a node."""
    if model.states.moving == _AXES:
        return model.factors[node - 1, :, :_AXES]
    factors = np.zeros((len(model.states.drives), model.states.moving, 9))
    factors[:, :_AXES] = model.factors[node - 1, :, :_AXES]
    for place, error in enumerate(model.states.drives):
        if error.first >= _AXES:
            factors[place, error.first : error.first + 3] = model.factors[node - 1, place, _AXES:]
    return factors


def _by_node(nodes: Indices) -> Mapping[int, list[int]]:
    indices: dict[int, list[int]] = {}
    for index, node in enumerate(nodes.tolist()):
        indices.setdefault(node, []).append(index)
    return indices
