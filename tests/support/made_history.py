"""A phase history of point targets, by the exact range to each."""

import numpy as np

from nav_model.base.constants import SPEED_OF_LIGHT
from nav_model.sar.image import PhaseHistory
from nav_model.sar.line_of_sight import ranges_to_target


def simulate_phase_history(geometry, time, frequency, targets, amplitudes=1.0):
    """Phase history of point targets (m, 3) [m] about the scene centre, seen from a straight aperture."""
    position = -ranges_to_target(geometry, time)
    reference = np.linalg.norm(position, axis=1)
    samples = np.zeros((len(frequency), len(position)), complex)
    for target, amplitude in zip(np.array(targets), np.broadcast_to(amplitudes, len(targets)), strict=True):
        beyond = np.linalg.norm(target - position, axis=1) - reference
        samples += amplitude * np.exp(-4j * np.pi / SPEED_OF_LIGHT * np.outer(frequency, beyond))
    return PhaseHistory(samples, frequency, position, reference)
