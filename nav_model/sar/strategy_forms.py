"""Closed forms of strategies 2, 3, 5 and 5w: residuals, the break-even aperture and who wins where.

All functions broadcast over plain SI arrays. Variances are of line-of-sight or per-axis position [m^2]; the
phase is 4 pi / lambda times the root. Vertical axes have no tilt and no gyro: pass zeros.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav_model.sar.axis_model import STANDARD_GRAVITY_M_S2

_FloatArray = NDArray[np.float64]

# Mean square of x^2 about its mean on [-1, 1]: from the variance of a QPE to its detrended variance.
_QUADRATIC_MEAN_SQUARE = 4 / 45

MAP_STRATEGIES: tuple[str, ...] = ("2", "3", "5", "5w")


def ins_residual_variance(
    aperture_time: ArrayLike,
    accelerometer_noise: ArrayLike,
    gyro_noise: ArrayLike,
    tilt_variance: ArrayLike,
    coast_time: ArrayLike = 0.0,
    gravity: ArrayLike = STANDARD_GRAVITY_M_S2,
    accelerometer_bias: ArrayLike = 0.0,
    gyro_bias: ArrayLike = 0.0,
) -> _FloatArray:
    """Strategies 2 and 3: mean variance [m^2] after the line, [T-15] with the coast of [S-5].

    The gyro bias contributes its curvature at the middle of the aperture [S-5] and its cubic [T-14]:
    g^2 d^2 T^4 (T_c + T/2)^2 / 720 + g^2 d^2 T^6 / 100800, which is T^6 / 2800 for T_c = 0.
    """
    t, tc = np.asarray(aperture_time, float), np.asarray(coast_time, float)
    sa, sg = np.square(accelerometer_noise), np.square(np.multiply(gravity, gyro_noise))
    drift = np.square(np.multiply(gravity, gyro_bias))
    tilt = np.square(gravity) * tilt_variance + np.square(accelerometer_bias) + sg * tc
    return np.asarray(
        (tilt + drift * (tc + t / 2) ** 2) * t**4 / 720
        + drift * t**6 / 100800
        + sa * t**3 / 420
        + 17 * sg * t**5 / 30240
    )


def ins_quadratic_variance(
    aperture_time: ArrayLike,
    accelerometer_noise: ArrayLike,
    gyro_noise: ArrayLike,
    tilt_variance: ArrayLike,
    coast_time: ArrayLike = 0.0,
    gravity: ArrayLike = STANDARD_GRAVITY_M_S2,
    accelerometer_bias: ArrayLike = 0.0,
    gyro_bias: ArrayLike = 0.0,
) -> _FloatArray:
    """Variance [m^2] of the quadratic error at the aperture ends under free INS: [S-5] without the phase."""
    t, tc = np.asarray(aperture_time, float), np.asarray(coast_time, float)
    sa, sg = np.square(accelerometer_noise), np.square(np.multiply(gravity, gyro_noise))
    bias = np.square(accelerometer_bias) + np.square(np.multiply(gravity, gyro_bias)) * (tc + t / 2) ** 2
    tilt = np.square(gravity) * tilt_variance + bias + sg * tc
    return np.asarray(t**4 / 64 * (tilt + 10 / 7 * sa / t + 181 / 462 * sg * t))


def beyond_quadratic_variance(
    aperture_time: ArrayLike,
    accelerometer_noise: ArrayLike,
    gyro_noise: ArrayLike,
    gravity: ArrayLike = STANDARD_GRAVITY_M_S2,
    gyro_bias: ArrayLike = 0.0,
) -> _FloatArray:
    """Mean variance [m^2] of the INS error that no quadratic takes away [T-14]."""
    t = np.asarray(aperture_time, float)
    sa, sg = np.square(accelerometer_noise), np.square(np.multiply(gravity, gyro_noise))
    drift = np.square(np.multiply(gravity, gyro_bias))
    return np.asarray(sa * t**3 / 2520 + sg * t**5 / 55440 + drift * t**6 / 100800)


def fit_quadratic_sigma(
    gnss_sigma: ArrayLike, fix_interval: ArrayLike, aperture_time: ArrayLike, fixes: ArrayLike | None = None
) -> _FloatArray:
    """Standard deviation [m] of the quadratic that GNSS noise puts at the aperture ends [S-7].

    ``fixes``: how many fixes are fitted; N = T / dt as in [C] unless given (an aperture with a fix at both
    ends holds one more, and its noise is lower). Infinite below three fixes, where nothing is determined.
    """
    t, dt = np.asarray(aperture_time, float), np.asarray(fix_interval, float)
    n = np.asarray(t / dt if fixes is None else fixes, float)
    room = np.where(n > 2, n * (n**2 - 1) * (n**2 - 4), 0.0)
    with np.errstate(divide="ignore"):
        return np.asarray(t**2 / 4 * np.asarray(gnss_sigma, float) * np.sqrt(180 / room) / dt**2)


def fit_noise_variance(
    gnss_sigma: ArrayLike, fix_interval: ArrayLike, aperture_time: ArrayLike, fixes: ArrayLike | None = None
) -> _FloatArray:
    """Mean variance [m^2] after the line that the fit adds: (s^2/T) N^4 / ((N^2-1)(N^2-4)) of [T-16]."""
    return np.asarray(
        _QUADRATIC_MEAN_SQUARE * fit_quadratic_sigma(gnss_sigma, fix_interval, aperture_time, fixes) ** 2
    )


def corrected_residual_variance(
    aperture_time: ArrayLike,
    accelerometer_noise: ArrayLike,
    gyro_noise: ArrayLike,
    gnss_sigma: ArrayLike,
    fix_interval: ArrayLike,
    gravity: ArrayLike = STANDARD_GRAVITY_M_S2,
    gyro_bias: ArrayLike = 0.0,
    fixes: ArrayLike | None = None,
) -> _FloatArray:
    """Strategy 5: mean variance [m^2] over the aperture after the line [T-16].

    Exact in the noise of the fixes; the inertial terms take the fit as continuous, see
    `exact_corrected_variance` for few fixes.
    """
    noise = fit_noise_variance(gnss_sigma, fix_interval, aperture_time, fixes)
    rest = beyond_quadratic_variance(aperture_time, accelerometer_noise, gyro_noise, gravity, gyro_bias)
    return np.asarray(noise + rest)


def shrunk_weight(ins_quadratic: ArrayLike, fit_quadratic: ArrayLike) -> _FloatArray:
    """Weight of the fitted quadratic in strategy 5w: var_INS / (var_INS + var_GNSS)."""
    ins, fit = np.asarray(ins_quadratic, float), np.asarray(fit_quadratic, float)
    total = ins + fit
    return np.asarray(np.divide(ins, total, out=np.zeros_like(total), where=total > 0))


def shrunk_residual_variance(
    ins_quadratic: ArrayLike, fit_quadratic: ArrayLike, beyond_quadratic: ArrayLike
) -> _FloatArray:
    """Strategy 5w: mean variance [m^2] after the line: 4/45 of the quadratic left, plus the rest.

    The quadratic left is var_INS var_GNSS / (var_INS + var_GNSS): below both, so 5w loses to neither 2 nor 5.
    """
    left = shrunk_weight(ins_quadratic, fit_quadratic)
    with np.errstate(invalid="ignore"):
        gained = np.where(left > 0, left * np.asarray(fit_quadratic, float), 0.0)
    gained = np.where(np.isfinite(fit_quadratic), gained, ins_quadratic)
    return np.asarray(_QUADRATIC_MEAN_SQUARE * gained + np.asarray(beyond_quadratic, float))


def break_even_aperture(
    accelerometer_noise: ArrayLike,
    gyro_noise: ArrayLike,
    tilt_variance: ArrayLike,
    gnss_sigma: ArrayLike,
    fix_interval: ArrayLike,
    coast_time: ArrayLike = 0.0,
    gravity: ArrayLike = STANDARD_GRAVITY_M_S2,
    accelerometer_bias: ArrayLike = 0.0,
    gyro_bias: ArrayLike = 0.0,
    extra_fixes: float = 0.0,
) -> _FloatArray:
    """Aperture time [s] above which the quadratic correction (5) beats free INS (2, or 3 after a coast).

    [T-15] equals [T-16] there. The noise of the fit falls and what the quadratic holds grows with T, so there
    is one crossing; it is found by bisection over 2 to 1e6 fix intervals to a part in 1e12. The fit has
    N = T / dt + ``extra_fixes`` fixes: 0 as printed, 1 for an aperture with a fix at both ends.
    """
    dt = np.asarray(fix_interval, float)
    arguments = np.broadcast_arrays(
        accelerometer_noise, gyro_noise, tilt_variance, gnss_sigma, dt, coast_time, gravity,
        accelerometer_bias, gyro_bias,
    )  # fmt: skip
    sa, sw, p33, sigma, dt, tc, g, ba, bg = (np.asarray(a, float) for a in arguments)
    low, high = np.log(2.0 * dt), np.log(1e6 * dt)
    for _ in range(70):
        middle = (low + high) / 2
        t = np.exp(middle)
        held = ins_residual_variance(t, sa, sw, p33, tc, g, ba, bg) - beyond_quadratic_variance(t, sa, sw, g, bg)
        worth = held > fit_noise_variance(sigma, dt, t, t / dt + extra_fixes)
        low, high = np.where(worth, low, middle), np.where(worth, middle, high)
    return np.asarray(np.exp((low + high) / 2))


class WinnerMap(NamedTuple):
    """Which strategy to use at each point: index into `strategies`, and sigma (k, ...) [m] of each."""

    strategies: tuple[str, ...]
    winner: NDArray[np.intp]
    sigma: _FloatArray
    best_sigma: _FloatArray


def map_of_winners(
    aperture_time: ArrayLike,
    gnss_sigma: ArrayLike,
    accelerometer_noise: ArrayLike,
    gyro_noise: ArrayLike,
    tilt_variance: ArrayLike,
    fix_interval: ArrayLike,
    coast_time: ArrayLike = 0.0,
    gravity: ArrayLike = STANDARD_GRAVITY_M_S2,
    accelerometer_bias: ArrayLike = 0.0,
    gyro_bias: ArrayLike = 0.0,
    worth: float = 0.05,
    extra_fixes: float = 0.0,
) -> WinnerMap:
    """The strategy that wins among those with a closed form (2, 3, 5, 5w), by detrended sigma.

    5w is never worse than 2 or 5, so it would win everywhere by a hair: the simplest strategy (in the order
    given) within the fraction ``worth`` of the best is the one named. ``tilt_variance`` [rad^2] goes with
    the GNSS noise of each point, so give an array of the same shape. Only 3 carries the coast.
    ``extra_fixes`` as in `break_even_aperture`.
    """
    if not 0 <= worth < 1:
        raise ValueError(f"worth: {worth}; a fraction from 0 to below 1 is needed")
    held = (accelerometer_noise, gyro_noise, tilt_variance)
    biases = (gravity, accelerometer_bias, gyro_bias)
    free = ins_residual_variance(aperture_time, *held, 0.0, *biases)
    coasted = ins_residual_variance(aperture_time, *held, coast_time, *biases)
    fixes = np.divide(aperture_time, fix_interval) + extra_fixes
    fit = fit_quadratic_sigma(gnss_sigma, fix_interval, aperture_time, fixes) ** 2
    rest = beyond_quadratic_variance(aperture_time, accelerometer_noise, gyro_noise, gravity, gyro_bias)
    shrunk = shrunk_residual_variance(ins_quadratic_variance(aperture_time, *held, 0.0, *biases), fit, rest)
    corrected = _QUADRATIC_MEAN_SQUARE * fit + rest
    sigma = np.sqrt(np.stack(np.broadcast_arrays(free, coasted, corrected, shrunk)))
    best = sigma.min(axis=0)
    winner = (sigma <= best * (1 + worth)).argmax(axis=0)
    return WinnerMap(MAP_STRATEGIES, winner, sigma, best)


def exact_corrected_variance(
    aperture_time: float,
    accelerometer_noise: float,
    gyro_noise: float,
    gnss_sigma: float,
    fix_times: ArrayLike,
    gravity: float = STANDARD_GRAVITY_M_S2,
    weight: float = 1.0,
    tilt_variance: float = 0.0,
    nodes: int = 40,
) -> float:
    """Strategy 5 (or 5w) exactly: mean variance [m^2] after the line, with the fit at the fixes themselves.

    The covariance of the integrated noises is carried through the fit and the removal of the line by Gauss
    quadrature over the aperture; one design at a time. Shows where the inertial terms of
    [T-16] stop holding: with fixes at both ends they are at most 13 % low; with the first
    fix one interval after the start they are 3.8 times too low at 3 fixes, 13 % at 11, 3 % at 21.
    """
    fixes = np.asarray(fix_times, float)
    if fixes.size < 3:
        raise ValueError(f"fix_times: {fixes.size} fixes; a quadratic fit needs at least 3")
    x, quadrature = np.polynomial.legendre.leggauss(nodes)
    time = (x + 1) / 2 * aperture_time
    where = np.concatenate([time, fixes])
    early = np.minimum(where[:, None], where[None, :])
    late = np.maximum(where[:, None], where[None, :])
    covariance = accelerometer_noise**2 * early**2 * (3 * late - early) / 6
    covariance += (gravity * gyro_noise) ** 2 * early**3 * (10 * late**2 - 5 * late * early + early**2) / 120
    covariance += gravity**2 * tilt_variance * early**2 * late**2 / 4
    middle = fixes.mean()
    basis, triangle = np.linalg.qr(np.vander(fixes - middle, 3, increasing=True))
    fitted = (np.vander(time - middle, 3, increasing=True) @ np.linalg.inv(triangle)) * [1.0, 1.0, weight]
    fitted = fitted @ basis.T
    share = quadrature / 2
    line = np.stack([np.ones_like(x), np.sqrt(3) * x])
    detrend = np.eye(nodes) - line.T @ (line * share)
    inertial = detrend @ np.hstack([np.eye(nodes), -fitted])
    noise = detrend @ fitted
    variance = np.einsum("ij,jk,ik->i", inertial, covariance, inertial) + gnss_sigma**2 * (noise**2).sum(axis=1)
    return float(share @ variance)


@dataclass(frozen=True)
class Advice:
    """Which strategy to use, why, and what would change the answer: numbers [m, s] and plain words."""

    strategy: str
    sentence: str
    because: str
    would_change: str
    sigma: dict[str, float]
    break_even_aperture: float
    break_even_gnss_sigma: float


def advise(
    aperture_time: float,
    gnss_sigma: float,
    fix_interval: float,
    accelerometer_noise: float,
    gyro_noise: float,
    tilt_variance: float,
    wavelength: float,
    coast_time: float = 0.0,
    gravity: float = STANDARD_GRAVITY_M_S2,
    accelerometer_bias: float = 0.0,
    gyro_bias: float = 0.0,
    required_phase: float | None = None,
    extra_fixes: float = 0.0,
) -> Advice:
    """Plain-words advice for one design. ``required_phase`` [rad]: limit on the detrended phase.

    The GNSS noise at which 2 and 5 break even is given at the design's tilt (which itself depends on the GNSS
    noise, so it is a first estimate and said to be "about").
    """
    result = map_of_winners(
        aperture_time, gnss_sigma, accelerometer_noise, gyro_noise, tilt_variance, fix_interval, coast_time,
        gravity, accelerometer_bias, gyro_bias, extra_fixes=extra_fixes,
    )  # fmt: skip
    sigma = {key: float(value) for key, value in zip(result.strategies, result.sigma, strict=True)}
    chosen = result.strategies[int(result.winner)]
    break_even = float(
        break_even_aperture(
            accelerometer_noise, gyro_noise, tilt_variance, gnss_sigma, fix_interval, 0.0, gravity,
            accelerometer_bias, gyro_bias, extra_fixes,
        )
    )  # fmt: skip
    unit = float(fit_noise_variance(1.0, fix_interval, aperture_time, aperture_time / fix_interval + extra_fixes))
    rest = beyond_quadratic_variance(aperture_time, accelerometer_noise, gyro_noise, gravity, gyro_bias)
    gnss_limit = float(np.sqrt((sigma["2"] ** 2 - rest) / unit)) if np.isfinite(unit) else 0.0
    phase = 4 * np.pi / wavelength
    names = {
        "2": "start the INS from the filter and leave it alone over the aperture",
        "3": "let the INS coast through the aperture",
        "5": "subtract the quadratic fitted to INS minus GNSS over the aperture",
        "5w": "subtract the fitted quadratic, shrunk by its weight",
    }
    sentence = (
        f"Use strategy {chosen}: {names[chosen]}; {_length(sigma[chosen])} "
        f"({np.degrees(phase * sigma[chosen]):.3g}° of phase) remain after the line."
    )
    because = (
        f"Free INS leaves {_length(sigma['2'])}, the full quadratic correction {_length(sigma['5'])}, "
        f"the shrunk one {_length(sigma['5w'])}."
        if np.isfinite(unit)
        else f"Free INS leaves {_length(sigma['2'])}; with fewer than three fixes in the aperture "
        "there is no quadratic to fit."
    )
    if coast_time > 0:
        because += f" After {coast_time:.4g} s without fixes the INS alone would leave {_length(sigma['3'])}."
    side = "longer" if aperture_time >= break_even else "shorter"
    change = f"The full correction pays above an aperture of {break_even:.3g} s; this one is {side}."
    if gnss_limit > 0:
        change += (
            f" At this aperture it pays with fixes better than about {_length(gnss_limit)}; "
            f"these have {_length(gnss_sigma)}."
        )
    if required_phase is not None:
        ratio = phase * sigma[chosen] / required_phase
        verdict = "meets" if ratio <= 1 else "misses"
        change += (
            f" The choice {verdict} the limit of {np.degrees(required_phase):.3g}° "
            f"by a factor of {max(ratio, 1 / ratio):.3g}."
        )
    return Advice(chosen, sentence, because, change, sigma, break_even, gnss_limit)


def _length(metres: float) -> str:
    return f"{metres:.3g} m" if metres >= 1 else f"{metres * 1e3:.3g} mm"
