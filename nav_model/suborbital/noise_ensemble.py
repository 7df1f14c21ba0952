"""White noise as an ensemble of INS runs, compared with the covariance that predicts them."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError
from nav_model.earth.rotation import matrix_from_vector
from nav_model.suborbital.mechanisation import AttitudeFrames, mechanise
from nav_model.suborbital.navigation_errors import navigation_errors
from nav_model.suborbital.study import Study

MOST_RUNS = 10_000
LEVEL = 0.95
"""Of the interval an ensemble's rms is judged by."""


@dataclass(frozen=True)
class NoiseEnsemble:
    """Ensemble of n runs with white noise alone, north, east, up, m.

    pure_rms_m, aided_rms_m (m, 3) at the times of the study; pure_sigma_m, aided_sigma_m: what the covariance of
    [B-4] predicts; low, high: factors on a true sigma between which the rms of n runs lies with probability
    `LEVEL` (chi-square).
    """

    runs: int
    seed: int
    pure_rms_m: Array = field(repr=False)
    aided_rms_m: Array = field(repr=False)
    pure_sigma_m: Array = field(repr=False)
    aided_sigma_m: Array = field(repr=False)
    low: float
    high: float
    source: str = "INS [B-3] with white noise [B-1] alone; prediction: covariance of [B-4]"

    @property
    def final(self) -> tuple[tuple[str, str, float, float, bool], ...]:
        """At the end: INS, channel, rms and predicted sigma, m, and whether the rms is inside the interval."""
        rows = []
        for ins, rms, sigma in (
            ("INS alone", self.pure_rms_m[-1], self.pure_sigma_m[-1]),
            ("INS with star tracker", self.aided_rms_m[-1], self.aided_sigma_m[-1]),
        ):
            for channel, measured, predicted in zip(("north", "east", "height"), rms, sigma, strict=True):
                inside = self.low * predicted <= measured <= self.high * predicted
                rows.append((ins, channel, float(measured), float(predicted), bool(inside)))
        return tuple(rows)


def noise_ensemble(
    study: Study,
    runs: int = 100,
    seed: int = 1,
    *,
    aided: bool = False,
    star_covariance: Array | None = None,
    progress: Callable[[float], None] | None = None,
) -> Array:
    """Position error histories (runs, m, 3), north, east, up [m], of an INS with white noise alone, by Monte Carlo.

    Each step holds one draw of density white_noise per axis. Compare with `Study.pure_noise` and `aided_noise`, its
    prediction.

    Parameters
    ----------
    study : Study
        Flight, errors and star frames.
    runs, seed : int, optional
        Number of runs, and the seed of their noise.
    aided : bool, optional
        True with the study's star frames.
    star_covariance : array (n+1, 3, 3), optional
        Covariance of the error of each frame, body axes, rad²; a perfect camera by default.
    progress : callable, optional
        Takes the share done.

    Raises
    ------
    InputError
        For a number of runs that is not allowed.
    """
    if not 1 <= runs <= MOST_RUNS:
        raise InputError("runs", f"{runs} is not allowed; it must be 1 to {MOST_RUNS}", runs)
    flight, errors = study.flight, study.inputs.errors
    sigma = np.repeat([errors.accelerometers.white_noise, errors.gyros.white_noise], 3)
    generator = np.random.default_rng(seed)
    true_attitude = np.ascontiguousarray(flight.attitude_bi)
    spread = None if star_covariance is None else _roots(star_covariance, study.used)
    nothing = np.zeros(study.parameters.shape[1])
    out = np.empty((runs, len(study.pure.time_s), 3))
    for member in range(runs):
        noise = generator.standard_normal((1, flight.steps, 6)) * sigma / np.sqrt(flight.step_s)
        frames = None
        if aided:
            attitude = true_attitude
            if spread is not None:
                drawn = np.einsum("tij,tj->ti", spread, generator.standard_normal((flight.steps + 1, 3)))
                attitude = attitude @ matrix_from_vector(drawn)
            frames = AttitudeFrames(study.used, attitude)
        run = mechanise(
            flight, nothing, errors, frames=(frames,), noise=noise, gravity=flight.gravity, every=study.every
        )
        out[member] = navigation_errors(flight, run).position_m[0]
        if progress is not None:
            progress((member + 1) / runs)
    return out


def _roots(covariance: Array, used: np.ndarray) -> Array:
    """Cholesky factors where a frame is used, zero elsewhere."""
    out = np.zeros_like(covariance)
    out[used] = np.linalg.cholesky(covariance[used])
    return out


def fly_noise(
    study: Study,
    runs: int = 100,
    seed: int = 1,
    star_covariance: Array | None = None,
    *,
    progress: Callable[[float, str], None] | None = None,
) -> NoiseEnsemble:
    """The ensemble without and with the star tracker, on the same draws of sensor noise where the camera is perfect.

    Parameters
    ----------
    study, runs, seed, star_covariance
        As `noise_ensemble`.
    progress : callable, optional
        Takes the share done and a few words.

    Raises
    ------
    InputError
        As `noise_ensemble`.
    """
    from scipy.stats import chi2

    rms = []
    for half, (aided, what) in enumerate(((False, "INS alone"), (True, "INS with star tracker"))):

        def say(share: float, half: int = half, what: str = what) -> None:
            if progress is not None:
                progress(0.5 * (half + share), f"white noise, {what}")

        errors = noise_ensemble(study, runs, seed, aided=aided, star_covariance=star_covariance, progress=say)
        rms.append(np.sqrt(np.mean(errors**2, axis=0)))
    low, high = np.sqrt(chi2.ppf([0.5 * (1 - LEVEL), 0.5 * (1 + LEVEL)], runs) / runs)
    return NoiseEnsemble(
        runs=runs,
        seed=seed,
        pure_rms_m=rms[0],
        aided_rms_m=rms[1],
        pure_sigma_m=study.pure_noise.position_sigma_m,
        aided_sigma_m=study.aided_noise.position_sigma_m,
        low=float(low),
        high=float(high),
    )
