"""The azimuth impulse response of an aperture with phase errors: width, side lobes, loss and shift.

One cell is ``lambda R / (2 V T_a)`` in azimuth, 1/T_a in frequency: the distance from the peak of the
unweighted, error-free response to its first null. Aperture samples sit at the middle of their intervals,
``x_n = (2 n + 1 - N) / N`` in (-1, 1), so that sums approximate integrals over the whole aperture.

Side-lobe ratios are given both ways (sar.md, "Impulse response"):

* "null": the main lobe ends at the first minimum found on each side of the peak;
* "fixed": the main lobe is the null-to-null interval of the error-free response, centred on the peak.

Under a taper a quadratic phase error moves the minima outwards and the null-based ratios look perfect while
the shoulder is high: read both. ISLR is given over the whole line (all the energy there is) and over ten null
distances beyond each end of the main lobe. The null distance is that of the main lobe itself: for "null" the
farther of the two minima found, for "fixed" that of the error-free response. Energies are integrals, that is,
trapezoidal sums up to the interpolated minima; a sum that counts both end samples in full differs by some
hundredths of a decibel when the minima are filled (0.04 dB at a QPE of pi/2, sixty-four samples to a cell).
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav_model.aperture.lobe_measures import measure_periodic
from nav_model.aperture.window import Window, ideal_null_cells, weights_of
from nav_model.base.arrays import Array

MINIMUM_SAMPLES = 1024
ZERO_PADDING = 64

_ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True)
class ImpulseResponse:
    """Measures of a point target's response. Arrays (or scalars) of the shape of the apertures given.

    ``width_cells``: between the half-power crossings next to the peak. ``half_power_extent_cells``: between
    the outermost half-power crossings, larger than the width when the lobe is split. ``pslr_*``, ``islr_*``
    [dB]: see the module for "null", "fixed", whole line and ten nulls. ``peak_loss_db``: peak power
    over that of the error-free response (zero or negative). ``shift_cells``: of the peak, positive for a
    phase that grows along the aperture. ``ideal_null_cells``: the null distance used for "fixed".
    """

    width_cells: NDArray[np.float64] | float
    half_power_extent_cells: NDArray[np.float64] | float
    pslr_null_db: NDArray[np.float64] | float
    pslr_fixed_db: NDArray[np.float64] | float
    islr_null_db: NDArray[np.float64] | float
    islr_fixed_db: NDArray[np.float64] | float
    islr_null_ten_db: NDArray[np.float64] | float
    islr_fixed_ten_db: NDArray[np.float64] | float
    peak_loss_db: NDArray[np.float64] | float
    shift_cells: NDArray[np.float64] | float
    ideal_null_cells: float


_MEASURES = tuple(ImpulseResponse.__dataclass_fields__)[:-1]


def aperture_positions(samples: int) -> Array:
    """Mid-interval positions of the samples along the aperture, x in (-1, 1)."""
    return (2 * np.arange(samples) + 1 - samples) / samples


def aperture_of_phase(phase_rad: ArrayLike, samples: int = MINIMUM_SAMPLES, keep: bool = True) -> _ComplexArray:
    """Unit-amplitude aperture exp(j phase), shape (..., n), of a phase history sampled from end to end.

    ``phase_rad`` (..., m) has its first sample at the start and its last at the end of the aperture, as a
    simulation gives it; it is interpolated linearly onto max(m, samples) mid-interval positions;
    with ``keep=False`` onto `samples` whatever m (what is faster than half the new rate folds).
    """
    phase = np.asarray(phase_rad, float)
    if phase.ndim == 0 or phase.shape[-1] < 2:
        raise ValueError(f"phase_rad: shape {phase.shape}; at least 2 samples on the last axis are needed")
    count = max(phase.shape[-1], samples) if keep else samples
    place = (aperture_positions(count) + 1) * (phase.shape[-1] - 1) / 2
    before = np.minimum(place.astype(int), phase.shape[-1] - 2)
    part = place - before
    return np.asarray(np.exp(1j * (phase[..., before] * (1 - part) + phase[..., before + 1] * part)))


def impulse_response(
    aperture: ArrayLike, window: Window = "uniform", zero_padding: int = ZERO_PADDING
) -> ImpulseResponse:
    """Impulse response of complex aperture samples, shape (..., N), N >= 1024 on the last axis.

    The amplitude is taken as it comes (the reference for the loss is an aperture of unit amplitude). The
    spectrum is periodic, so the peak is rotated to the middle before anything is measured: a response
    shifted anywhere along the line is measured like a centred one. Half-power crossings and peaks are
    interpolated between the samples of the padded spectrum. An aperture whose response never falls to half
    its peak gets the whole line, N cells, as its width. [sar.md, Impulse response]

    Raises ValueError for fewer than 1024 samples, values that are not finite, or an aperture of zeros.
    """
    aperture = np.asarray(aperture, complex)
    samples = aperture.shape[-1] if aperture.ndim else 0
    if samples < MINIMUM_SAMPLES:
        raise ValueError(f"aperture: {samples} samples; at least {MINIMUM_SAMPLES} are needed")
    if not np.isfinite(aperture).all():
        raise ValueError("aperture: values that are not finite; every sample must be a finite number")
    if zero_padding < 4:
        raise ValueError(f"zero_padding: {zero_padding}; at least 4 is needed to find the lobes")
    weights = weights_of(window, aperture_positions(samples))
    null = ideal_null_cells(window)
    rows = aperture.reshape(-1, samples)
    measured = np.empty((len(rows), len(_MEASURES)))
    for row, values in zip(rows, measured, strict=True):
        spectrum = np.fft.fft(row * (weights / weights.sum()), samples * zero_padding)
        power = spectrum.real**2 + spectrum.imag**2
        values[:] = measure_periodic(power, zero_padding, null, samples)
    return gathered(measured, aperture.shape[:-1], null)


def response_curve(
    aperture: ArrayLike,
    window: Window = "uniform",
    extent_cells: float = 20.0,
    zero_padding: int = 16,
) -> tuple[Array, Array]:
    """Cells (m,) from -extent to +extent of the true position, and power (..., m) in dB over the error-free peak.

    Parameters
    ----------
    aperture : array_like (..., N)
        Complex samples.
    window : str, optional
        Weighting.
    extent_cells : float, optional
        On each side.
    zero_padding : int, optional
        Points a cell.
    """
    cells, power = near_power(aperture, window, extent_cells, zero_padding)
    with np.errstate(divide="ignore"):
        return cells, 10 * np.log10(power)


def near_power(aperture: ArrayLike, window: Window, extent_cells: float, zero_padding: int) -> tuple[Array, Array]:
    """`response_curve`, its power as a ratio; fast where extents are few, as what depends on one alone is kept.

    Parameters
    ----------
    aperture, window, extent_cells, zero_padding
        As `response_curve`.
    """
    aperture = np.asarray(aperture, complex)
    samples = aperture.shape[-1]
    weights = weights_of(window, aperture_positions(samples))
    reach = min(round(extent_cells * zero_padding), samples * zero_padding // 2 - 1)
    offsets = np.arange(-reach, reach + 1)
    chirp, kernel = _chirps(samples, zero_padding, reach)
    spread = np.fft.ifft(np.fft.fft(aperture * (weights / weights.sum()) * chirp, len(kernel)) * kernel)
    near = spread[..., offsets]
    return offsets / zero_padding, near.real**2 + near.imag**2


@cache
def _chirps(samples: int, zero_padding: int, reach: int) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Chirps that give the middle of a long padded transform by a short one, up to a phase at each point.

    Source: Bluestein, IEEE Transactions on Audio and Electroacoustics 18(4), 1970.
    """
    length = samples * zero_padding

    def chirp(at: NDArray[np.int64]) -> NDArray[np.complex128]:
        phases: NDArray[np.complex128] = np.exp(-1j * np.pi / length * (at**2 % (2 * length)))
        return phases

    distances = np.arange(-reach - samples + 1, reach + 1)
    kernel = np.zeros(1 << len(distances).bit_length(), complex)
    kernel[distances] = chirp(distances).conj()
    return chirp(np.arange(samples)), np.fft.fft(kernel)


def with_echoes(response: ImpulseResponse, echo: float, coherent: float, coherent_near: float) -> ImpulseResponse:
    """A response with the echoes and the scattered energy of phase errors beyond its main lobe. [P-9], [P-11]

    Parameters
    ----------
    response : ImpulseResponse
        Of one aperture.
    echo : float
        Amplitude of the highest echo over the target's.
    coherent, coherent_near : float
        Power that stays in the response; the same with only the errors within ten null distances.
    """

    def ratio(db: NDArray[np.float64] | float, power: float) -> float:
        side = 10 ** (db / 10)
        return 10 * float(np.log10(side + (1 + side) * (1 / power - 1)))

    level = 20 * float(np.log10(echo))
    return replace(
        response,
        pslr_null_db=max(float(response.pslr_null_db), level),
        pslr_fixed_db=max(float(response.pslr_fixed_db), level),
        islr_null_db=ratio(response.islr_null_db, coherent),
        islr_fixed_db=ratio(response.islr_fixed_db, coherent),
        islr_null_ten_db=ratio(response.islr_null_ten_db, coherent_near),
        islr_fixed_ten_db=ratio(response.islr_fixed_ten_db, coherent_near),
        peak_loss_db=response.peak_loss_db + 10 * float(np.log10(coherent)),
    )


def gathered(measured: Array, shape: tuple[int, ...], null: float) -> ImpulseResponse:
    """Rows of measures, in the order of the fields, as a response of this shape; `null` [cells]."""
    columns = {
        name: float(measured[0, i]) if shape == () else measured[:, i].reshape(shape)
        for i, name in enumerate(_MEASURES)
    }
    return ImpulseResponse(**columns, ideal_null_cells=null)
