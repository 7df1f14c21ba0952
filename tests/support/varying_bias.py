"""Oracle for a filter that estimates sensor biases which vary: SciPy's matrix exponential and Riccati solver, and the
joint covariance of all states at many moments, given all fixes at once.

States are position, velocity, gravity times the tilt, bias of the accelerometer, gravity times that of the gyro, a
Gauss-Markov process and a random walk, and the slow error of the fixes: other coordinates than those of the product.
"""

import numpy as np
from riccati import settled, van_loan
from spectral import KERNELS, NODES, PAIRS, WEIGHTS, scaled

POSITION, VELOCITY, TILT, BIAS, MARKOV, WALK, SLOW = range(7)


def model(channel, rise=None):
    """Dynamics and noise density; `rise` takes the place of the channel's gradient of gravity."""
    gradient = 0.0 if channel.gradient is None else float(channel.gradient)
    f, q = np.zeros((7, 7)), np.zeros(7)
    f[POSITION, VELOCITY] = f[VELOCITY, TILT] = f[VELOCITY, BIAS] = f[TILT, MARKOV] = f[TILT, WALK] = 1.0
    f[VELOCITY, POSITION] = gradient if rise is None else rise
    q[VELOCITY], q[TILT] = channel.accelerometer**2, 0.0 if channel.gyro is None else channel.gyro**2
    if channel.markov is not None:
        # On a level axis the walk of an accelerometer and a tilt are the same to a filter.
        q[TILT] += channel.walk**2
        q[WALK] = channel.jerk_walk**2
        for state, sigma, time in (
            (BIAS, channel.markov, channel.markov_time),
            (MARKOV, channel.jerk, channel.jerk_time),
        ):
            f[state, state], q[state] = -1.0 / time, 2.0 * sigma**2 / time
    if channel.slow is not None:
        f[SLOW, SLOW], q[SLOW] = -1.0 / channel.slow_time, 2.0 * channel.slow**2 / channel.slow_time
    return f, np.diag(q)


def after_a_fix(channel):
    """Covariance of the settled filter just before a fix and just after it, (7, 7) each; one interval for all."""
    f, q = model(channel)
    states = [POSITION, VELOCITY, *(state for state in range(TILT, 7) if q[state, state] > 0.0)]
    if TILT not in states and WALK in states:
        states = sorted([*states, TILT])
    chosen, h = np.ix_(states, states), float(channel.interval)
    phi, added = van_loan(f[chosen], q[chosen], h)
    rows = [np.isin(states, (POSITION, SLOW)).astype(float)]
    noise = [float(channel.fix) ** 2]
    if channel.velocity is not None:
        rows.append(np.isin(states, VELOCITY).astype(float))
        noise.append(float(channel.velocity) ** 2)
    fix = float(channel.fix)
    unit = np.array([fix, fix / h, fix / h**2, fix / h**2, fix / h**3, fix / h**3, fix])[states]
    both = settled(phi, added, np.array(rows), np.diag(noise), 1.0 / unit, balanced=False)
    whole = np.zeros((2, 7, 7))
    for full, p in zip(whole, both, strict=True):
        full[chosen] = p
    return whole


def carried(f, q, p, time, shortest):
    """Covariance after a time, in steps no longer than the `shortest` time constant: of longer ones Van Loan's
    exponential loses all digits."""
    count = int(np.ceil(time / shortest))
    phi, added = van_loan(f, q, time / count)
    for _ in range(count):
        p = phi @ p @ phi.T + added
    return p


def joint(f, q, start, times):
    """Joint covariance of the states at increasing times, (k, 7, k, 7), from that at time 0."""
    count, size = len(times), len(f)
    whole, p, before = np.zeros((count, size, count, size)), start, 0.0
    for k, time in enumerate(times):
        phi, added = van_loan(f, q, time - before)
        p, before = phi @ p @ phi.T + added, time
        whole[k, :, k] = p
        for i in range(k):
            whole[i, :, k] = whole[i, :, k - 1] @ phi.T
            whole[k, :, i] = whole[i, :, k].T
    return whole


def along(channel, coast, aperture, after=None):
    """Columns of `nav_model.processing.smoother.smoothed_error`: of a free INS from `coast` after a fix on, or, with
    the fixes of `after` seconds behind the aperture, of one that begins at a fix."""
    f, q = model(channel)
    nodes = coast + (NODES + 1) / 2 * aperture
    middle = coast + aperture / 2
    fixes = np.array([])
    if after is not None:
        fixes = np.arange(1, int((aperture + after) / float(channel.interval) + 1e-9) + 1) * float(channel.interval)
    times = np.unique(np.concatenate([nodes, [middle], fixes]))
    whole = joint(f, q, after_a_fix(channel)[1], times)
    size = 7 * len(times)
    whole = whole.reshape(size, size)
    if len(fixes):
        at = 7 * np.searchsorted(times, fixes)
        rows = np.zeros((len(fixes), size))
        rows[range(len(fixes)), at + POSITION] = 1.0
        rows[range(len(fixes)), at + SLOW] = 1.0
        noise = np.full(len(fixes), float(channel.fix) ** 2)
        if channel.velocity is not None:
            rows = np.vstack([rows, np.zeros_like(rows)])
            rows[range(len(fixes), 2 * len(fixes)), at + VELOCITY] = 1.0
            noise = np.append(noise, np.full(len(fixes), float(channel.velocity) ** 2))
        gain = np.linalg.solve(rows @ whole @ rows.T + np.diag(noise), rows @ whole)
        whole = whole - (whole @ rows.T) @ gain
    now = whole.reshape(len(times), 7, len(times), 7)
    at, mid = np.searchsorted(times, nodes), np.searchsorted(times, middle)
    position = now[at][:, POSITION][:, at, POSITION]
    kernels = {name: kernel[1:-1] * WEIGHTS for name, kernel in KERNELS.items()}
    columns = {name: kernels[row] @ position @ kernels[column] for name, (row, column) in PAIRS.items()}
    columns["whole"] = WEIGHTS @ np.diag(position) / 2
    return scaled(columns, aperture) | {"covariance": now[mid, :, mid]}
