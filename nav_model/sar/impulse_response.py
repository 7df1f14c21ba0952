"""The azimuth impulse response of an aperture with phase errors: width, side lobes, loss and shift.

One cell is ``lambda R / (2 V T_a)`` in azimuth, 1/T_a in frequency: the distance from the peak of the
unweighted, error-free response to its first null. Aperture samples sit at the middle of their intervals,
``x_n = (2 n + 1 - N) / N`` in (-1, 1), so that sums stand for integrals over the whole aperture.

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

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav_model.sar.lobe_measures import ISLR_NULL_DISTANCES, TIE, half_power_places, measure_line, measure_periodic

Window = Literal["uniform", "hamming", "taylor"]
WINDOWS: tuple[Window, ...] = ("uniform", "hamming", "taylor")

MINIMUM_SAMPLES = 1024
ZERO_PADDING = 64
TAYLOR_LEVEL_DB = -35.0
TAYLOR_NBAR = 5

_FloatArray = NDArray[np.float64]
_ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True)
class Taper:
    """An aperture weighting: its name and, for Taylor, the side-lobe level [dB, negative] and nbar."""

    name: Window = "uniform"
    level_db: float = TAYLOR_LEVEL_DB
    nbar: int = TAYLOR_NBAR

    def __post_init__(self) -> None:
        if self.name not in WINDOWS:
            raise ValueError(f"window: {self.name!r} is not one of {', '.join(WINDOWS)}")
        if not (np.isfinite(self.level_db) and self.level_db < 0):
            raise ValueError(f"window level_db: {self.level_db} dB; a side-lobe level below 0 dB is needed")
        if self.nbar < 1:
            raise ValueError(f"window nbar: {self.nbar}; at least 1 is needed")

    def weights(self, x: ArrayLike) -> _FloatArray:
        """Weight at aperture positions x in [-1, 1]; Taylor after Taylor (1955), Carrara et al. (1995)."""
        x = np.asarray(x, float)
        if self.name == "uniform":
            return np.ones_like(x)
        if self.name == "hamming":
            return np.asarray(0.54 + 0.46 * np.cos(np.pi * x))
        weight = np.ones_like(x)
        for m, coefficient in enumerate(_taylor_coefficients(self.level_db, self.nbar), start=1):
            weight += 2 * coefficient * np.cos(np.pi * m * x)
        return weight


@dataclass(frozen=True)
class ImpulseResponse:
    """What an aperture does to a point. Arrays (or scalars) of the shape of the apertures given.

    ``width_cells``: between the half-power crossings next to the peak. ``half_power_extent_cells``: between
    the outermost half-power crossings, larger than the width when the lobe is split. ``pslr_*``, ``islr_*``
    [dB]: see the module's page for "null", "fixed", whole line and ten nulls. ``peak_loss_db``: peak power
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


def as_taper(window: Window | Taper) -> Taper:
    """The window named, with the product's Taylor (-35 dB, nbar 5) unless a Taper says otherwise."""
    return window if isinstance(window, Taper) else Taper(window)


def aperture_positions(samples: int) -> _FloatArray:
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
    aperture: ArrayLike, window: Window | Taper = "uniform", zero_padding: int = ZERO_PADDING
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
    taper = as_taper(window)
    weights = taper.weights(aperture_positions(samples))
    null = ideal_null_cells(taper)
    rows = aperture.reshape(-1, samples)
    measured = np.empty((len(rows), len(_MEASURES)))
    for row, values in zip(rows, measured, strict=True):
        spectrum = np.fft.fft(row * (weights / weights.sum()), samples * zero_padding)
        power = spectrum.real**2 + spectrum.imag**2
        values[:] = measure_periodic(power, zero_padding, null, samples)
    return _gather(measured, aperture.shape[:-1], null)


def response_curve(
    aperture: ArrayLike,
    window: Window | Taper = "uniform",
    extent_cells: float = 20.0,
    zero_padding: int = 16,
) -> tuple[_FloatArray, _FloatArray]:
    """The response itself: cells from the true position, and power [dB over the error-free peak].

    ``aperture`` (..., N); returns cells (m,) from -extent to +extent and power (..., m).
    """
    aperture = np.asarray(aperture, complex)
    samples = aperture.shape[-1]
    weights = as_taper(window).weights(aperture_positions(samples))
    reach = min(round(extent_cells * zero_padding), samples * zero_padding // 2 - 1)
    offsets = np.arange(-reach, reach + 1)
    chirp, kernel = _chirps(samples, zero_padding, reach)
    spread = np.fft.ifft(np.fft.fft(aperture * (weights / weights.sum()) * chirp, len(kernel)) * kernel)
    with np.errstate(divide="ignore"):
        return offsets / zero_padding, 20 * np.log10(np.abs(spread[..., offsets]))


@cache
def _chirps(samples: int, zero_padding: int, reach: int) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """What the middle of a long padded transform is made with by a short one, but for a phase at each point.

    Source: Bluestein, IEEE Transactions on Audio and Electroacoustics 18(4), 1970.
    """
    length = samples * zero_padding

    def chirp(at: NDArray[np.int64]) -> NDArray[np.complex128]:
        turned: NDArray[np.complex128] = np.exp(-1j * np.pi / length * (at**2 % (2 * length)))
        return turned

    distances = np.arange(-reach - samples + 1, reach + 1)
    kernel = np.zeros(1 << len(distances).bit_length(), complex)
    kernel[distances] = chirp(distances).conj()
    return chirp(np.arange(samples)), np.fft.fft(kernel)


def quadratic_response(
    quadratic_rad: float, window: Window | Taper = "uniform", cubic_rad: float = 0.0
) -> ImpulseResponse:
    """Fast response of the pure phase ``quadratic x^2 + cubic x^3`` [rad at the aperture ends], scalars.

    The aperture integral is done by Gauss-Legendre quadrature on a line of a few tens of cells around the
    lobe, the energy of the whole line by Parseval's theorem, so no long transform is needed. Agrees with
    `impulse_response` (N = 1024, x64) within 0.005 dB and 0.001 cell up to a QPE of 9 rad; beyond 8 cells of
    spread (a QPE of 4 pi) it hands over to `impulse_response` with as many samples as the phase needs.
    """
    taper, spread = as_taper(window), _spread(quadratic_rad, cubic_rad)
    if spread > _FAST_SPREADS[-1]:
        return _sampled_polynomial_response(quadratic_rad, cubic_rad, taper, spread)
    line = _fast_line(taper, next(limit for limit in _FAST_SPREADS if spread <= limit))
    power = _power(line, quadratic_rad, cubic_rad)
    peak = _peak(power)
    values = measure_line(power, peak, _FAST_PADDING, line.null, line.total_energy, len(power) // 2)
    return _gather(np.array([values]), (), line.null)


def half_power_extent(quadratic_rad: float, window: Window | Taper = "uniform") -> float:
    """``half_power_extent_cells`` of `quadratic_response`, to rounding: without side lobes in a third of its time."""
    spread = _spread(quadratic_rad)
    if spread > _FAST_SPREADS[-1]:
        return float(quadratic_response(quadratic_rad, window).half_power_extent_cells)
    limit = next(limit for limit in _FAST_SPREADS if spread <= limit)
    near = round((limit / 2 + _WIDEST) * _FAST_PADDING)
    power = _power(_fast_line(as_taper(window), limit), quadratic_rad, 0.0, slice(near))
    low, high = half_power_places(power, _peak(power))
    return (high - low) / _FAST_PADDING


def polynomial_curve(
    quadratic_rad: float, cubic_rad: float, window: Window | Taper, extent_cells: float, zero_padding: int = 16
) -> tuple[_FloatArray, _FloatArray]:
    """`response_curve` of the phase ``quadratic x² + cubic x³``, without and with the cubic: power [dB] is (2, m).

    From the aperture's integral where that is fast, from as many samples as `response_curve` takes beyond.
    """
    spread = _spread(quadratic_rad, cubic_rad)
    if spread > _FAST_SPREADS[-1]:
        x = aperture_positions(MINIMUM_SAMPLES)
        phases = quadratic_rad * x**2 + np.array([[0.0], [cubic_rad]]) * x**3
        return response_curve(np.exp(1j * phases), window, extent_cells, zero_padding)
    line = _fast_line(as_taper(window), next(limit for limit in _FAST_SPREADS if spread <= limit))
    reach, step = round(extent_cells * zero_padding), _FAST_PADDING // zero_padding
    shown = slice(0, reach * step + 1, step)
    power = np.stack([_power(line, quadratic_rad, cubic, shown) for cubic in (0.0, cubic_rad)])
    with np.errstate(divide="ignore"):
        return np.arange(-reach, reach + 1) / zero_padding, 10 * np.log10(power)


def _spread(quadratic_rad: float, cubic_rad: float = 0.0) -> float:
    """Instantaneous frequency at the ends of the aperture, cells from end to end."""
    if not (np.isfinite(quadratic_rad) and np.isfinite(cubic_rad)):
        raise ValueError(f"phase: {quadratic_rad}, {cubic_rad} rad; finite numbers are needed")
    return float(2 * abs(quadratic_rad) + 3 * abs(cubic_rad)) / np.pi


def _power(line: _FastLine, quadratic_rad: float, cubic_rad: float, columns: slice = slice(None)) -> _FloatArray:
    """Power on both sides of the target, at the columns of the right half line."""
    turn = quadratic_rad * line.x**2
    even = line.weights * np.stack([np.cos(turn), np.sin(turn)])
    cosines = line.cosines[:, columns]
    if cubic_rad == 0.0:
        half = (_product(even, cosines) ** 2).sum(axis=0)
        return np.concatenate([half[:0:-1], half])
    bend = cubic_rad * line.x**3
    cosine_part = _product(even * np.cos(bend), cosines)
    sine_part = _product(even * np.sin(bend), line.sines[:, columns])
    upper = ((cosine_part + sine_part) ** 2).sum(axis=0)
    lower = ((cosine_part - sine_part) ** 2).sum(axis=0)
    return np.concatenate([lower[:0:-1], upper])


def _peak(power: _FloatArray) -> int:
    """Index of the highest; of two equal lobes, the one ahead."""
    return int(np.flatnonzero(power >= power.max() * TIE)[-1])


def with_echoes(response: ImpulseResponse, echo: float, stays: float, stays_near: float) -> ImpulseResponse:
    """A response with the echoes and the scattered energy of phase errors beyond its main lobe. [P-9], [P-11]

    Parameters
    ----------
    response : ImpulseResponse
        Of one aperture.
    echo : float
        Amplitude of the highest echo over the target's.
    stays, stays_near : float
        Power that stays in the response; what would stay with the errors within ten null distances alone.
    """

    def ratio(db: NDArray[np.float64] | float, power: float) -> float:
        side = 10 ** (db / 10)
        return 10 * float(np.log10(side + (1 + side) * (1 / power - 1)))

    level = 20 * float(np.log10(echo))
    return replace(
        response,
        pslr_null_db=max(float(response.pslr_null_db), level),
        pslr_fixed_db=max(float(response.pslr_fixed_db), level),
        islr_null_db=ratio(response.islr_null_db, stays),
        islr_fixed_db=ratio(response.islr_fixed_db, stays),
        islr_null_ten_db=ratio(response.islr_null_ten_db, stays_near),
        islr_fixed_ten_db=ratio(response.islr_fixed_ten_db, stays_near),
        peak_loss_db=response.peak_loss_db + 10 * float(np.log10(stays)),
    )


def ideal_null_cells(window: Window | Taper) -> float:
    """Distance from the peak to the first null (first minimum) of the error-free response [cells]."""
    return _ideal_null(as_taper(window))


_UNTHREADED = 1 << 18
"""Multiplications up to which OpenBLAS leaves its threads asleep: on a busy machine waking them takes manyfold."""


def _product(rows: _FloatArray, matrix: _FloatArray) -> _FloatArray:
    """``rows @ matrix``, in pieces small enough for one thread."""
    width = max(1, _UNTHREADED // rows.size)
    return np.hstack([rows @ matrix[:, at : at + width] for at in range(0, matrix.shape[1], width)])


# --- measuring -------------------------------------------------------------------------------------------


def _gather(measured: _FloatArray, shape: tuple[int, ...], null: float) -> ImpulseResponse:
    columns = {
        name: float(measured[0, i]) if shape == () else measured[:, i].reshape(shape)
        for i, name in enumerate(_MEASURES)
    }
    return ImpulseResponse(**columns, ideal_null_cells=null)


# --- windows and the fast line ---------------------------------------------------------------------------


@cache
def _taylor_coefficients(level_db: float, nbar: int) -> tuple[float, ...]:
    a = np.arccosh(10 ** (-level_db / 20)) / np.pi
    stretch = nbar**2 / (a**2 + (nbar - 0.5) ** 2)
    order = np.arange(1, nbar)
    coefficients = []
    for m in order:
        numerator = np.prod(1 - m**2 / (stretch * (a**2 + (order - 0.5) ** 2)))
        denominator = np.prod(1 - m**2 / order[order != m] ** 2)
        coefficients.append(float((-1) ** (m + 1) * numerator / (2 * denominator)))
    return tuple(coefficients)


@cache
def _ideal_null(taper: Taper) -> float:
    """First minimum of the error-free response, by golden-section refinement of a coarse line."""
    x, weights = np.polynomial.legendre.leggauss(64)
    weights = weights * taper.weights(x)

    def amplitude(cells: float) -> float:
        return abs(float(np.cos(np.pi * cells * x) @ weights))

    step = 1 / 64
    cells = 0.0
    while amplitude(cells + step) < amplitude(cells):
        cells += step
    low, high = cells - step, cells + step
    ratio = (np.sqrt(5) - 1) / 2
    while high - low > 1e-9:
        inner, outer = high - ratio * (high - low), low + ratio * (high - low)
        low, high = (low, outer) if amplitude(inner) < amplitude(outer) else (inner, high)
    return float((low + high) / 2)


_FAST_PADDING = ZERO_PADDING  # the same grid, so that both routes find the same shallow minima
_FAST_SPREADS = (1.0, 3.0, 8.0)  # cells of spread for which a prepared line is kept
_WIDEST = 3.0  # cells beyond half the spread, farther than half the peak reaches under any window


@dataclass(frozen=True)
class _FastLine:
    """Quadrature nodes on the right half aperture and the transform to the right half line."""

    x: _FloatArray
    weights: _FloatArray
    cosines: _FloatArray
    sines: _FloatArray
    null: float
    total_energy: float


@cache
def _fast_line(taper: Taper, spread: float) -> _FastLine:
    null = _ideal_null(taper)
    # The minima move out with the error, and ten null distances with them.
    reach = (ISLR_NULL_DISTANCES + 1) * (2 * null + 1 + spread / 4) + spread
    cells = np.arange(int(np.ceil(reach * _FAST_PADDING)) + 1) / _FAST_PADDING
    # A half aperture holds pi (cells + spread) radians at most: Gauss needs about half a node per radian.
    nodes = int(np.ceil(0.5 * np.pi * (cells[-1] + spread))) + 24
    x, quadrature = np.polynomial.legendre.leggauss(nodes)
    x, quadrature = (x + 1) / 2, quadrature / 2
    shape = taper.weights(x)
    area = 2 * float(quadrature @ shape)
    angle = np.pi * np.outer(x, cells)
    return _FastLine(
        x=x,
        weights=quadrature * shape / area,
        cosines=2 * np.cos(angle),
        sines=2 * np.sin(angle),
        null=null,
        total_energy=2 * 2 * float(quadrature @ shape**2) / area**2,
    )


def _sampled_polynomial_response(
    quadratic_rad: float, cubic_rad: float, taper: Taper, spread: float
) -> ImpulseResponse:
    samples = max(MINIMUM_SAMPLES, 1 << int(np.ceil(np.log2(8 * spread))))
    if samples > 1 << 17:
        raise ValueError(
            f"phase: {quadratic_rad:.4g}, {cubic_rad:.4g} rad spread the response over {spread:.3g} cells; "
            "no image is left beyond 16000 cells"
        )
    padding = ZERO_PADDING if samples == MINIMUM_SAMPLES else 16
    x = aperture_positions(samples)
    return impulse_response(np.exp(1j * (quadratic_rad * x**2 + cubic_rad * x**3)), taper, padding)
