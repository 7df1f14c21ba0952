"""Oracle for the smoothed error: least squares of all fixes of an aperture and after it at once, without a filter.

What is known at the aperture's start comes from the settled filter, which here is SciPy's solution of its Riccati
equation over one period of both kinds of fixes, in scaled units.
"""

import math
from dataclasses import replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve, solve_discrete_are
from spectral import KERNELS, NODES, PAIRS, WEIGHTS, scaled

_X, _W = np.polynomial.legendre.leggauss(4)


def grown(channel, first, second, kind_one, kind_two):
    """Covariance of two errors that grow from nothing: position (kind 0), velocity (1), acceleration by tilt (2)."""
    least = np.minimum(first[:, None], second[None, :])
    result = np.zeros(least.shape)

    def response(kind, rest):
        gyro = 0.0 if channel.gyro is None else float(channel.gyro) * rest ** (2 - kind) / math.factorial(2 - kind)
        return (float(channel.accelerometer) * rest ** (1 - kind) if kind < 2 else 0 * rest), gyro

    for node, weight in zip(_X, _W, strict=True):
        u = least * (node + 1) / 2
        (a, w), (b, v) = response(kind_one, first[:, None] - u), response(kind_two, second[None, :] - u)
        result += least * weight / 2 * (a * b + w * v)
    return result


def basis(channel, times, kind):
    """Row of the error in position, velocity, acceleration by tilt and slow error at time 0."""
    rows = np.zeros((len(times), 4))
    for n in range(kind, 3):
        rows[:, n] = times ** (n - kind) / math.factorial(n - kind)
    return rows


def whole_ratio(channel):
    """With intervals of which one is a whole multiple of the other, at the density of before."""
    if channel.velocity is None:
        return channel
    p, v = float(channel.interval), float(channel.velocity_interval)
    seldom, count = max(p, v), round(max(p, v) / min(p, v))
    step = seldom / count
    if p <= v:
        return replace(channel, interval=np.array(step), fix=channel.fix * math.sqrt(p / step))
    return replace(channel, velocity_interval=np.array(step), velocity=channel.velocity * math.sqrt(v / step))


def _events(channel):
    """Both kinds: rows by states, variance, interval."""
    slow = channel.slow is not None
    result = [(np.array([1.0, 0, 0, slow]), float(channel.fix) ** 2, float(channel.interval))]
    if channel.velocity is not None:
        result.append((np.array([0, 1.0, 0, 0]), float(channel.velocity) ** 2, float(channel.velocity_interval)))
    return result


def transition(channel, step):
    """Over a step without fixes, and the noise added."""
    at = np.array([float(step)])
    phi, noise = np.zeros((4, 4)), np.zeros((4, 4))
    for kind in range(3):
        phi[kind] = basis(channel, at, kind)
    rest = step * (1 - _X) / 2
    by_a, by_w = np.stack([rest, rest**0, 0 * rest]), np.stack([rest**2 / 2, rest, rest**0])
    gyro = 0.0 if channel.gyro is None else float(channel.gyro)
    for size, by in ((float(channel.accelerometer), by_a), (gyro, by_w)):
        noise[:3, :3] += size**2 * step / 2 * (by * _W) @ by.T
    if channel.slow is not None:
        phi[3, 3] = math.exp(-step / float(channel.slow_time))
        noise[3, 3] = float(channel.slow) ** 2 * -math.expm1(-2 * step / float(channel.slow_time))
    return phi, noise


def measured(p, row, variance):
    return p - np.outer(p @ row, row @ p) / (row @ p @ row + variance)


def settled(channel):
    """Covariance just after the fixes of time 0, of a filter that has run for ever."""
    events = _events(channel)
    step = min(interval for *_, interval in events)
    counts = [round(interval / step) for *_, interval in events]
    period = max(counts)
    states = [0, 1, *([2] if channel.gyro is not None else []), *([3] if channel.slow is not None else [])]
    unit = np.array([float(channel.fix) / step**n for n in range(3)] + [float(channel.fix)])
    phi, noise = transition(channel, step)
    chosen, size = np.ix_(states, states), len(states)
    phi, noise = (phi / unit[:, None] * unit)[chosen], (noise / np.outer(unit, unit))[chosen]
    # A period from just before the fixes of time 0: state and fixes by the first state, by the drift, by their noise.
    by_state, by_drift = np.eye(size), np.zeros((size, size * period))
    seen, seen_drift, variances = [], [], []
    for k in range(period):
        for (row, variance, _), count in zip(events, counts, strict=True):
            if k % count == 0:
                h = (row * unit / float(channel.fix))[states]
                seen.append(h @ by_state)
                seen_drift.append(h @ by_drift)
                variances.append(variance / float(channel.fix) ** 2)
        by_state, by_drift = phi @ by_state, phi @ by_drift
        by_drift[:, k * size : (k + 1) * size] = np.eye(size)
    c, d, q = np.array(seen), np.array(seen_drift), np.kron(np.eye(period), noise)
    p = solve_discrete_are(
        by_state.T, c.T, by_drift @ q @ by_drift.T, d @ q @ d.T + np.diag(variances), s=by_drift @ q @ d.T
    )
    whole = np.zeros((4, 4))
    whole[chosen] = p
    whole *= np.outer(unit, unit)
    for row, variance, _ in events:
        whole = measured(whole, row, variance)
    return whole


def run_up(channel, duration):
    """Covariance of a filter that has run so long, fix by fix, whatever the intervals."""
    events = _events(channel)
    unit = np.array([float(channel.fix) * max(1.0, float(channel.interval)) ** -n for n in range(3)] + [0.0])
    p = np.diag((1e3 * unit) ** 2)
    p[2, 2] *= channel.gyro is not None
    p[3, 3] = 0.0 if channel.slow is None else float(channel.slow) ** 2
    moments = sorted(
        (-k * interval, n) for n, (*_, interval) in enumerate(events) for k in range(int(duration / interval) + 1)
    )
    before = moments[0][0]
    for moment, n in moments:
        if moment > before:
            phi, noise = transition(channel, moment - before)
            p, before = phi @ p @ phi.T + noise, moment
        p = measured(p, *events[n][:2])
    return p


def initial(channel, gap):
    """Just after the fixes at the start of an aperture, without those of a gap before it."""
    events = _events(channel)
    step, period = (of(interval for *_, interval in events) for of in (min, max))
    p, moment = settled(channel), min(-period, -gap)
    times = [k * step for k in range(round(-period / step) + 1, 0) if k * step <= -gap + 1e-9] + [0.0]
    for time in times:
        phi, noise = transition(channel, time - moment)
        p, moment = phi @ p @ phi.T + noise, time
        for row, variance, interval in events:
            if time == 0 or interval < period:
                p = measured(p, row, variance)
    return p


def _fixes(channel, first, until):
    """Kinds and times of the fixes, how they follow from the start, and the covariance of the rest of them."""
    groups = []
    for kind, (_, variance, interval) in enumerate(_events(channel)):
        times = np.arange(first, math.floor(until / interval + 1e-9) + 1) * interval
        groups.append((times, kind, variance))
    fixes = [(times, kind) for times, kind, _ in groups]
    rest = _block(channel, fixes, fixes)
    rest += np.diag(np.concatenate([np.full(len(times), variance) for times, _, variance in groups]))
    rows = np.vstack([basis(channel, *group) for group in fixes])
    if channel.slow is not None:
        times, time = groups[0][0], float(channel.slow_time)
        count, apart, total = len(times), abs(times[:, None] - times), times[:, None] + times
        rows[:count, 3] = np.exp(-times / time)
        rest[:count, :count] += float(channel.slow) ** 2 * (np.exp(-apart / time) - np.exp(-total / time))
    return fixes, rows, rest


def _block(channel, rows, columns):
    return np.block([[grown(channel, s, t, i, j) for t, j in columns] for s, i in rows])


def information(channel, until):
    """Information of the fixes from time 0 on about the four states there."""
    _, rows, rest = _fixes(channel, 0, until)
    return rows.T @ cho_solve(cho_factor(rest, lower=True), rows)


def errors(channel, aperture, after, start):
    """Covariance of the position error at `NODES`, and of position, velocity and acceleration in the middle.

    Four unknowns of the start and a random process of known covariance are the error; the fixes are that and noise.
    """
    fixes, to_fixes, known = _fixes(channel, 1, aperture + after)
    at, middle = (NODES + 1) / 2 * aperture, np.array([aperture / 2])
    wanted = [(at, 0), (middle, 0), (middle, 1), (middle, 2)]
    to_wanted = np.vstack([basis(channel, *group) for group in wanted])
    known += to_fixes @ start @ to_fixes.T
    across = _block(channel, fixes, wanted) + to_fixes @ start @ to_wanted.T
    whole = _block(channel, wanted, wanted) + to_wanted @ start @ to_wanted.T
    return whole - across.T @ cho_solve(cho_factor(known, lower=True), across) if len(known) else whole


def smoothed(channel, aperture, after, gap=0.0, start=None):
    """Columns of `nav_model.processing.smoother.smoothed_error` for one channel."""
    result = errors(channel, aperture, after, initial(channel, gap) if start is None else start)
    along, now = result[: len(NODES), : len(NODES)], np.diag(result)[len(NODES) :]
    kernels = {name: kernel[1:-1] * WEIGHTS for name, kernel in KERNELS.items()}
    columns = {name: kernels[row] @ along @ kernels[column] for name, (row, column) in PAIRS.items()}
    columns["whole"] = WEIGHTS @ np.diag(along) / 2
    return scaled(columns, aperture) | dict(zip(("position", "velocity", "tilt"), now, strict=True))
