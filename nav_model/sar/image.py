"""Images: a point target under a phase history, and real phase histories by back-projection.

Phase histories are frequency-domain, range-referenced samples s = sum a exp(-j 4 pi f (R - r0) / c), the form
of the public AFRL collections. Back-projection is exact in geometry and takes any track; the kernel here is
small on purpose. The packaged alternatives need a C++ compiler or a GPU on the user's machine.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav_model.aperture.impulse_response import aperture_positions
from nav_model.aperture.window import Window, weights_of
from nav_model.base.arrays import Array
from nav_model.base.constants import SPEED_OF_LIGHT
from nav_model.base.text.npz_arrays import read_npz_arrays

RANGE_PADDING = 16
MOST_UNPACKED_BYTES = 256 * 2**20
_MOST_LINES = 20_000  # frequencies, and pulses: half a minute for a picture
_PROFILE_BINS = 2**20  # of the pulses that are projected at a time: 16 MB and some copies

_ComplexArray = NDArray[np.complex128]

_FILE_FIELDS = {"fp": "KP", "freq": "K", "x": "P", "y": "P", "z": "P", "r0": "P"}
"""Fields of a phase-history file and their shapes: K frequencies, P pulses."""


@dataclass(frozen=True)
class PhaseHistory:
    """K frequencies of P pulses, SI: ``samples`` (K, P), ``frequency`` (K,) evenly spaced, antenna
    ``position`` (P, 3) and ``reference_range`` (P,)."""

    samples: _ComplexArray
    frequency: Array
    position: Array
    reference_range: Array

    def __post_init__(self) -> None:
        steps = np.diff(self.frequency)
        if len(steps) < 1 or steps.min() <= 0 or np.ptp(steps) > 0.01 * steps.mean():
            raise ValueError("freq: the frequencies must rise in equal steps, two at least")

    @property
    def unambiguous_range(self) -> float:
        """Extent [m] about the reference range that one pulse holds without folding: c / (2 df)."""
        return float(SPEED_OF_LIGHT / (2 * np.diff(self.frequency).mean()))

    @property
    def wavelength(self) -> float:
        """Wavelength [m] of the middle of the band."""
        return float(SPEED_OF_LIGHT / self.frequency.mean())


def read_phase_history(name: str, data: bytes) -> PhaseHistory:
    """Read the bytes of an npz file, called `name` in messages; memory is at most three times `MOST_UNPACKED_BYTES`.

    Fields: ``fp`` (K, P) complex, ``freq`` [Hz] (K,), antenna ``x``, ``y``, ``z`` [m] (P,), ``r0`` [m] (P,).

    Raises
    ------
    ValueError
        If the file is no npz file or too large, or a field is missing, of the wrong shape, or not finite.
    """
    fields = read_npz_arrays(data, name, MOST_UNPACKED_BYTES, "fiuc", _FILE_FIELDS)
    if "fp" not in fields or fields["fp"].ndim != 2:
        raise ValueError(f"{name}: fp is missing or not a (frequencies, pulses) array")
    if fields["fp"].size * np.dtype(complex).itemsize > MOST_UNPACKED_BYTES:
        raise ValueError(
            f"{name}: fp has {fields['fp'].size} samples; "
            f"at most {MOST_UNPACKED_BYTES // np.dtype(complex).itemsize} are taken"
        )
    if max(fields["fp"].shape) > _MOST_LINES:
        raise ValueError(f"{name}: fp has shape {fields['fp'].shape}; at most {_MOST_LINES} of each are taken")
    sizes = dict(zip("KP", fields["fp"].shape, strict=True))
    for key, dimensions in _FILE_FIELDS.items():
        if key not in fields:
            raise ValueError(f"{name}: field {key} is missing")
        shape = tuple(sizes[letter] for letter in dimensions)
        if fields[key].shape != shape:
            raise ValueError(f"{name}: {key} has shape {fields[key].shape}; {shape} is needed")
        if key != "fp" and fields[key].dtype.kind == "c":
            raise ValueError(f"{name}: {key} holds {fields[key].dtype}; numbers are needed")
        if not np.isfinite(fields[key]).all():
            raise ValueError(f"{name}: {key} holds values that are not finite")
    plain = {key: np.asarray(value, float) for key, value in fields.items() if key != "fp"}
    try:
        return PhaseHistory(
            samples=np.asarray(fields["fp"], complex),
            frequency=plain["freq"],
            position=np.stack([plain["x"], plain["y"], plain["z"]], axis=1),
            reference_range=plain["r0"],
        )
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from error


def back_project(
    history: PhaseHistory,
    x: ArrayLike,
    y: ArrayLike,
    range_error: ArrayLike = 0.0,
    window: Window = "uniform",
) -> _ComplexArray:
    """Complex image (len(y), len(x)) on the plane z = 0, mean over pulses and frequencies: amplitude 1 stays 1.

    A pulse adds nothing to pixels farther than half the unambiguous range from its reference.

    Parameters
    ----------
    history : PhaseHistory
        Pulses, frequencies and positions.
    x, y : array_like
        Pixels, m.
    range_error : array_like (P,), optional
        Added to the range assumed for every pixel, m.
    window : str, optional
        Weights both the pulses and the frequencies.
    """
    from nav_model.sar.back_projection import project_pulses

    samples, pulses = history.samples.shape
    in_frequency = weights_of(window, aperture_positions(samples))
    in_pulses = weights_of(window, aperture_positions(pulses))
    weights = np.outer(in_frequency / in_frequency.sum(), in_pulses / in_pulses.sum())
    bins = 1 << int(np.ceil(np.log2(samples * RANGE_PADDING)))
    # Band about zero, so that the profile varies slowly from bin to bin; the middle's phase is added exactly.
    middle = samples // 2
    axes = np.ascontiguousarray(x, float), np.ascontiguousarray(y, float)
    position = np.ascontiguousarray(history.position, float)
    reference = history.reference_range - np.broadcast_to(np.asarray(range_error, float), (pulses,))
    image = np.zeros((len(axes[1]), len(axes[0])), complex)
    # A few pulses at a time: their padded profiles are many times the samples.
    for block in np.array_split(np.arange(pulses), -(-pulses * bins // _PROFILE_BINS)):
        weighted = history.samples[:, block] * weights[:, block]
        padded = np.zeros((len(block), bins), complex)
        padded[:, : samples - middle] = weighted[middle:].T
        padded[:, bins - middle :] = weighted[:middle].T
        image += project_pulses(
            np.fft.fftshift(np.fft.ifft(padded, axis=1), axes=1) * bins,
            position[block],
            reference[block],
            history.unambiguous_range / bins,
            4 * np.pi * float(history.frequency[middle]) / SPEED_OF_LIGHT,
            *axes,
        )
    return image


def point_target_image(
    range_error: ArrayLike,
    wavelength: float,
    range_cell: float,
    azimuth_cells: ArrayLike,
    range_cells: ArrayLike,
    window: Window = "uniform",
) -> Array:
    """Focused point target in dB over the error-free peak, shape (..., azimuth, range).

    Both the phase that a range error makes and the walk through the range cells are kept. Each strategy's errors
    stacked on the leading axis give images on one scale.

    Parameters
    ----------
    range_error : array_like (..., n)
        m, from end to end of the aperture.
    wavelength, range_cell : float
        m; the cell is c / (2 B).
    azimuth_cells, range_cells : array_like
        Places of the pixels, in cells from the target.
    window : str, optional
        In azimuth and in range.
    """
    error = np.asarray(range_error, float)
    x = np.linspace(-1, 1, error.shape[-1])
    weights = weights_of(window, x)
    steering = np.exp(-1j * np.pi * np.multiply.outer(np.asarray(azimuth_cells, float), x))
    pulses = weights / weights.sum() * np.exp(4j * np.pi / wavelength * error)
    nodes, quadrature = np.polynomial.legendre.leggauss(64)
    band = quadrature * weights_of(window, nodes)
    turns = np.exp(1j * np.pi * np.multiply.outer(nodes, np.asarray(range_cells, float)))
    walk = np.exp(-1j * np.pi / range_cell * error[..., None] * nodes) * (band / band.sum())
    image = (steering * pulses[..., None, :]) @ (walk @ turns)
    with np.errstate(divide="ignore"):
        return np.asarray(20 * np.log10(np.abs(image)))


def pulse_errors(time: ArrayLike, error: ArrayLike, pulses: int) -> Array:
    """An error history (..., n) over an aperture laid over the pulses of a file: (..., pulses)."""
    time, error = np.asarray(time, float), np.asarray(error, float)
    place = np.linspace(time[0], time[-1], pulses)
    flat = error.reshape(-1, error.shape[-1])
    return np.stack([np.interp(place, time, row) for row in flat]).reshape(*error.shape[:-1], pulses)
