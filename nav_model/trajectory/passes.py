"""The passes along a flight: the filter, the smoother's sums back, and every source forward through the same gains.

    time     0 --------- node k-1 ------------ node k ------------ node k+1 ------- end
    forward  P, z:       after its fix,  Phi:  before, then  K, H: after its fix          `filtered`, `forward`
    back     L, N:       before its fix, Phi': after,  then (I - K H)': before its fix    `later`
    aperture             |--- weights on position and velocity at its nodes ---|          `end_weights`, `within`
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

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.trajectory.aperture import COLUMNS, Apertures
from nav_model.trajectory.errors import ErrorModel
from nav_model.trajectory.states import RADAR_TIME

FloatArray = NDArray[np.float64]
Indices = NDArray[np.int64]
DIFFERENCE = "difference"
"""The filter's output less the smoothed one, beside the processings."""
_AXES = 9  # position, velocity, attitude
_BLOCK = 256  # apertures at a time, for memory
_Asked = defaultdict[int, list[tuple[FloatArray, FloatArray]]]
"""Node -> where variances of sums of the errors there are added, (sources, q), and rows (q, n) of the sums."""


class FilterRun(NamedTuple):
    """The filter along the flight (k nodes): its covariance after each fix (k, m, m), gain (k, m, r), and H' S⁻¹
    (k, m, r)."""

    covariance: FloatArray
    gain: FloatArray
    weight: FloatArray


class Sums(NamedTuple):
    """Sums of errors, q at each of some nodes: rows (nodes, q, n) on the errors there, and the variance that later
    noises add by source (noisy, nodes, q). Of the smoothed path, position and velocity at every node: q is 6, and
    `added` is the covariance of position with both (noisy, nodes, 3, 6)."""

    rows: FloatArray
    added: FloatArray


class Smoothed(NamedTuple):
    """Sums that give smoothed errors: `states` position, velocity and roll, pitch, yaw as of `_smoothed_at`, `images`
    those of the apertures, and the `path`, of no node unless asked for."""

    states: Sums
    images: Sums
    path: Sums


class Forward(NamedTuple):
    """Variances by source of the errors along a flight.

    states, judged: by processing, of position, velocity and roll, pitch, yaw (sources, outputs, 9), at the outputs
    and at the moment by which a flight is judged. images: by processing, of the sums of the apertures (sources,
    apertures, COLUMNS). path: covariances of the smoothed position with position and velocity at the nodes (sources,
    nodes, 3, 6), of no node unless the path is asked for.
    """

    states: Mapping[str, FloatArray]
    judged: Mapping[str, FloatArray]
    images: Mapping[str, FloatArray]
    path: FloatArray


class _Errors:
    """The errors of every source at a node of the flight, as they are carried along it.

    Z (moving, noisy, moving) is the covariance of each noisy source, state before source: so both of its products are
    of large matrices. constant (n, starts) is what each sigma of the constant sources does to every state.
    """

    def __init__(self, model: ErrorModel, run: FilterRun) -> None:
        states = self._states = model.states
        self._model, self._run = model, run
        self._driven = [error.source for error in states.drives]
        size, noisy = states.moving, states.noisy
        lasts = states.owner >= noisy
        self._owned = np.eye(len(states.sources) - noisy)[states.owner[lasts] - noisy].T
        self.constant = states.initial[:, lasts]
        self.Z = np.zeros((size, noisy, size))
        for column in np.flatnonzero(~lasts):
            start = states.initial[:size, column]
            self.Z[:, states.owner[column]] += np.outer(start, start)

    def step(self, phi: FloatArray, node: int) -> None:
        """Go on to a node, to which `phi` (n, n) leads, with the noise in between."""
        size, noisy = self._states.moving, self._states.noisy
        self.constant, phi = phi @ self.constant, phi[:size, :size]
        self.Z = ((phi @ self.Z.reshape(size, -1)).reshape(-1, size) @ phi.T).reshape(size, noisy, size)
        factors = _factors(self._model, node)
        self.Z[:, self._driven] += (factors @ factors.swapaxes(1, 2)).swapaxes(0, 1)

    def fix(self, node: int) -> None:
        """Take a fix: (I - K H) Z (I - K H)' + K R K', with the true noise R of each source that is measured."""
        model, size, noisy, m = self._model, self._states.moving, self._states.noisy, self._states.estimated
        rows, gain = model.rows[node], self._run.gain[node]
        self.constant[:m] -= gain @ (rows @ self.constant)
        rows, Z = rows[:, :size], self.Z
        Z[:m] -= (gain @ (rows @ Z.reshape(size, -1))).reshape(m, noisy, size)
        Z[:, :, :m] -= ((Z.reshape(-1, size) @ rows.T) @ gain.T).reshape(size, noisy, m)
        Z[:m, model.measuring, :m] += ((gain * model.noise[node, :, None, :]) @ gain.T).swapaxes(0, 1)

    def variances(self, rows: FloatArray) -> FloatArray:
        """Variances (sources, q) of sums of the errors, rows (q, n)."""
        size, noisy = self._states.moving, self._states.noisy
        product = (rows[:, :size] @ self.Z.reshape(size, -1)).reshape(-1, noisy, size)
        of_noise = (product * rows[:, None, :size]).sum(axis=2)
        return np.hstack([of_noise, (rows @ self.constant) ** 2 @ self._owned.T]).T

    def covariances(self, rows: FloatArray) -> FloatArray:
        """Covariances (sources, 3, q) of the first three of some sums with all of them, rows (q, n)."""
        size, noisy = self._states.moving, self._states.noisy
        of_noise = (rows[:3, :size] @ self.Z.reshape(size, -1)).reshape(3 * noisy, size) @ rows[:, :size].T
        fixed = rows @ self.constant
        of_constant = ((fixed[:3, None] * fixed) @ self._owned.T).transpose(2, 0, 1)
        return np.concatenate([of_noise.reshape(3, noisy, -1).swapaxes(0, 1), of_constant])


def free(model: ErrorModel, run: FilterRun, apertures: Apertures) -> Sums:
    """Sums of the apertures in real time: nothing later is known, and the INS is free from the start on."""
    count = len(apertures.output)
    free = Sums(np.zeros((count, COLUMNS, model.states.size)), np.zeros((model.states.noisy, count, COLUMNS)))
    within(model, run, apertures, free, None)
    return free


def filtered(model: ErrorModel) -> FilterRun:
    """The filter's own covariance and gains, from the start that it believes to the end of the flight.

    Raises
    ------
    ArithmeticError
        If the covariance is not finite at the end.
    """
    (k, r, _), m = model.rows.shape, model.states.estimated
    run = FilterRun(np.empty((k, m, m)), np.zeros((k, m, r)), np.zeros((k, m, r)))
    identity, p = np.eye(m), model.states.believed
    for node, phi in enumerate(transitions(model, m)):
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


def transitions(model: ErrorModel, size: int, *, back: bool = False) -> Iterator[FloatArray]:
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


def end_weights(model: ErrorModel, run: FilterRun, apertures: Apertures) -> tuple[FloatArray, FloatArray]:
    """Parts of smoothing in the sums of the apertures: weights on λ at the end of each (apertures, COLUMNS, m), and
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


def _smoothed_at(model: ErrorModel) -> Indices:
    """Nodes at which states are smoothed: those of the outputs, then `middle` of each unless they are the same."""
    same = np.array_equal(model.middle, model.outputs)
    return model.outputs if same else np.concatenate([model.outputs, model.middle])


def later(model: ErrorModel, run: FilterRun, apertures: Apertures, ends: FloatArray, *, whole_path: bool) -> Smoothed:
    """Back along the flight: the smoothed states, the path, and what λ at the end of each aperture adds to its sums,
    on the errors there.

    Parameters
    ----------
    model : ErrorModel
    run : FilterRun
    apertures : Apertures
    ends : array (apertures, COLUMNS, m)
        Weights on λ at the end of each aperture, as `end_weights` gives them.
    whole_path : bool
        Whether the smoothed path is asked for at every node.
    """
    m, n, noisy = model.states.estimated, model.states.size, model.states.noisy
    at_nodes, count = _smoothed_at(model), len(model.outputs)
    states = Sums(np.zeros((len(at_nodes), _AXES, n)), np.zeros((noisy, len(at_nodes), _AXES)))
    images = Sums(np.zeros((len(ends), COLUMNS, n)), np.zeros((noisy, len(ends), COLUMNS)))
    nodes = len(model.time_s) if whole_path else 0
    path = Sums(np.zeros((nodes, 6, n)), np.zeros((noisy, nodes, 3, 6)))
    driven = [error.source for error in model.states.drives]
    ending, output_of = _by_node(apertures.last), _by_node(at_nodes)
    L, N = np.zeros((m, n)), np.zeros((noisy, m, m))  # at the end of the flight nothing comes later
    last = len(model.time_s) - 1
    for node, phi in zip(range(last, -1, -1), transitions(model, n, back=True), strict=True):
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
    return Smoothed(states, images, path)


def within(
    model: ErrorModel, run: FilterRun, apertures: Apertures, sums: Sums, by_innovation: FloatArray | None
) -> None:
    """Take sums from the errors at the end of each aperture to those at its start, with the noises between.

    Parameters
    ----------
    model : ErrorModel
    run : FilterRun
    apertures : Apertures
    sums : Sums
        Of the errors at the ends of the apertures, with the noises after them. Changed.
    by_innovation : array (nodes, apertures, COLUMNS, r), optional
        Weights on the innovations, as `end_weights` gives them; without, the INS is free.
    """
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
                    beyond = slice(error.first, error.first + error.states)
                    driven += A[:, :, beyond] @ factor[:, _AXES : _AXES + error.states]
                sums.added[error.source, on] += (driven**2).sum(axis=2)
            moved = A[:, :, :_AXES] @ model.phi[node - 1]
            moved[:, :, _AXES:] += A[:, :, _AXES:] * model.decay_factor[node - 1, None]
            A = moved
        sums.rows[on] = A


def forward(
    model: ErrorModel,
    run: FilterRun,
    apertures: Apertures,
    images: Mapping[str, Sums],
    smoothed: Smoothed | None,
    moment: str,
    *,
    difference: bool = False,
) -> Forward:
    """Every source through the same gains.

    Parameters
    ----------
    model : ErrorModel
    run : FilterRun
    apertures : Apertures
    images : mapping
        Processing -> sums of the apertures, on the errors at their starts.
    smoothed : Smoothed, optional
        Where smoothed errors are asked for.
    moment : str
        Of the fix interval, at which states are judged in real time: "prior", "posterior", or "closed" for the mean.
    difference : bool, optional
        True for the states of `DIFFERENCE` too, where there are smoothed errors.
    """
    noisy, sources, count = model.states.noisy, len(model.states.sources), len(model.outputs)
    before, after = _Asked(list), _Asked(list)
    states, judged, of_images = dict[str, FloatArray](), dict[str, FloatArray](), dict[str, FloatArray]()

    def ask(at: _Asked, nodes: Indices, sums: FloatArray, into: FloatArray) -> None:
        for index, node in enumerate(nodes.tolist()):
            at[node].append((into[:, index], sums[index]))

    # First what is asked for at each node, before its fix or after: variances of sums, and where they are put.
    if REAL_TIME in images:
        states[REAL_TIME], judged[REAL_TIME] = np.zeros((2, sources, count, _AXES))
        ask(after, model.outputs, model.output_rows, states[REAL_TIME])
        if moment in ("prior", "closed"):
            ask(before, model.before, model.output_rows, judged[REAL_TIME])
        if moment in ("posterior", "closed"):
            ask(after, model.after, model.output_rows, judged[REAL_TIME])
    path = np.zeros((sources, 0, 3, 6))
    if smoothed is not None:
        at_nodes = _smoothed_at(model)
        both = np.zeros((sources, len(at_nodes), _AXES))
        both[:noisy] = smoothed.states.added
        ask(after, at_nodes, smoothed.states.rows, both)
        states[POST_PROCESSED], judged[POST_PROCESSED] = both[:, :count], both[:, -count:]
        if difference:  # e - (e - P λ): what smoothing takes off, with the same later noises
            states[DIFFERENCE] = np.zeros((sources, count, _AXES))
            states[DIFFERENCE][:noisy] = smoothed.states.added[:, :count]
            ask(after, model.outputs, model.output_rows - smoothed.states.rows[:count], states[DIFFERENCE])
        path = np.zeros((sources, len(smoothed.path.rows), 3, 6))
        path[:noisy] = smoothed.path.added
    for name, sums in images.items():
        of_images[name] = np.zeros((sources, len(apertures.output), COLUMNS))
        of_images[name][:noisy] = sums.added
        ask(after, apertures.first, sums.rows, of_images[name])
    # Then every source along the flight, as far as anything is asked for: what comes later is the smoother's alone.
    last = max([*before, *after, *apertures.last.tolist()], default=0)
    errors = _Errors(model, run)
    for node, phi in enumerate(transitions(model, model.states.size)):
        if node > last:
            break
        if node:
            errors.step(phi, node)
        _answer(before.get(node), errors)
        if node and model.is_fix[node]:
            errors.fix(node)
        _answer(after.get(node), errors)
        if path.shape[1] and smoothed is not None:
            path[:, node] += errors.covariances(smoothed.path.rows[node])
    if moment == "closed" and REAL_TIME in judged:
        judged[REAL_TIME] /= 2.0
    return Forward(states, judged, of_images, path)


def _answer(asked: Sequence[tuple[FloatArray, FloatArray]] | None, errors: _Errors) -> None:
    """Add the variances of the sums of errors that are asked for at a node, all at once, for speed."""
    if not asked:
        return
    whole, first = errors.variances(np.concatenate([rows for _, rows in asked])), 0
    for into, rows in asked:
        into += whole[:, first : first + len(rows)]
        first += len(rows)


def _factors(model: ErrorModel, node: int) -> FloatArray:
    """Factors (drives, moving, 9) of what process noise adds in the step to a node."""
    if model.states.moving == _AXES:
        return model.factors[node - 1, :, :_AXES]
    factors = np.zeros((len(model.states.drives), model.states.moving, 9))
    factors[:, :_AXES] = model.factors[node - 1, :, :_AXES]
    for place, error in enumerate(model.states.drives):
        if error.first >= _AXES:
            beyond = slice(error.first, error.first + error.states)
            factors[place, beyond] = model.factors[node - 1, place, _AXES : _AXES + error.states]
    return factors


def _by_node(nodes: Indices) -> Mapping[int, list[int]]:
    indices: dict[int, list[int]] = {}
    for index, node in enumerate(nodes.tolist()):
        indices.setdefault(node, []).append(index)
    return indices
