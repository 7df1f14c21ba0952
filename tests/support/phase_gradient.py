"""An eigenvector phase gradient that shares nothing with the product's, and phase errors for it to remove."""

import math

import numpy as np

from nav_model import Design
from nav_model.budget.inputs import inputs_of
from nav_model.budget.real_time import RealTime


def phases_of(design: Design, draws: int, pulses: int, rng: np.random.Generator) -> np.ndarray:
    """Phase errors along the line of sight of mid-aperture (draws, pulses) [rad]: tilt at the last fix, noise of
    accelerometers and gyros, each integrated pulse by pulse."""
    x = inputs_of(design)
    step, level = float(x.aperture) / pulses, float(np.cos(x.grazing_angle))
    g, tilt = float(x.g), math.sqrt(RealTime(x).at_last_fix.horizontal.p33)
    walk = np.cumsum(rng.normal(size=(draws, pulses)), axis=1) * float(x.sigma_w) * math.sqrt(step)
    acceleration = level * g * (tilt * rng.normal(size=(draws, 1)) + walk)
    velocity = np.cumsum(
        acceleration * step + float(x.sigma_a) * math.sqrt(step) * rng.normal(size=walk.shape), axis=1
    )
    return float(x.to_phase) * np.cumsum(velocity, axis=1) * step


def without_line(phases: np.ndarray) -> np.ndarray:
    t = np.linspace(-1, 1, phases.shape[-1])
    basis = np.stack([np.ones_like(t), t]) / np.sqrt([[len(t)], [np.sum(t**2)]])
    return phases - (phases @ basis.T) @ basis


def lines_between(blocks: np.ndarray, pulses: int) -> np.ndarray:
    """Straight lines between the phases of blocks, carried on to the ends."""
    centre, t = (np.arange(len(blocks)) + 0.5) / len(blocks), (np.arange(pulses) + 0.5) / pulses
    first = np.clip(np.searchsorted(centre, t) - 1, 0, len(blocks) - 2)
    return blocks[first] + (t - centre[first]) * len(blocks) * (blocks[first + 1] - blocks[first])


def next_phase(history: np.ndarray, removed: np.ndarray, blocks: int) -> np.ndarray:
    """Phase of a history (range bins, pulses) by the main eigenvector of its blocks, from what is removed so far."""
    means = (history * np.exp(-1j * removed)).reshape(len(history), blocks, -1).mean(axis=2)
    _, vectors = np.linalg.eigh(means.T @ means.conj())
    # The whole phase of a block, not what the lines before have left: adding lines to lines sharpens noise.
    whole = removed.reshape(blocks, -1).mean(axis=1) + np.unwrap(np.angle(vectors[:, -1]))
    return lines_between(whole, len(removed))
