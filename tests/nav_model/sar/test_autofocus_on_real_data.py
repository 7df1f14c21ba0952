"""Phase that an autofocus leaves, on the public X-band collection, against the prediction."""

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pytest

from nav_model import read_design
from nav_model.aperture.autofocus import after_phase_gradient, noise_of_phase_gradient
from nav_model.aperture.phase import total
from nav_model.base.constants import SPEED_OF_LIGHT
from nav_model.budget.inputs import inputs_of
from nav_model.budget.real_time import RealTime
from nav_model.sar.image import PhaseHistory, back_project, read_phase_history
from tests.support.phase_gradient import next_phase, phases_of, without_line

SHARED = Path(__file__).parents[3].parent / "shared" / "data"
COLLECTION = [SHARED / f"sar_gotcha_pass1_az00{k}_HH.npz" for k in (1, 2)]
MEMS = read_design("examples/mems_x_band.toml")
BLOCKS, CELL = 13, 1.30  # 117 pulses in blocks of nine; m of azimuth
AZIMUTH, RANGES = np.arange(-30, 30, CELL / 4), np.arange(-40, 40, 0.34)  # a row for each range cell on the ground
SIDES = BLOCKS * 4 // 2  # pixels that a block tells apart, each side of a point
CAPTURE = math.pi / 4 * BLOCKS

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(
        not all(path.exists() for path in COLLECTION), reason="../shared/data (public X-band collection) is absent"
    ),
]


@dataclass
class Autofocused:
    """Phase that is removed from a history [rad], and the points that it was taken from."""

    removed: np.ndarray
    points: int
    contrast: float

    @cached_property
    def estimation(self) -> float:
        """Variance that is predicted of the phase, the line out. [S-10]"""
        noise = noise_of_phase_gradient(BLOCKS, np.array(float(self.points)), np.array(self.contrast))
        return float(noise.sigma**2 * noise.weights[2])


def seen_from(history: PhaseHistory, points: np.ndarray) -> np.ndarray:
    """Pulses (points, pulses) of range bins, each about its point (x, y) [m]."""
    places = np.column_stack([points, np.zeros(len(points))])[:, None]
    beyond = np.linalg.norm(history.position - places, axis=2) - history.reference_range
    turns = np.exp(4j * np.pi / SPEED_OF_LIGHT * history.frequency[:, None] * beyond[:, None])
    return np.mean(history.samples * turns, axis=1)


def autofocus(history: PhaseHistory, phase: np.ndarray, bins: slice = slice(None)) -> Autofocused:
    """A phase gradient on a history with a phase error, from some of the 60 range bins with the clearest point."""
    removed = np.zeros_like(phase)
    for _ in range(5):
        left = -(phase - removed) * history.wavelength / (4 * np.pi)
        power = np.abs(back_project(history, RANGES, AZIMUTH, range_error=left).T) ** 2
        brightest = SIDES + power[:, SIDES:-SIDES].argmax(axis=1)
        around = brightest[:, None] + np.setdiff1d(np.arange(-SIDES, SIDES + 1), np.arange(-6, 7))
        rows = np.arange(len(RANGES))
        clutter = power[rows[:, None], around].mean(axis=1)
        contrast = power[rows, brightest] / clutter
        chosen = np.sort(np.argsort(contrast)[-60:])[bins]
        pulses = seen_from(history, np.column_stack([RANGES, AZIMUTH[brightest]])[chosen])
        pulses = pulses * np.exp(1j * phase) / np.sqrt(clutter[chosen])[:, None]
        removed = next_phase(pulses, removed, BLOCKS)
    return Autofocused(without_line(removed), len(chosen), float(contrast[chosen].mean()))


@pytest.fixture(scope="module", params=COLLECTION, ids=["az001", "az002"])
def history(request: pytest.FixtureRequest) -> PhaseHistory:
    return read_phase_history(request.param.name, request.param.read_bytes())


def test_a_phase_error_put_in_is_removed_but_for_what_is_predicted(history: PhaseHistory, compared) -> None:
    """Draws above 20°, of a quadratic below two thirds of the capture: beyond, the brightest pixel of a point that
    fills the window is no longer near its middle. Errors that the file has as it is are taken out."""
    x, pulses = inputs_of(MEMS), history.samples.shape[1]
    as_it_is = autofocus(history, np.zeros(pulses))
    lines = total(RealTime(x).phase_by_source(after_phase_gradient(BLOCKS))).detrended * x.to_phase**2
    draws = without_line(phases_of(MEMS, 12, pulses, np.random.default_rng(1)))
    quadratic = np.polynomial.polynomial.polyfit(np.linspace(-1, 1, pulses), draws.T, 2)[2]
    within = (draws.std(axis=1) > math.radians(20)) & (np.abs(quadratic) < CAPTURE * 2 / 3)
    residuals, predictions = [], []
    for phase in draws[within][:4]:
        result = autofocus(history, phase)
        residuals.append(np.var(phase - (result.removed - as_it_is.removed)))
        predictions.append(float(lines) + result.estimation)
    assert len(residuals) == 4
    ratio = math.sqrt(np.mean(residuals) / np.mean(predictions))
    compared(
        "Phase after a phase gradient",
        "S-9",
        "real data",
        "AFRL Gotcha collection, X band, phase errors of a MEMS IMU added to its data",
        max(ratio, 1 / ratio) - 1,
        1.0,
        "larger over smaller − 1",
    )


def test_halves_of_the_points_differ_by_the_error_of_estimation(history: PhaseHistory, compared) -> None:
    """Neither half knows the other's clutter; what the file has of phase errors is common to both."""
    even, odd = (autofocus(history, np.zeros(history.samples.shape[1]), slice(k, None, 2)) for k in (0, 1))
    ratio = math.sqrt(np.var(even.removed - odd.removed) / (even.estimation + odd.estimation))
    compared(
        "Error of estimation of a phase gradient",
        "S-10",
        "real data",
        "AFRL Gotcha collection, X band, the even against the odd range bins that have a point",
        max(ratio, 1 / ratio) - 1,
        1.0,
        "larger over smaller − 1",
    )
