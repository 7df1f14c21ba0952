"""covariance(spec): the simulator's errors along a flight, in real time and smoothed, with the share of every source.

The gains come from the covariance that the filter believes; every source's own covariance is carried through the same
gains, considered errors among them. The smoother is that of Bryson and Frazier, which gives what that of Rauch, Tung
and Striebel gives [P-14]: the smoothed error is e - P λ, with λ a sum over later innovations. Going back along the
flight, λ = L z + n, z the errors at that node and n what later noises add, of which each source has its covariance.

An image figure is a weighted sum of smoothed errors at the nodes of its aperture, and so a sum of the errors at its
start, the noises within, and n at its end: three parts, independent of each other. In real time the INS is free from
the start on. Sources: Bryson and Ho, *Applied Optimal Control*, ch. 13; Gelb, *Applied Optimal Estimation*, ch. 7.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.simulation.layout import ATTITUDE
from nav_model.trajectory import aperture
from nav_model.trajectory.aperture import COLUMNS, Apertures, apertures_of
from nav_model.trajectory.errors import ErrorModel, error_model
from nav_model.trajectory.heading import heading_of
from nav_model.trajectory.lines import judge
from nav_model.trajectory.result import Processed, TrajectoryResult
from nav_model.trajectory.specification import CovarianceSpec

FloatArray = NDArray[np.float64]
_AXES = 9  # position, velocity, attitude


class _Filter(NamedTuple):
    """The filter along the flight (k nodes): its covariance after each fix (k, m, m), gain (k, n, r) with zeros for
    what it does not estimate, and H' S⁻¹ (k, m, r)."""

    covariance: FloatArray
    gain: FloatArray
    weight: FloatArray


class _Later(NamedTuple):
    """What later fixes say: L (k, m, n) after the fix at each node; and by output, of the first nine states, P times
    the covariance of n times P (sources, outputs, 9, 9); and what the end of each aperture adds, as in `_Sums`."""

    carried: FloatArray
    outputs: FloatArray
    ends: FloatArray


class _Sums(NamedTuple):
    """An aperture's weighted sum: on the errors at its start (apertures, COLUMNS, n), on λ at its end (apertures,
    COLUMNS, m), and the covariance that noises within add by source (sources, apertures, COLUMNS, COLUMNS)."""

    start: FloatArray
    end: FloatArray
    within: FloatArray


def covariance(spec: CovarianceSpec) -> TrajectoryResult:
    """The covariance along the flight of `spec`.

    Raises InputError for a flight that cannot be flown, ArithmeticError where the covariance is not finite.
    """
    model = error_model(spec)
    run = _filtered(model)
    looks = apertures_of(model, spec.aperture, spec.study.gnss.interval) if spec.aperture else None
    carried = _carried(model, run)
    free = _summed(model, run, looks, carried, smoothed=False) if looks else None
    smooth = _summed(model, run, looks, carried, smoothed=True) if looks else None
    later = _later(model, run, carried, looks, smooth)
    variances, images = _forward(model, run, later, looks, (free, smooth))
    parts = [_processed(variances[n], images[n] if images else None, spec, looks, model) for n in range(2)]
    truth = type(model.truth)(*(values[model.outputs] for values in vars(model.truth).values()))
    return TrajectoryResult(
        spec=spec,
        time_s=model.time_s[model.outputs],
        truth=truth,
        sources=model.sources,
        real_time=parts[0],
        post_processed=parts[1],
        lines=judge(spec, model.time_s[model.outputs], *parts),
        heading=heading_of(spec, model.time_s[model.outputs], truth, parts[0].attitude[:, 2]),
    )


def _filtered(model: ErrorModel) -> _Filter:
    k, r, n = model.rows.shape
    m = model.states
    found = _Filter(np.empty((k, m, m)), np.zeros((k, n, r)), np.zeros((k, m, r)))
    identity, p = np.eye(m), model.filter_start
    for node in range(k):
        if node:
            step = _transition(model, node, m)
            p = step @ p @ step.T + model.filter_noise[node - 1]
        if model.is_fix[node]:
            used = np.isfinite(model.variance[node])
            rows, variance = model.rows[node, used, :m], model.variance[node, used]
            cross = p @ rows.T
            inverse = np.linalg.inv(rows @ cross + np.diag(variance))
            gain = cross @ inverse
            kept = identity - gain @ rows
            p = kept @ p @ kept.T + (gain * variance) @ gain.T
            found.gain[node, :m, used] = gain.T
            found.weight[node][:, used] = rows.T @ inverse
        p = 0.5 * (p + p.T)
        found.covariance[node] = p
    if not np.all(np.isfinite(p)):
        raise ArithmeticError("the filter's covariance is not finite at the end of the flight")
    return found


def _carried(model: ErrorModel, run: _Filter) -> FloatArray:
    """L (k, m, n) after the fix at each node."""
    k, n, m = len(model.time_s), model.rows.shape[2], model.states
    found, now = np.zeros((k, m, n)), np.zeros((m, n))
    for node in range(k - 1, -1, -1):
        found[node] = now
        if node == 0:
            break
        now = _over_fix(model, run, node, now)
        step = _transition(model, node, n)
        now = step[:m, :m].T @ now @ step
    return found


def _over_fix(model: ErrorModel, run: _Filter, node: int, carried: FloatArray) -> FloatArray:
    """L before the fix at a node from that after it."""
    if not model.is_fix[node]:
        return carried
    rows, gain, m = model.rows[node], run.gain[node], model.states
    back = carried - (carried @ gain) @ rows
    found: FloatArray = back - rows[:, :m].T @ (gain[:m].T @ back) + run.weight[node] @ rows
    return found


def _transition(model: ErrorModel, node: int, size: int) -> FloatArray:
    """The transition from the node before of the first `size` states."""
    found = np.diag(np.concatenate([np.zeros(_AXES), model.kept[node - 1, : size - _AXES]]))
    found[:_AXES] = model.top[node - 1, :, :size]
    return found


def _summed(model: ErrorModel, run: _Filter, looks: Apertures, carried: FloatArray, smoothed: bool) -> _Sums:
    """The weighted sums of all apertures at once, node by node along them."""
    count, m, n = len(looks.output), model.states, model.rows.shape[2]
    nodes = looks.weights.shape[1]
    by_end = np.zeros((count, COLUMNS, m))
    by_innovation = np.zeros((nodes, count, COLUMNS, model.rows.shape[1]))
    if smoothed:
        for step in range(nodes):
            on = np.flatnonzero(looks.first + step <= looks.last)
            node = looks.first[on] + step
            now = by_end[on]
            if step:
                moved = now @ model.top[node - 1, :, :m].swapaxes(1, 2)
                now = np.concatenate([moved, now[:, :, _AXES:] * model.kept[node - 1, None, : m - _AXES]], axis=2)
                by_innovation[step, on] = now @ run.weight[node]
                now -= (now @ model.rows[node, :, :m].swapaxes(1, 2)) @ run.gain[node, :m].swapaxes(1, 2)
            by_end[on] = now - looks.weights[on, step] @ run.covariance[node, :6]
    by_start = np.zeros((count, COLUMNS, n))
    within = np.zeros((len(model.sources), count, COLUMNS, COLUMNS))
    for step in range(nodes - 1, -1, -1):
        on = np.flatnonzero(looks.first + step <= looks.last)
        node = looks.first[on] + step
        now = by_start[on]
        if smoothed:
            ends = node == looks.last[on]
            now[ends] += by_end[on][ends] @ carried[node[ends]]
        now[:, :, :6] += looks.weights[on, step]
        if step:
            if smoothed:
                by_noise = now @ run.gain[node] - by_innovation[step, on]
                scaled = by_noise[:, None] * model.noise[node, :, None, :]
                within[:, on] += (scaled @ by_noise.swapaxes(1, 2)[:, None]).swapaxes(0, 1)
                now = now - by_noise @ model.rows[node]
            for place, source in enumerate(model.driven):
                factor, own = model.factors[node - 1, place], model.own[place]
                driven = now[:, :, :_AXES] @ factor[:, :_AXES]
                if own:
                    driven += now[:, :, own : own + 3] @ factor[:, _AXES:]
                within[source, on] += driven @ driven.swapaxes(1, 2)
            moved = now[:, :, :_AXES] @ model.top[node - 1]
            moved[:, :, _AXES:] += now[:, :, _AXES:] * model.kept[node - 1, None]
            now = moved
        by_start[on] = now
    return _Sums(by_start, by_end, within)


def _later(
    model: ErrorModel, run: _Filter, carried: FloatArray, looks: Apertures | None, sums: _Sums | None
) -> _Later:
    m, s = model.states, len(model.sources)
    driven = list(model.driven)
    outputs = np.zeros((s, len(model.outputs), _AXES, _AXES))
    ends = np.zeros((s, len(looks.output) if looks else 0, COLUMNS, COLUMNS))
    ending = _by_node(looks.last) if looks else {}
    output_of = {int(node): n for n, node in enumerate(model.outputs)}
    now = np.zeros((s, m, m))
    noisy = np.flatnonzero(model.noise.any(axis=(0, 2)))
    for node in range(len(model.time_s) - 1, -1, -1):
        if node in output_of:
            p = run.covariance[node, :_AXES]
            outputs[:, output_of[node]] = p @ now @ p.T
        for look in ending.get(node, ()):
            assert sums is not None
            ends[:, look] = sums.end[look] @ now @ sums.end[look].T
        if node == 0:
            break
        if model.is_fix[node]:
            kept = np.eye(m) - model.rows[node, :, :m].T @ run.gain[node, :m].T
            by_noise = kept @ carried[node] @ run.gain[node] - run.weight[node]
            now = kept @ now @ kept.T
            scaled = by_noise * model.noise[node, noisy, None, :]
            now[noisy] += scaled @ by_noise.T
        back = _transition(model, node, m).T
        now[driven] += _square(_over_fix(model, run, node, carried[node]) @ _factors(model, node))
        now = back @ now @ back.T
    return _Later(carried, outputs, ends)


def _forward(
    model: ErrorModel, run: _Filter, later: _Later, looks: Apertures | None, sums: tuple[_Sums | None, _Sums | None]
) -> tuple[FloatArray, list[FloatArray] | None]:
    """Every source's covariance through the same gains.

    Returns variances (2 processings, sources, outputs, 9) of position, velocity and roll, pitch, yaw, and of both the
    covariances of the apertures' sums (sources, apertures, COLUMNS, COLUMNS).
    """
    k, _, n = model.rows.shape
    m, s = model.states, len(model.sources)
    variances = np.empty((2, s, len(model.outputs), _AXES))
    images = [part.within + (0.0 if part is not sums[1] else later.ends) for part in sums if part] if looks else None
    starting = _by_node(looks.first) if looks else {}
    output_of = {int(node): index for index, node in enumerate(model.outputs)}
    driven = list(model.driven)
    noisy = np.flatnonzero(model.noise.any(axis=(0, 2)))
    now = np.ascontiguousarray(model.initial.swapaxes(0, 1))  # (n, sources, n): both products are of large matrices
    shown = np.eye(_AXES)
    for node in range(k):
        if node:
            now = _stepped(model, node, now)
            now[:, driven] += _square(_factors(model, node)).swapaxes(0, 1)
            if model.is_fix[node]:
                rows, gain = model.rows[node], run.gain[node]
                now[:m] -= (gain[:m] @ (rows @ now.reshape(n, -1))).reshape(m, s, n)
                now[:, :, :m] -= ((now.reshape(-1, n) @ rows.T) @ gain[:m].T).reshape(n, s, m)
                noise = (gain[:m] * model.noise[node, noisy, None, :]) @ gain[:m].T
                now[:m, noisy, :m] += noise.swapaxes(0, 1)
        if node in output_of:
            at = output_of[node]
            shown[ATTITUDE:, ATTITUDE:] = model.error_map[node]
            rows = np.zeros((_AXES, n))
            rows[:, :_AXES] = shown
            smoothed = rows - shown @ run.covariance[node, :_AXES] @ later.carried[node]
            variances[0, :, at] = _quadratic(rows, now)
            variances[1, :, at] = _quadratic(smoothed, now)
            variances[1, :, at] += np.einsum("ij,sjk,ik->si", shown, later.outputs[:, at], shown, optimize=True)
        for look in starting.get(node, ()):
            assert images is not None
            for image, part in zip(images, sums, strict=True):
                assert part is not None
                rows = part.start[look]
                turned = (rows @ now.reshape(n, -1)).reshape(-1, s, n)
                image[:, look] += np.einsum("csn,dn->scd", turned, rows)
    return variances, images


def _stepped(model: ErrorModel, node: int, covariances: FloatArray) -> FloatArray:
    """Covariances (n, sources, n) at a node from those at the node before, without noise."""
    n, s, _ = covariances.shape
    top, kept = model.top[node - 1], model.kept[node - 1]
    found = np.empty_like(covariances)
    found[:_AXES] = (top @ covariances.reshape(n, -1)).reshape(_AXES, s, n)
    np.multiply(covariances[_AXES:], kept[:, None, None], out=found[_AXES:])
    moved = found.reshape(-1, n) @ top.T
    found[:, :, _AXES:] *= kept
    found[:, :, :_AXES] = moved.reshape(n, s, _AXES)
    return found


def _factors(model: ErrorModel, node: int) -> FloatArray:
    """Factors (driven, n, 9) of what process noise adds in the step to a node."""
    found = np.zeros((len(model.driven), model.rows.shape[2], 9))
    found[:, :_AXES] = model.factors[node - 1, :, :_AXES]
    for place, own in enumerate(model.own):
        if own:
            found[place, own : own + 3] = model.factors[node - 1, place, _AXES:]
    return found


def _square(factors: FloatArray) -> FloatArray:
    found: FloatArray = factors @ factors.swapaxes(-1, -2)
    return found


def _quadratic(rows: FloatArray, covariances: FloatArray) -> FloatArray:
    """Variances (sources, q) of q sums, rows (q, n), under covariances (n, sources, n)."""
    n, s, _ = covariances.shape
    turned = (rows @ covariances.reshape(n, -1)).reshape(-1, s, n)
    found: FloatArray = (turned * rows[:, None, :]).sum(axis=2).T
    return found


def _by_node(nodes: NDArray[np.int64]) -> Mapping[int, list[int]]:
    found: dict[int, list[int]] = {}
    for look, node in enumerate(nodes.tolist()):
        found.setdefault(node, []).append(look)
    return found


def _processed(
    variances: FloatArray,
    image: FloatArray | None,
    spec: CovarianceSpec,
    looks: Apertures | None,
    model: ErrorModel,
) -> Processed:
    """The figures and their shares of variances (sources, outputs, 9) and the covariance of the apertures' sums."""
    variances = np.maximum(variances, 0.0)
    groups = {
        "position_horizontal": variances[:, :, 0:2].sum(axis=2),
        "position_vertical": variances[:, :, 2],
        "velocity_horizontal": variances[:, :, 3:5].sum(axis=2),
        "velocity_vertical": variances[:, :, 5],
        "tilt": variances[:, :, 6:8].sum(axis=2),
        "heading": variances[:, :, 8],
    }
    sigmas = np.sqrt(variances.sum(axis=0))
    found: dict[str, FloatArray] = {}
    if spec.aperture is not None and looks is not None and image is not None:
        shape, accelerometer = spec.aperture, spec.study.imu.accelerometer
        white = np.zeros(len(variances))
        if "accelerometer noise" in model.sources:
            density = (accelerometer.random_walk * spec.study.imu.vibration_factor) ** 2
            white[model.sources.index("accelerometer noise")] = density
        for name, values in aperture.figures(image, shape, looks.speed, white).items():
            groups[name] = np.full((len(variances), len(model.outputs)), np.nan)
            groups[name][:, looks.output] = np.maximum(values, 0.0)
            found[name] = np.sqrt(groups[name].sum(axis=0))
        found["ce90"][looks.output] = aperture.circular(image.sum(axis=0), shape, looks.speed)
    with np.errstate(invalid="ignore"):
        shares = {name: values / values.sum(axis=0) for name, values in groups.items()}
    return Processed(sigmas[:, 0:3], sigmas[:, 3:6], sigmas[:, 6:9], found, shares)
