from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from nav_model.base.constants import EARTH_RATE, SPHERE_RADIUS
from nav_model.base.errors import InputError
from nav_model.earth.gravity import gravitation
from nav_model.earth.rotation import matrix_from_vector, skew
from nav_model.earth.sphere import earth_velocity, local_axes, ned_to_inertial, spherical_position
from nav_model.suborbital.errors import (
    ErrorSet,
    parameter_vector,
)
from nav_model.suborbital.flight import FlightParameters, TrueFlight, reference_flight, step_nodes
from nav_model.suborbital.layout import COUNT
from nav_model.suborbital.mechanisation import AttitudeFrames, mechanise, oscillations

# star_tracker.md, GP-1: final errors north, east, up, m.
PRINTED = {
    "accelerometer bias": (-125.14, -11226.05, 20252.26),
    "gyro bias": (13885.50, -17114.30, 12985.70),
    "initial position and velocity": (278.24, -133.51, 467.12),
    "all": (7117.58, -26262.27, 27319.33),
}


@pytest.mark.parametrize("name", PRINTED)
def test_gp1_rows(study, name, compared):
    final = study.pure.position_m[study.case(name), -1]
    compared(
        "Final position errors of the worked flight, free INS",
        "B-3",
        "our own derivation",
        "a separate program, unpublished",
        final - PRINTED[name],
        0.02,
        "largest difference, m",
    )


def test_gp1_aided_from_lift_off(study, compared):
    final = study.aided.position_m[study.case("all"), -1]
    compared(
        "Final position errors of the worked flight, with star tracker",
        "B-7",
        "our own derivation",
        "a separate program, unpublished",
        final - (-3162.51, -8901.97, 15002.50),
        0.02,
        "largest difference, m",
    )


def test_error_free_ins_follows_the_flight(flight):
    run = mechanise(flight, np.zeros(COUNT), ErrorSet())
    assert np.linalg.norm(run.position_i[0] - flight.position_i[run.index], axis=-1).max() < 1e-3


def flown_in_local_axes(flight: TrueFlight, model: str, used: np.ndarray) -> np.ndarray:
    """Positions (n+1, 3), inertial, of an INS with all errors of GP-1 in north, east, down [B-2], by RK4."""
    errors = ErrorSet()
    sines = oscillations(flight, errors)[:, :, None]
    felt = []
    for which, sensor, true in (
        (0, errors.accelerometers, flight.specific_force_b),
        (2, errors.gyros, flight.angular_rate_b),
    ):
        at = step_nodes(sines[:, which : which + 2])
        bias = np.array(sensor.constant_bias) + at[:, :, 0] * sensor.oscillating_bias
        matrix = np.array(sensor.constant_matrix) + at[:, :, 1, :, None] * np.array(sensor.oscillating_matrix)
        felt.append(true + bias + np.einsum("tnij,tnj->tni", matrix, true))
    force, rate = felt

    def slope(c, v, place, f, w):
        latitude, _, height = place
        radius, up = SPHERE_RADIUS + height, np.array([0.0, 0.0, 1.0])
        earth = EARTH_RATE * np.array([np.cos(latitude), 0.0, -np.sin(latitude)])
        transport = np.array([v[1], -v[0], -v[1] * np.tan(latitude)]) / radius
        axes = ned_to_inertial(latitude, 0.0)
        pull = axes.T @ gravitation(axes @ (-radius * up), model)
        attitude_rate = c @ skew(w) - skew(earth + transport) @ c
        spin = np.cross(earth, np.cross(earth, -radius * up))
        change = c @ f + pull - np.cross(2.0 * earth + transport, v) - spin
        return attitude_rate, change, np.array([v[0] / radius, v[1] / (radius * np.cos(latitude)), -v[2]])

    launch = local_axes(flight.position_i[0])
    start = errors.initial
    position = flight.position_i[0] + launch @ start.position_m
    velocity = flight.velocity_i[0] + launch @ start.velocity_m_s - earth_velocity(position)
    place = np.array([float(part) for part in spherical_position(position)])
    axes = ned_to_inertial(place[0], place[1])
    attitude = axes.T @ matrix_from_vector(launch @ start.attitude_rad) @ flight.attitude_bi[0]
    state, h, result = (attitude, axes.T @ velocity, place), flight.step_s, []
    for i, time in enumerate(flight.time_s):
        axes = ned_to_inertial(state[2][0], state[2][1] + EARTH_RATE * time)
        result.append(-axes[:, 2] * (SPHERE_RADIUS + state[2][2]))
        if used[i]:
            state = (axes.T @ flight.attitude_bi[i], *state[1:])
        if i == flight.steps:
            break
        k = [slope(*state, force[i, 0], rate[i, 0])]
        for node, step in ((1, h / 2), (1, h / 2), (2, h)):
            stage = [y + step * dy for y, dy in zip(state, k[-1], strict=True)]
            k.append(slope(*stage, force[i, node], rate[i, node]))
        state = tuple(y + h / 6 * (a + 2 * b + 2 * c + d) for y, a, b, c, d in zip(state, *k, strict=True))
    return np.array(result)


@pytest.mark.long
@pytest.mark.parametrize(("gravity", "aided"), [("spherical", False), ("j2", True), ("ellipsoidal", False)])
def test_a_mechanisation_in_local_axes_agrees(gravity, aided, compared):
    """[B-2] against [B-3] with all errors: better than 1e-2 m over the flight, with and without camera."""
    flight = reference_flight(FlightParameters(step_s=0.5))
    used = np.full(flight.steps + 1, aided)
    used[100:180] = False
    frames = (AttitudeFrames(used, np.ascontiguousarray(flight.attitude_bi)),) if aided else None
    run = mechanise(flight, parameter_vector(ErrorSet()), ErrorSet(), gravity=gravity, frames=frames)
    compared(
        "Mechanisation in north, east, down, three gravity models",
        "B-2",
        "our own derivation",
        "mechanisation in local axes, written out in the test",
        np.linalg.norm(run.position_i[0] - flown_in_local_axes(flight, gravity, used)[run.index], axis=-1),
        1e-2,
        "largest distance, m",
    )


def test_a_case_is_the_same_in_any_company(flight):
    """More cases than fit in one call of the kernel, each with its own errors, gravity and camera."""
    short = replace(flight, time_s=flight.time_s[:41], specific_force_b=flight.specific_force_b[:40])
    p = parameter_vector(ErrorSet()) * np.linspace(0.0, 2.0, 70)[:, None]
    models = ["spherical", "j2", "ellipsoidal"] * 23 + ["j2"]
    truth = [np.ascontiguousarray(flight.attitude_bi[shift : 41 + shift]) for shift in (0, 50)]
    cameras = [None, *(AttitudeFrames(np.arange(41) % rest == 0, c) for rest, c in zip((4, 7), truth, strict=True))]
    frames = [cameras[k % 3 if k % 5 else 0] for k in range(70)]
    noise = np.random.default_rng(1).standard_normal((70, 40, 6))
    together = mechanise(short, p, ErrorSet(), frames=frames, noise=noise, gravity=models)
    for k in (0, 2, 34, 63, 64, 69):
        alone = mechanise(short, p[k], ErrorSet(), frames=(frames[k],), noise=noise[[k]], gravity=models[k])
        for name in ("position_i", "velocity_i", "attitude_bi"):
            np.testing.assert_allclose(getattr(together, name)[k], getattr(alone, name)[0], rtol=1e-13, atol=1e-13)


def test_full_case_against_dop853(study, compared):
    """ "Everything, pure INS", written out afresh from star_tracker.md and integrated by scipy's DOP853."""
    deg = np.pi / 180.0
    mis = np.array([[0, 1, -1], [-1, 0, 1], [1, -1, 0]], dtype=float)
    m_c, m_o = 1e-4 * (np.eye(3) + mis), 3e-5 * (np.eye(3) + mis)
    launch = ned_to_inertial(37.94 * deg, -75.46 * deg)

    def rate(t):
        u = min(max((t - 10.0) / 140.0, 0.0), 1.0)
        w = min(max((t - 195.0) / 60.0, 0.0), 1.0)
        pitch = 90.0 - 71.0 * (6 * u**5 - 15 * u**4 + 10 * u**3)
        pitch -= 0.045 * (60.0 * (w**3 - w**4 / 2.0) + max(t - 255.0, 0.0))
        pitch_dot = -71.0 * (30 * u**4 - 60 * u**3 + 30 * u**2) / 140.0 - 0.045 * (3 * w**2 - 2 * w**3)
        roll = 2.0 * np.sin(2 * np.pi * t / 200.0)
        roll_dot = 2.0 * 2 * np.pi / 200.0 * np.cos(2 * np.pi * t / 200.0)
        yaw_dot = 2 * np.pi / 300.0 * np.cos(2 * np.pi * t / 300.0)
        p, r = pitch * deg, roll * deg
        # Body rates as the sum of the three turns about their own axes.
        about_x = np.array([roll_dot, 0.0, 0.0])
        about_y = pitch_dot * np.array([0.0, np.cos(r), -np.sin(r)])
        about_z = yaw_dot * np.array([-np.sin(p), np.cos(p) * np.sin(r), np.cos(p) * np.cos(r)])
        return deg * (about_x + about_y + about_z)

    def slope(t, y, thrusting):
        c, v, r = y[:9].reshape(3, 3), y[9:12], y[12:]
        f = np.zeros(3)
        if thrusting:
            f[0] = 20.0 / (1.0 - t * (1.0 - 20.0 / 90.0) / 195.0)
        w = rate(t)
        sa, sg = np.sin(2 * np.pi * t / 1500.0), np.sin(2 * np.pi * t / 600.0)
        mg = 9.80665e-3
        bias = mg * (np.array([1.0, 0.9, -1.1]) + sa * np.array([-0.8, 0.4, 0.8]))
        f = f + bias + (m_c + sa * m_o) @ f
        w = w + deg / 3600.0 * (np.array([3.0, 4.0, 2.0]) + 0.3 * sg) + (m_c + sg * m_o) @ w
        cross = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
        pull = -3.986004418e14 * r / np.linalg.norm(r) ** 3
        return np.concatenate([(c @ cross).ravel(), c @ f + pull, v])

    place = launch @ np.array([0.0, 0.0, -6371000.0])
    spin = np.cross([0.0, 0.0, 7.2921150e-5], place)
    from scipy.spatial.transform import Rotation

    tilt = Rotation.from_rotvec(launch @ np.full(3, 60.0 / 3600.0 * deg)).as_matrix()
    body = Rotation.from_euler("ZYX", [110.0, 90.0, 0.0], degrees=True).as_matrix()
    y = np.concatenate(
        [
            (tilt @ launch @ body).ravel(),
            spin + launch @ np.array([0.1, 0.1, -0.1]),
            place + launch @ np.array([20.0, -20.0, -50.0]),
        ]
    )
    for start, stop, thrusting in ((0.0, 195.0, True), (195.0, 1500.0, False)):
        answer = solve_ivp(
            slope, (start, stop), y, method="DOP853", rtol=1e-11, atol=1e-11, max_step=5.0, args=(thrusting,)
        )
        y = answer.y[:, -1]
    row = study.parameters[study.case("all")]
    ours = mechanise(study.flight, row, study.inputs.errors).position_i[0, -1]
    compared(
        "Worked flight with every error, 1500 s",
        "B-3",
        "solver written by others",
        "SciPy's DOP853 on the equations of motion, written out in the test",
        np.linalg.norm(ours - y[12:]),
        1e-2,
        "distance at the end, m",
    )


def test_refusals(flight):
    p, errors = np.zeros(COUNT), ErrorSet()
    with pytest.raises(InputError, match="every"):
        mechanise(flight, p, errors, every=7)
    with pytest.raises(InputError, match="parameters"):
        mechanise(flight, p[:5], errors)
