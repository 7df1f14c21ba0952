"""The mechanisation against the trajectory it must reproduce, and against Newton in Earth-centred axes."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from nav_model.earth.rotation import matrix_from_euler
from nav_model.simulation.specification import TrajectorySpec
from nav_model.simulation.strapdown import initial_state, navigate
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.simulation.truth import perfect_increments, specific_force_and_rate, true_states

pytestmark = pytest.mark.long

A, F, RATE = 6378137.0, 1 / 298.257223563, 7.292115e-5
E2 = F * (2 - F)


def matrices(quaternions: np.ndarray) -> np.ndarray:
    w, v = quaternions[:, :1], quaternions[:, 1:]
    cross = np.zeros((len(w), 3, 3))
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -v[:, 2], v[:, 1], -v[:, 0]
    cross -= np.swapaxes(cross, 1, 2)
    return np.eye(3) + 2 * w[:, :, None] * cross + 2 * cross @ cross


def angle_between(first: np.ndarray, second: np.ndarray) -> float:
    turn = first @ np.swapaxes(second, 1, 2)
    vector = np.stack([turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]])
    return float(np.degrees(np.max(np.linalg.norm(vector, axis=0) / 2)))


def fly_without_errors(spec: TrajectorySpec, duration: float, rate: float = 100.0):
    truth = true_states(plan_trajectory(spec, duration), np.arange(0.0, duration + 0.5))
    start = initial_state(truth.position[0], truth.velocity[0], truth.matrix[0])
    result = navigate(start, perfect_increments(spec, duration, rate), rate, round(rate))
    scale = [6.4e6, 6.4e6 * np.cos(spec.latitude), 1.0]
    metres = np.max(np.linalg.norm((result[:, :3] - truth.position) * scale, axis=1))
    return float(metres), angle_between(matrices(result[:, 6:]), truth.matrix)


@pytest.mark.parametrize(
    ("spec", "duration"),
    [
        (TrajectorySpec("straight", speed=0.0), 3600.0),
        (TrajectorySpec("straight", speed=0.0, heading=2.0, latitude=-1.0), 3600.0),
        (TrajectorySpec("wandering"), 600.0),
        (TrajectorySpec("wandering", speed=250.0, heading=-2.0, height=11_000.0), 600.0),
        (TrajectorySpec("turns", speed=100.0), 600.0),
        (TrajectorySpec("climb", heading=1.0), 600.0),
    ],
    ids=["resting", "resting south", "wandering", "fast", "turns", "climb"],
)
def test_an_error_free_ins_reproduces_the_flight(spec, duration):
    metres, degrees = fly_without_errors(spec, duration)
    assert metres < 1e-3
    assert degrees < 1e-8


def geodetic(r: np.ndarray) -> tuple[float, float, float]:
    """Latitude, longitude, height by plain iteration."""
    rho = math.hypot(r[0], r[1])
    latitude = math.atan2(r[2], rho * (1 - E2))
    for _ in range(8):
        n = A / math.sqrt(1 - E2 * math.sin(latitude) ** 2)
        latitude = math.atan2(r[2] + E2 * n * math.sin(latitude), rho)
    n = A / math.sqrt(1 - E2 * math.sin(latitude) ** 2)
    return latitude, math.atan2(r[1], r[0]), rho * math.cos(latitude) + r[2] * math.sin(latitude) - A * A / n


def ned_axes(latitude: float, longitude: float) -> np.ndarray:
    """Columns north, east, down in Earth-centred axes."""
    sl, cl, so, co = math.sin(latitude), math.cos(latitude), math.sin(longitude), math.cos(longitude)
    return np.array([[-sl * co, -so, -cl * co], [-sl * so, co, -cl * so], [cl, 0.0, -sl]])


def earth_centred(position: np.ndarray) -> np.ndarray:
    latitude, longitude, height = position
    n = A / math.sqrt(1 - E2 * math.sin(latitude) ** 2)
    horizontal = (n + height) * math.cos(latitude)
    vertical = (n * (1 - E2) + height) * math.sin(latitude)
    return np.array([horizontal * math.cos(longitude), horizontal * math.sin(longitude), vertical])


@pytest.mark.parametrize("offset", [False, True], ids=["true start", "wrong start"])
def test_the_mechanisation_agrees_with_newton_in_earth_centred_axes(offset, compared):
    """DOP853 over position, velocity and the nine direction cosines in rotating Earth-centred axes, 600 s.

    The wrong start (20 m, 1 m/s, 1 deg) makes the two follow a path that the trajectory's truth knows nothing
    of.
    """
    spec = TrajectorySpec("turns", speed=100.0, heading=0.5)
    trajectory = plan_trajectory(spec, 600.0)
    truth = true_states(trajectory, np.array([0.0]))
    position, velocity, matrix = truth.position[0].copy(), truth.velocity[0].copy(), truth.matrix[0]
    if offset:
        position += [20.0 / 6.4e6, -20.0 / 4.5e6, 20.0]
        velocity += [1.0, -1.0, 0.3]
        matrix = matrix_from_euler(0.017, -0.017, 0.02) @ matrix
    result = navigate(
        initial_state(position, velocity, matrix), perfect_increments(spec, 600.0, 100.0), 100.0, 60_000
    )

    omega = np.array([0.0, 0.0, RATE])

    def motion(t, y):
        r, v, c = y[:3], y[3:6], y[6:].reshape(3, 3)
        felt = specific_force_and_rate(trajectory, np.array([t]))[0]
        latitude, longitude, height = geodetic(r)
        s2 = math.sin(latitude) ** 2
        m = RATE**2 * A**3 * (1 - F) / 3.986004418e14
        gravity = 9.7803253359 * (1 + 1.931852652458e-3 * s2) / math.sqrt(1 - E2 * s2)
        gravity *= 1 - 2 / A * (1 + F + m - 2 * F * s2) * height + 3 * height**2 / A**2
        # Normal gravity already holds the centrifugal acceleration.
        acceleration = c @ felt[:3] + gravity * ned_axes(latitude, longitude)[:, 2] - 2 * np.cross(omega, v)
        x, yy, z = felt[3:] - c.T @ omega
        skew = np.array([[0, -z, yy], [z, 0, -x], [-yy, x, 0]])
        return np.concatenate([v, acceleration, (c @ skew).ravel()])

    axes = ned_axes(position[0], position[1])
    start = np.concatenate([earth_centred(position), axes @ velocity, (axes @ matrix).ravel()])
    # Steps end on the spline's knots, 0.5 s apart: across a knot an eighth-order step loses its order.
    solution = solve_ivp(
        motion, (0.0, 600.0), start, method="DOP853", rtol=1e-6, atol=1.0, first_step=0.25, max_step=0.25
    )
    compared(
        "Strapdown INS through turns, 600 s",
        "",
        "solver written by others",
        "SciPy's DOP853 on Newton's equation in Earth-centred axes, written out in the test; same sensor inputs",
        np.linalg.norm(earth_centred(result[-1, :3]) - solution.y[:3, -1]),
        1e-3,
        "distance at the end, m",
    )
    axes = ned_axes(result[-1, 0], result[-1, 1])
    assert axes @ result[-1, 3:6] == pytest.approx(solution.y[3:6, -1], abs=1e-5)
    assert axes @ matrices(result[-1:, 6:])[0] == pytest.approx(solution.y[6:, -1].reshape(3, 3), abs=1e-8)


def test_coning_is_compensated():
    """A body that cones at 2 Hz by 1 deg, against the closed form of the motion.

    The rate vector of q(t) = (cos a/2, 0, sin a/2 cos wt, sin a/2 sin wt) is known in closed form; integrating its
    angles without the coning term would turn the body by about w (1 - cos a) t = 6.6 deg in a minute.
    """
    cone, frequency, rate, seconds = math.radians(1.0), 4 * math.pi, 100.0, 60.0
    c, s = math.cos(cone), math.sin(cone)

    def rates(t: np.ndarray) -> np.ndarray:
        return frequency * np.stack([(c - 1) + 0 * t, -s * np.sin(frequency * t), s * np.cos(frequency * t)], axis=1)

    def attitude(t: float) -> np.ndarray:
        half = cone / 2
        return np.array(
            [math.cos(half), 0.0, math.sin(half) * math.cos(frequency * t), math.sin(half) * math.sin(frequency * t)]
        )

    # Ten Gauss points a sample: increments exact to rounding. Zero force: only the attitude is looked at.
    nodes, weights = np.polynomial.legendre.leggauss(10)
    samples = round(seconds * rate) + 2
    starts = (np.arange(samples) - 2) / rate
    increments = np.zeros((samples, 6))
    for node, weight in zip(nodes, weights, strict=True):
        increments[:, 3:] += weight / 2 / rate * rates(starts + (node + 1) / 2 / rate)
    start = initial_state(np.array([0.0, 0.0, 0.0]), np.zeros(3), matrices(attitude(0.0)[None])[0])
    end = matrices(navigate(start, increments, rate, samples - 2)[-1:, 6:])[0]
    # On the equator NED axes turn about north by the Earth's rate; the motion is against inertial space. What the
    # fall of 17 km adds to that is below a thousandth of a degree.
    earth = matrix_from_euler(-RATE * seconds, 0.0, 0.0)
    off = angle_between((earth @ matrices(attitude(seconds)[None])[0])[None], end[None])
    assert off < 1e-3
    assert math.degrees(frequency * (1 - c) * seconds) > 6.0
