"""The simulator confirms the post-processed figures: flights smoothed with the whole leg, by its own filter."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from nav_model.budget import analyse
from nav_model.sar.flown_smoother import flown_smoother
from nav_model.sar.line_of_sight import ApertureGeometry, range_error
from nav_model.simulation.design_study import settling, specification
from nav_model.simulation.schedule import plan
from nav_model.simulation.single_run import POSTERIOR, PRIOR, fly

RATE = 25.0  # of the instruments, Hz
LEG = {"processing.leg_after": 60.0, "imu.rate": RATE}


def smoothed_flights(design, runs):
    """Position errors (3, runs, n) over the aperture, along the track, across it and down, and their times."""
    aperture, interval = analyse(design).sar.aperture_time, design.gnss.interval
    start = round(math.ceil(settling(design) / interval) * interval * RATE) / RATE
    length = start + aperture + design.processing.leg_after + 2 / RATE
    spec = replace(
        specification(design, trajectory="straight", runs=1, seed=3, duration=length, every=1 / RATE),
        record_from=start,
    )
    schedule = plan(spec)
    instants, fixes = schedule.outputs.time_s[1:], schedule.fixes.time_s
    first = int(np.searchsorted(fixes, start - 1e-6))
    at = 1 + np.rint((fixes[first:] - instants[0]) * RATE).astype(int)
    own_angles = np.linalg.inv(schedule.error_map[at])
    time = np.linspace(0.0, aperture, 200)
    both = np.column_stack([instants - 1e-9, instants]).ravel()
    flown, ends = [], {PRIOR: [], POSTERIOR: []}
    for run in range(runs):
        record = fly(spec, run)
        level = np.swapaxes(record.error[:, 1:, :3], 0, 1).reshape(-1, 3)
        flown.append([np.interp(start + time, both, column) for column in level.T])
        for phase, states in ends.items():
            state = record.error[phase, at].copy()
            state[:, 6:9] = np.einsum("kij,kj->ki", own_angles, state[:, 6:9])
            states.append(state)
    smoother = flown_smoother(spec, fixes, first)
    prior, posterior = (np.stack(ends[phase], axis=1) for phase in (PRIOR, POSTERIOR))
    added = smoother.correction(start + time, prior, posterior)
    north, east, down = np.moveaxis(np.array(flown), 1, 0) + np.moveaxis(added, 2, 0)
    c, s = math.cos(spec.trajectory.heading), math.sin(spec.trajectory.heading)
    return time, np.stack([c * north + s * east, c * east - s * north, down])


def agree(design, runs):
    """The flights' rms lies where that of so many normal errors would, but for once in ten thousand."""
    budget = analyse(design)
    radar = design.radar
    post = {name: figure.sigma for (name, mode), figure in budget.items() if mode == "post-processed"}
    time, error = smoothed_flights(design, runs)
    geometry = ApertureGeometry(radar.slant_range, design.flight.speed, radar.grazing_angle, radar.squint_angle)
    phase = 4 * math.pi / budget.sar.wavelength * range_error(geometry, time, *error)
    x = 2 * time / time[-1] - 1
    fitted = np.polynomial.legendre.legfit(x, phase.T, 3)
    residual = phase.T - np.polynomial.legendre.legval(x, fitted[:2]).T
    expected = {
        "quadratic": (1.5 * fitted[2], post["quadratic_phase"]),
        "cubic": (2.5 * fitted[3], post["cubic_phase"]),
        "detrended": (np.sqrt(np.mean(residual**2, axis=0)), post["detrended_phase_1"]),
        "horizontal position": (error[1, :, 100], post["horizontal_position"]),
        "vertical position": (error[2, :, 100], post["vertical_position"]),
    }
    for name, (result, sigma) in expected.items():
        low, high = (math.sqrt(chi2.ppf(share, runs) / runs) for share in (5e-5, 1 - 5e-5))
        assert low < math.sqrt(np.mean(result**2)) / sigma < high, (name, math.sqrt(np.mean(result**2)) / sigma)


def test_a_few_flights(open_design):
    agree(open_design.replace(LEG), 24)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["MEMS", "MEMS with velocity", "tactical"])
def test_two_hundred_flights(open_design, closed_design, name):
    design = closed_design if name == "tactical" else open_design
    if name == "MEMS with velocity":
        design = design.replace({"gnss.velocity_noise": 0.03})
    agree(design.replace(LEG), 200)
