"""Made flights: errors of a filter and of a smoother drawn along a flight, as solutions with their truth.

The filter is the textbook one, and the smoother that of Rauch, Tung and Striebel: neither the adjoint of the product
nor its sums over sources take part.
"""

from dataclasses import dataclass, replace

import numpy as np

from nav_model.design import Design
from nav_model.earth.rotation import euler_error_map
from nav_model.earth.wgs84 import metres_per_radian
from nav_model.flown.solution import Claims, Solution
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.simulation.truth import true_states
from nav_model.trajectory import passes
from nav_model.trajectory.design_study import along_flight, planned
from nav_model.trajectory.errors import error_model
from nav_model.trajectory.start import settled_start
from nav_model.trajectory.states import short_as_white


@dataclass
class Flights:
    """Errors of runs along a flight: at nodes (k, m, runs), before and after each fix, and smoothed."""

    spec: object
    model: object
    run: object
    before: np.ndarray
    after: np.ndarray
    smoothed: np.ndarray


def root(matrix):
    values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T))
    return vectors * np.sqrt(np.maximum(values, 0.0))


def fly(design: Design, runs: int, seed: int, imu: float = 1.0, gnss: float = 1.0, finest: float = 1.0) -> Flights:
    """Errors of `runs` flights, with an IMU and a receiver so many times as noisy as the design's filter assumes."""
    spec = along_flight(design, planned(design))
    spec = replace(spec, study=short_as_white(replace(spec.study, every=finest)), flown_further=0.0)
    model = error_model(spec)
    model = replace(model, states=settled_start(spec.study, model.states, model.truth.at(np.array([0]))))
    run, rng, m, k = passes.filtered(model), np.random.default_rng(seed), model.states.estimated, len(model.time_s)
    after, before, prior, moves = (np.zeros((k, m, n)) for n in (runs, runs, m, m))
    z = after[0] = before[0] = root(run.covariance[0]) @ rng.standard_normal((m, runs))
    for node in range(1, k):
        phi = np.diag(np.concatenate([np.zeros(9), model.decay_factor[node - 1, : m - 9]]))
        phi[:9] = model.phi[node - 1, :, :m]
        moves[node], noise = phi, model.filter_noise[node - 1]
        prior[node] = phi @ run.covariance[node - 1] @ phi.T + noise
        z = before[node] = phi @ z + imu * root(noise) @ rng.standard_normal((m, runs))
        if model.is_fix[node]:
            H = model.rows[node, :, :m]
            v = gnss * np.sqrt(model.variance[node])[:, None] * rng.standard_normal((len(H), runs))
            z = z - run.gain[node] @ (H @ z + v)
        after[node] = z
    smoothed = after.copy()
    for node in range(k - 2, -1, -1):
        gain = run.covariance[node] @ moves[node + 1].T @ np.linalg.pinv(prior[node + 1], rcond=1e-13, hermitian=True)
        smoothed[node] = after[node] + gain @ (smoothed[node + 1] - before[node + 1])
    return Flights(spec, model, run, before, after, smoothed)


def backward(flights: Flights, seed: int) -> np.ndarray:
    """Errors (k, m, runs) of a filter that runs from the end of the flight to its start, before each fix: of later
    fixes alone, and of noise that is drawn anew."""
    model, rng = flights.model, np.random.default_rng(seed)
    k, m, runs = flights.after.shape
    P = 100.0 * flights.run.covariance[-1]
    z, errors = root(P) @ rng.standard_normal((m, runs)), np.zeros((k, m, runs))
    errors[-1] = z
    for node in range(k - 1, 0, -1):
        if model.is_fix[node]:
            H, R = model.rows[node, :, :m], np.diag(model.variance[node])
            gain = P @ H.T @ np.linalg.inv(H @ P @ H.T + R)
            z = z - gain @ (H @ z + root(R) @ rng.standard_normal((len(H), runs)))
            P = (np.eye(m) - gain @ H) @ P
        phi = np.diag(np.concatenate([np.zeros(9), model.decay_factor[node - 1, : m - 9]]))
        phi[:9] = model.phi[node - 1, :, :m]
        back, noise = np.linalg.inv(phi), model.filter_noise[node - 1]
        z = back @ (z + root(noise) @ rng.standard_normal((m, runs)))
        P = back @ (P + noise) @ back.T
        errors[node - 1] = z
    return errors


def solution(flights: Flights, errors: np.ndarray, rate: float, kind: str, **others) -> Solution:
    """A solution with these errors (k, m) at the nodes; cubic between them, as position and velocity say."""
    from scipy.interpolate import CubicHermiteSpline

    model = flights.model
    flight = flights.spec.study
    trajectory = plan_trajectory(flight.trajectory, flight.duration)
    time = np.arange(0.0, model.time_s[-1] + 1e-9, 1.0 / rate)
    truth = true_states(trajectory, time)
    position = CubicHermiteSpline(model.time_s, errors[:, :3], errors[:, 3:6])
    velocity = np.column_stack([np.interp(time, model.time_s, axis) for axis in errors[:, 3:6].T])
    tilt = np.column_stack([np.interp(time, model.time_s, axis) for axis in errors[:, 6:9].T])
    euler = np.einsum("nij,nj->ni", euler_error_map(*truth.euler[:, 1:].T), tilt)
    return at_places(truth, time, position(time), velocity, euler, kind, **others)


def at_places(truth, time, position, velocity, euler, kind, start=1000.0, **others) -> Solution:
    north, east = metres_per_radian(truth.position[:, 0], truth.position[:, 2])
    place = truth.position + position / np.column_stack([north, east, -np.ones_like(north)])
    whole = {
        "velocity": truth.velocity + velocity,
        "attitude": truth.euler + euler,
    } | others
    return Solution("table", kind, time + start, "gps", place, **whole)


__all__ = ["Claims", "at_places", "fly", "solution"]
