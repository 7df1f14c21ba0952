"""Instrument outputs from perfect increments, and the random errors of a run."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.base.compiled import part
from nav_model.simulation.specification import TriadModel

FloatArray = NDArray[np.float64]


class Triad(NamedTuple):
    """One triad in one run, discretised at the IMU's rate. `markov`, `walk` and `residual` change as it
    flies.

    white: sigma of one increment's noise; fixed: turn-on bias (3); markov, walk: the two moving biases (3)
    with their step constants; constant: turn-on bias and what constant errors make of a mean force and rate (3);
    distortion: identity plus scale factors and misalignments (3, 3);
    quantum: size of one output count; residual: what quantization holds back until the next sample (3).
    """

    white: float
    fixed: FloatArray
    markov: FloatArray
    markov_decay: float
    markov_drive: float
    walk: FloatArray
    walk_drive: float
    constant: FloatArray
    distorted: bool
    distortion: FloatArray
    quantum: float
    residual: FloatArray


def draw_triad(model: TriadModel, rate: float, vibration_factor: float, generator: np.random.Generator) -> Triad:
    """The triad of one run: constants drawn, moving biases started in their stationary state.

    Parameters
    ----------
    model : TriadModel
        Sigmas of its errors.
    rate : float
        Samples per second.
    vibration_factor : float
        On the random walk.
    generator : numpy.random.Generator
        Of the draws.
    """
    dt = 1.0 / rate
    decay = math.exp(-dt / model.correlation_time)
    fixed = model.turn_on_bias * generator.standard_normal(3)
    markov = model.bias_instability * generator.standard_normal(3)
    distortion = np.eye(3)
    distortion += np.diag(model.scale_factor * generator.standard_normal(3))
    crossed = model.misalignment * generator.standard_normal((3, 3))
    distortion += crossed - np.diag(np.diag(crossed))
    return Triad(
        white=model.random_walk * vibration_factor * math.sqrt(dt),
        fixed=fixed,
        markov=markov,
        markov_decay=decay,
        markov_drive=model.bias_instability * math.sqrt(-math.expm1(-2.0 * dt / model.correlation_time)),
        walk=np.zeros(3),
        walk_drive=model.rate_random_walk * math.sqrt(dt),
        constant=fixed,
        distorted=model.scale_factor > 0.0 or model.misalignment > 0.0,
        distortion=distortion,
        quantum=model.quantization,
        residual=np.zeros(3),
    )


@part
def measure(triad: Triad, true: FloatArray, dt: float, generator: np.random.Generator, out: FloatArray) -> None:
    """Report the increment of one sample; advances the moving biases by the sample.

    Parameters
    ----------
    triad : Triad
        Errors of a run.
    true : array (3,)
        True increment.
    dt : float
        Seconds.
    generator : numpy.random.Generator
        Of the noise.
    out : array (3,)
        Takes the increment.
    """
    for i in range(3):
        value = true[i]
        if triad.distorted:
            row = triad.distortion[i]
            value = row[0] * true[0] + row[1] * true[1] + row[2] * true[2]
        value += (triad.fixed[i] + triad.markov[i] + triad.walk[i]) * dt
        if triad.white > 0.0:
            value += triad.white * generator.standard_normal()
        if triad.markov_drive > 0.0:
            triad.markov[i] = triad.markov_decay * triad.markov[i] + triad.markov_drive * generator.standard_normal()
        if triad.walk_drive > 0.0:
            triad.walk[i] += triad.walk_drive * generator.standard_normal()
        if triad.quantum > 0.0:
            total = value + triad.residual[i]
            value = math.floor(total / triad.quantum + 0.5) * triad.quantum
            triad.residual[i] = total - value
        out[i] = value
