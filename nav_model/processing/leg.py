"""The smoothed error over an aperture in a leg of limited length or with sparse fixes: a smoother in state space.

States of a channel are position, velocity, acceleration by tilt, and the slow error of the fixes. Information runs
forward from the leg's start and backward from its end; what the two know together is the smoothed covariance
(Fraser and Potter 1969). The Legendre coefficients of the position error [P-5] are carried through the aperture as
further states, exactly: they are integrals of polynomials times the states. Fixes are at whole intervals from the
aperture's start, where one is; where they are far denser than the error changes, several are taken as one.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from nav_model.analytic.steady_state import Array
from nav_model.compiled import kernel, part
from nav_model.processing.spectrum import Channel, Leg, rates, smoothed

COLUMNS = (
    "quadratic", "cubic", "left_1", "left_2", "left_3", "slope", "turned", "mean", "position", "velocity", "tilt",
    "mean_slope",
)  # fmt: skip
"""What `smoothed_in_leg` finds, in the order of the kernel's columns; as `nav_model.processing.spectrum.smoothed`."""

_MERGED = 0.12  # fixes are taken as one up to this part of the time in which the error changes,
_COARSER = 0.06  # or of their distance from the aperture,
_LEAST_GROUPS = 60  # yet into no fewer than these over the whole leg, and no more than those:
_MOST_GROUPS = 1000  # the bound on time and memory, met where the error changes a hundred times in an aperture
_FAR = 12.0  # of those times: what is farther from the aperture tells nothing
_UNKNOWN = 1e4  # prior sigmas over those of the leg's own fixes: nothing is known before
_KNOWN = 1e30  # information of a state that is not there
_ROUNDED = 1e4  # position variance over what is left after order 3, up to which that is good to 1e-4
_FOR_EVER = 1e30  # s: correlation time of a slow error that is not there
_DIFFERENCE = 1e-4  # relative step that stands for a complex one
_LEAST_DECAY = 1e-6  # of the slow error over a step: below it has forgotten

_NODES, _WEIGHTS = ((np.polynomial.legendre.leggauss(7)[0] + 1) / 2, np.polynomial.legendre.leggauss(7)[1] / 2)


@part
def _decompose(a: Any, n: int) -> None:
    """L D Lᵀ of a symmetric positive matrix in its place: D on the diagonal, L below."""
    for j in range(n):
        for k in range(j):
            a[j, j] -= a[j, k] * a[j, k] * a[k, k]
        for i in range(j + 1, n):
            for k in range(j):
                a[i, j] -= a[i, k] * a[j, k] * a[k, k]
            a[i, j] /= a[j, j]


@part
def _solve(a: Any, n: int, b: Any, columns: int) -> None:
    """Solve for `columns` right-hand sides in their place, with `_decompose`d `a`."""
    for c in range(columns):
        for i in range(n):
            for k in range(i):
                b[i, c] -= a[i, k] * b[k, c]
        for i in range(n - 1, -1, -1):
            b[i, c] /= a[i, i]
            for k in range(i + 1, n):
                b[i, c] -= a[k, i] * b[k, c]


@part
def _noise_factor(accelerometer: Any, gyro: Any, slow: Any, decay: Any, h: Any, factor: Any) -> None:
    """Columns whose squares add up to the process noise of (position, velocity, acceleration, slow error) over h."""
    a, w, root = np.sqrt(accelerometer), np.sqrt(gyro), np.sqrt(h)
    factor[0, 0], factor[1, 0] = a * root * h / 2, a * root
    factor[0, 1] = a * root * h / np.sqrt(12.0)
    factor[0, 2], factor[1, 2], factor[2, 2] = w * root * h * h / 6, w * root * h / 2, w * root
    factor[0, 3], factor[1, 3] = w * root * h * h * np.sqrt(3.0) / 12, w * root * h * np.sqrt(3.0) / 6
    factor[0, 4] = w * root * h * h * np.sqrt(5.0) / 60
    factor[3, 5] = np.sqrt(slow * (1 - decay * decay))


@part
def _through_noise(info: Any, factor: Any, inner: Any) -> None:
    """Information after noise: M - M L (1 + Lᵀ M L)⁻¹ Lᵀ M, in its place."""
    side, turned = np.zeros((6, 4)), np.zeros((6, 4))
    for i in range(6):
        for j in range(4):
            for k in range(4):
                side[i, j] += factor[k, i] * info[k, j]
            turned[i, j] = side[i, j]
    for i in range(6):
        for j in range(6):
            inner[i, j] = 1.0 if i == j else 0.0
            for k in range(4):
                inner[i, j] += side[i, k] * factor[k, j]
    _decompose(inner, 6)
    _solve(inner, 6, side, 4)
    for i in range(4):
        for j in range(4):
            for k in range(6):
                info[i, j] -= turned[k, i] * side[k, j]


@part
def _shift(info: Any, h: Any, decay: Any) -> None:
    """Phiᵀ M Phi in its place, for a step of h; with -h and 1/decay that of the inverse."""
    for turn in range(2):
        for i in range(4):
            p, v = (info[i, 0], info[i, 1]) if turn == 0 else (info[0, i], info[1, i])
            if turn == 0:
                info[i, 1] += h * p
                info[i, 2] += h * v + h * h / 2 * p
                info[i, 3] *= decay
            else:
                info[1, i] += h * p
                info[2, i] += h * v + h * h / 2 * p
                info[3, i] *= decay


@part
def _decay(h: Any, time: Any) -> Any:
    return max(np.exp(-h / time), _LEAST_DECAY)


@part
def _fixes(first: float, step: float, reach: float, merged: float, kind: int, times: Any, kinds: Any, sizes: Any,
           count: int, aperture: float) -> int:  # fmt: skip
    """Append fixes from `first` on, each `step` from the last, as far as `reach`; the new number of events.

    Where they are dense several are taken as one, the more the farther they are from the aperture.
    """
    k, last = 0, int(np.floor((reach - first) / step + 1e-9))
    while k <= last:
        time = first + k * step
        away = max(-time, time - aperture, 0.0)
        size = min(max(1, int(max(merged, _COARSER * away) / abs(step))), last - k + 1)
        times[count], kinds[count], sizes[count] = time + step * (size - 1) / 2, kind, size
        count += 1
        k += size
    return count


@part
def _sorted(keys: Any, order: Any, count: int) -> None:
    """Places of `keys` in rising order (Shell's sort: the library's takes Numba seconds to compile)."""
    for n in range(count):
        order[n] = n
    gap = count // 2
    while gap > 0:
        for n in range(gap, count):
            held = order[n]
            k = n
            while k >= gap and keys[order[k - gap]] > keys[held]:
                order[k] = order[k - gap]
                k -= gap
            order[k] = held
        gap //= 2


@part
def _bent(x: float, values: Any) -> None:
    """What a kick of velocity at x in [-1, 1], kept until 1, makes of the Legendre coefficients 0 to 3, over T/2.

    (2m + 1)/2 times the integral from x to 1 of P_m(y) (y - x): from order 2 on zero at both ends, since a straight
    line has no such coefficient.
    """
    rest = 1 - x
    values[0] = rest * rest / 4
    values[1] = 3 / 2 * (1 / 3 - x / 2 + x * x * x / 6)
    values[2] = 5 / 16 * (1 - x * x) ** 2
    values[3] = 7 / 16 * x * (1 - x * x) ** 2


@part
def _carry(cov: Any, t: float, h: float, aperture: float, accelerometer: float, gyro: float, slow: float,
           decay: float) -> None:  # fmt: skip
    """Covariance of the four states and four Legendre coefficients over a step of h from t, in its place.

    The coefficients are those of the error until now and of its straight continuation to the aperture's end: a step
    changes them by its acceleration alone, so that large errors of position do not round small ones of curvature.
    """
    phi = np.zeros((8, 8))
    for i in range(8):
        phi[i, i] = 1
    phi[0, 1], phi[0, 2], phi[1, 2], phi[3, 3] = h, h * h / 2, h, decay
    values = np.zeros(4)
    for n in range(7):
        _bent(2 * (t + h * _NODES[n]) / aperture - 1, values)
        for m in range(4):
            phi[4 + m, 2] += h * _WEIGHTS[n] * values[m] * aperture / 2
    noise = np.zeros((8, 8))
    a, w = np.zeros(8), np.zeros(8)
    for n in range(7):  # noise that enters at u; products of its responses are polynomials up to degree 12 in u
        rest = h * (1 - _NODES[n])
        a[0], a[1] = rest, 1
        w[0], w[1], w[2] = rest * rest / 2, rest, 1
        _bent(2 * (t + h - rest) / aperture - 1, values)
        for m in range(4):
            a[4 + m], w[4 + m] = values[m] * aperture / 2, 0.0
        for k in range(7):
            _bent(2 * (t + h - rest + rest * _NODES[k]) / aperture - 1, values)
            for m in range(4):
                w[4 + m] += rest * _WEIGHTS[k] * values[m] * aperture / 2
        for i in range(8):
            for j in range(8):
                noise[i, j] += h * _WEIGHTS[n] * (accelerometer * a[i] * a[j] + gyro * w[i] * w[j])
    noise[3, 3] += slow * (1 - decay * decay)
    half = np.zeros((8, 8))
    for i in range(8):
        for j in range(8):
            for k in range(8):
                half[i, j] += phi[i, k] * cov[k, j]
    for i in range(8):
        for j in range(8):
            total = noise[i, j]
            for k in range(8):
                total += half[i, k] * phi[j, k]
            cov[i, j] = total


@part
def _straight(cov: Any, aperture: float) -> None:
    """Add the Legendre coefficients of the line p + v t to the covariance of the four states at its start."""
    for j in range(8):
        cov[4, j] = cov[0, j] + cov[1, j] * aperture / 2
        cov[5, j] = cov[1, j] * aperture / 2
    for j in range(8):
        cov[j, 4] = cov[j, 0] + cov[j, 1] * aperture / 2
        cov[j, 5] = cov[j, 1] * aperture / 2


@part
def _fix(cov: Any, kind: int, variance: Any) -> None:
    """A position fix (kind 0), which has the slow error in it, or a velocity fix (kind 1)."""
    column = np.zeros(8)
    for i in range(8):
        column[i] = cov[i, 0] + cov[i, 3] if kind == 0 else cov[i, 1]
    total = variance + (column[0] + column[3] if kind == 0 else column[1])
    for i in range(8):
        for j in range(8):
            cov[i, j] -= column[i] * column[j] / total


@part
def _learn(cov: Any, info: Any) -> None:
    """What the fixes after the aperture tell: information about the four states, here as its square root's rows."""
    root = np.zeros((4, 4))
    for j in range(4):
        pivot = info[j, j]
        for k in range(j):
            pivot -= root[j, k] * root[j, k]
        if pivot > 1e-13 * info[j, j]:
            root[j, j] = np.sqrt(pivot)
            for i in range(j + 1, 4):
                total = info[i, j]
                for k in range(j):
                    total -= root[i, k] * root[j, k]
                root[i, j] = total / root[j, j]
    column = np.zeros(8)
    for c in range(4):  # each column of the root is a measurement with a variance of one
        for i in range(8):
            column[i] = 0
            for k in range(4):
                column[i] += cov[i, k] * root[k, c]
        total = column[0] * 0 + 1
        for k in range(4):
            total += root[k, c] * column[k]
        for i in range(8):
            for j in range(8):
                cov[i, j] -= column[i] * column[j] / total


@part
def _reach(p: Any) -> Any:
    """How far fixes are looked at before the aperture and after it, and the time over which they are taken as one."""
    before, after = min(p[9], p[11] + _FAR * p[13]), min(p[10], _FAR * p[13])
    span = before + p[8] + after
    return before, after, max(min(_MERGED * p[12], span / _LEAST_GROUPS), span / _MOST_GROUPS)


@part
def _timeline(p: Any, times: Any, kinds: Any, sizes: Any, order: Any) -> int:
    """Every moment that counts; their number, and in `order` their places in time.

    Kinds: 0 position fix, 1 velocity fix, 2 node in the aperture, 3 its start, 4 its end, 5 its middle. Sizes: how
    many fixes one stands for, or the weight of a node.
    """
    aperture, gap = p[8], p[11]
    before, after, merged = _reach(p)
    count = 0
    for kind in range(2):
        step, variance = (p[3], p[2]) if kind == 0 else (p[5], p[4])
        if variance > 0:
            first = 0.0 if gap > 0 else step  # the first fix that is in the aperture or after it
            count = _fixes(-gap, -step, -before, merged, kind, times, kinds, sizes, count, aperture)
            count = _fixes(first, step, aperture + after, merged, kind, times, kinds, sizes, count, aperture)
    _sorted(times, order, count)
    # Between its fixes, the aperture's error is a polynomial of noise: seven nodes are exact there.
    fixes, start = count, 0.0
    for k in range(fixes + 1):
        stop = aperture if k == fixes else min(times[order[k]], aperture)
        if stop > start + 1e-9 * aperture:
            for n in range(7):
                times[count], kinds[count] = start + (stop - start) * _NODES[n], 2
                sizes[count] = (stop - start) * _WEIGHTS[n] / aperture
                count += 1
            start = stop
    for kind, share in ((3, 0.0), (4, 1.0), (5, 0.5)):
        times[count], kinds[count] = aperture * share, kind
        count += 1
    # A fix at the aperture's start belongs to what is before it, one at its end to what is after.
    keys = times.copy()
    keys[count - 3] += 1e-9 * aperture
    keys[count - 2] -= 1e-9 * aperture
    _sorted(keys, order, count)
    return count


@part
def _measure(info: Any, kind: int, size: float, p: Any) -> None:
    """Information of a fix: of position and slow error together (kind 0), or of velocity (kind 1)."""
    if kind == 0:
        for i in (0, 3):
            for j in (0, 3):
                info[i, j] += size / p[2]
    elif kind == 1:
        info[1, 1] += size / p[4]


@part
def _one(p: Any, out: Any) -> None:
    """One channel over one aperture; `p` in the order of `smoothed_in_leg`, `out` in that of `COLUMNS`."""
    accelerometer, gyro, slow, aperture = p[0], p[1], p[6], p[8]
    before, after, merged = _reach(p)
    span = before + aperture + after
    room = 16 * int(2 * span / merged + 16)
    times, kinds, sizes = np.zeros(room), np.zeros(room, np.int64), np.zeros(room)
    order = np.zeros(room, np.int64)
    count = _timeline(p, times, kinds, sizes, order)

    factor, inner = np.zeros((4, 6)), np.zeros((6, 6))
    forward = np.zeros((count, 4, 4))
    info, both, inverse, cov = np.zeros((4, 4)), np.zeros((4, 4)), np.zeros((4, 4)), np.zeros((8, 8))
    info[0, 0] = 1 / (p[2] * _UNKNOWN**2)
    info[1, 1] = info[0, 0] * span**2
    info[2, 2] = info[0, 0] * span**4 if gyro > 0 else _KNOWN
    info[3, 3] = 1 / slow if slow > 0 else _KNOWN
    for n in range(count):
        now = order[n]
        if n > 0:
            h = times[now] - times[order[n - 1]]
            decay = _decay(h, p[7])
            _shift(info, -h, 1 / decay)
            _noise_factor(accelerometer, gyro, slow, decay, h, factor)
            _through_noise(info, factor, inner)
        _measure(info, kinds[now], sizes[now], p)
        for i in range(4):
            for j in range(4):
                forward[n, i, j] = info[i, j]
    mean, behind = 0.0, np.zeros((4, 4))
    for i in range(4):
        for j in range(4):
            info[i, j] = 0
    for n in range(count - 1, -1, -1):
        now = order[n]
        if n < count - 1:
            h = times[order[n + 1]] - times[now]
            decay = _decay(h, p[7])
            _noise_factor(accelerometer, gyro, slow, decay, h, factor)
            _through_noise(info, factor, inner)
            _shift(info, h, decay)
        kind = kinds[now]
        _measure(info, kind, sizes[now], p)
        if kind >= 2:
            for i in range(4):
                for j in range(4):
                    if kind == 4:
                        behind[i, j] = info[i, j]
                    # at the aperture's start only what was known until then
                    both[i, j] = forward[n, i, j] + (0.0 if kind == 3 else info[i, j])
                    inverse[i, j] = 1.0 if i == j else 0.0
            _decompose(both, 4)
            _solve(both, 4, inverse, 4)
            if kind == 2:
                mean += sizes[now] * inverse[0, 0]
            elif kind == 5:
                out[8], out[9], out[10] = inverse[0, 0], inverse[1, 1], inverse[2, 2]
            elif kind == 3:
                for i in range(4):
                    for j in range(4):
                        cov[i, j] = inverse[i, j]
                break
    _straight(cov, aperture)
    t = 0.0
    for n in range(count):
        now = order[n]
        kind = kinds[now]
        if times[now] > 0 and (kind < 2 or kind == 4):
            h = times[now] - t
            _carry(cov, t, h, aperture, accelerometer, gyro, slow, _decay(h, p[7]))
            t += h
            if kind == 4:
                break
            _fix(cov, kind, p[2 + 2 * kind] / sizes[now])
    _learn(cov, behind)
    out[0], out[1] = cov[6, 6] * 9 / 4, cov[7, 7] * 25 / 4
    left = mean - cov[4, 4]
    for m in range(1, 4):
        left -= cov[4 + m, 4 + m] / (2 * m + 1)
        out[1 + m] = left
    out[5] = cov[5, 5] * 4 / (aperture * aperture)
    out[6] = cov[5, 5] + cov[5, 7] * 9 / 7 + cov[7, 7] * 81 / 196
    out[7] = cov[4, 4]
    out[11] = cov[4, 5] * 2 / aperture


@kernel
def _run(parameters: Any, out: Any) -> None:
    for n in range(len(parameters)):
        _one(parameters[n], out[n])


def smoothed_in_leg(channel: Channel, aperture: Array, leg: Leg) -> dict[str, Array]:
    """Variances of the smoothed error of one channel over an aperture inside a leg of this length.

    Real numbers; a complex step is answered with a central difference along it, good to about 1e-6.

    Parameters
    ----------
    channel : Channel
    aperture : array
        Seconds.
    leg : Leg

    Returns
    -------
    dict
        One entry for each of `COLUMNS`; ``tilt`` is that times gravity [m²/s⁴], zero for the vertical;
        ``mean_slope`` the covariance of the mean with the slope [m²/s].
    """
    zero = np.zeros(())
    fastest, slowest = rates(channel)
    parameters = np.broadcast_arrays(
        channel.accelerometer**2,
        zero if channel.gyro is None else channel.gyro**2,
        channel.fix**2,
        channel.interval,
        zero if channel.velocity is None else channel.velocity**2,
        channel.interval if channel.velocity_interval is None else channel.velocity_interval,
        zero if channel.slow is None else channel.slow**2,
        zero + _FOR_EVER if channel.slow_time is None else channel.slow_time,
        aperture,
        leg.before,
        leg.after,
        leg.gap,
        1 / fastest,
        1 / slowest,
    )
    table = np.stack(parameters, axis=-1).reshape(-1, len(parameters))
    found = _solved(table).reshape(*parameters[0].shape, len(COLUMNS))
    columns = dict(zip(COLUMNS, np.moveaxis(found, -1, 0), strict=True))
    # What is left after order 3 is a small difference of large numbers; where rounding would show, the spectrum has
    # it, since a short leg costs it nothing.
    rest = smoothed(channel, aperture, ("left_3",))["left_3"]
    columns["left_3"] = np.where(columns["mean"].real < _ROUNDED * rest.real, columns["left_3"], rest)
    columns["left_2"] = columns["left_3"] + columns["cubic"] * (4 / 25 / 7)
    columns["left_1"] = columns["left_2"] + columns["quadratic"] * (4 / 9 / 5)
    return columns


def _solved(table: Array) -> Array:
    """The kernel's columns for each row of parameters."""
    if np.iscomplexobj(table):
        real, imag = np.ascontiguousarray(table.real), table.imag
        stepped = np.any(imag != 0, axis=-1)
        size = np.max(np.abs(imag) / np.where(real == 0, 1, np.abs(real)), axis=-1, keepdims=True)
        along = _DIFFERENCE * imag / np.where(size > 0, size, 1)
        # Complex steps come as many copies of one design: it is solved once, and where there is a step along it.
        kinds, place = np.unique(real, axis=0, return_inverse=True)
        complex_step: Array = _solved(kinds)[place].astype(complex)
        more, less = _solved((real + along)[stepped]), _solved((real - along)[stepped])
        complex_step[stepped] += 1j * (more - less) / (2 * _DIFFERENCE) * size[stepped]
        return complex_step
    found: Array = np.empty((len(table), len(COLUMNS)))
    _run(np.ascontiguousarray(table), found)
    return found
