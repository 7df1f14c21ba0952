"""Sensor biases that vary and a filter estimates: all variances against a filter of SciPy's, in other coordinates."""

import math
from dataclasses import replace

import numpy as np
import pytest
import varying_bias as oracle
from riccati import van_loan

from nav_model.analytic import taylor
from nav_model.analytic.rise import gravity_gradient
from nav_model.analytic.taylor import System
from nav_model.processing.flight import Channel
from nav_model.processing.free import FreeError
from nav_model.processing.smoother import COLUMNS, IN_THE_MIDDLE, smoothed_error

G, DEGREE = 9.80665, math.pi / 180
ORACLE = "SciPy's Riccati and exponential, tilt and bias apart, all fixes at once, written out in the test"
VARIANCES = ("quadratic", "cubic", "left_1", "left_2", "slope", "turned", "curved", "mean")


def between(rng, low, high):
    return np.array(math.exp(rng.uniform(math.log(low), math.log(high))))


def random_channel(rng):
    """MEMS to tactical grade, with instabilities of 10 s to hours, now and then upright, with velocity, or slow."""
    upright = rng.random() < 0.3
    gyro = None if upright else G * np.radians(between(rng, 0.01, 0.7)) / 60
    interval = between(rng, 0.1, 3)
    walks = 0.0 if upright else 1.0
    channel = Channel(
        between(rng, 0.01, 0.2) / 60, gyro, between(rng, 0.02, 3), interval,
        gradient=np.array(gravity_gradient(G)) if upright else None,
        markov=between(rng, 1e-5, 3e-3) * G, markov_time=between(rng, 10, 5000),
        jerk=walks * G * np.radians(between(rng, 0.05, 20)) / 3600, jerk_time=between(rng, 10, 5000),
        walk=between(rng, 1e-7, 1e-5), jerk_walk=walks * G * np.radians(between(rng, 0.01, 3)) / 3600 / 60,
    )  # fmt: skip
    if rng.random() < 0.4:
        channel = replace(channel, velocity=between(rng, 0.01, 0.3), velocity_interval=interval)
    if rng.random() < 0.3:
        channel = replace(channel, slow=channel.fix * between(rng, 0.3, 3), slow_time=between(rng, 20, 600))
    return channel


def apart(ours, theirs):
    return math.sqrt(float(ours) / float(theirs)) - 1


def test_a_span_is_exact(compared):
    """Short beside the time constants and long, against the matrix exponential."""
    rng, off = np.random.default_rng(1), []
    for _ in range(40):
        f, drive = rng.normal(size=(4, 4)), rng.normal(size=(4, 2))
        f -= 1.5 * np.eye(4)
        span = between(rng, 1e-3, 1)  # longer, Van Loan's exponential loses digits
        ours = taylor.drift(System(f, drive, np.array(np.linalg.norm(f, 2))), span)
        phi, noise = van_loan(f, drive @ drive.T, float(span))
        off += [*((ours.transition - phi) / np.abs(phi).max()).ravel(), *((ours.noise - noise) / noise.max()).ravel()]
    compared("A span without fixes", "T-19", "solver written by others", "SciPy's matrix exponential", off, 1e-10)


def test_covariance_after_a_fix(compared):
    rng, off = np.random.default_rng(2), []
    for _ in range(40):
        channel = random_channel(rng)
        for ours, theirs in zip(FreeError([channel]).at_fix(), oracle.after_a_fix(channel), strict=True):
            row = np.zeros(7)
            row[[oracle.TILT, oracle.BIAS]] = 1.0
            off += [apart(ours["11"][0], theirs[0, 0]), apart(ours["22"][0], theirs[1, 1])]
            off.append(apart(ours["33"][0], row @ theirs @ row))
            off.append(float(ours["13"][0]) / (theirs[0] @ row) - 1)
            off.append(float(ours["23"][0]) / (theirs[1] @ row) - 1)
            known = theirs[2, 2] + float(channel.markov) ** 2 - theirs[3, 3]
            off.append(apart(ours["tilt"][0], known))
    compared("The settled filter with varying biases", "T-19", "solver written by others", ORACLE, off, 5e-4)


def test_after_the_last_fix(compared):
    """Position, velocity and tilt of an outage, with the Schuler oscillation and its coupling to the vertical."""
    rng, off = np.random.default_rng(3), []
    for _ in range(25):
        channel, time = random_channel(rng), between(rng, 1, 2000)
        gradient = gravity_gradient(G)
        ours = FreeError([channel]).later(time, gradient)
        f, q = oracle.model(channel, None if channel.gradient is not None else -gradient / 2)
        start = np.zeros((9, 9))
        start[:7, :7] = oracle.after_a_fix(channel)[1]
        f, q = np.pad(f, (0, 2)), np.pad(q, (0, 2))
        f[7, 8] = f[8, oracle.VELOCITY] = 1.0
        f[8, 7] = gradient
        p = oracle.carried(f, q, start, float(time), 1 / np.abs(np.diag(f)).max())
        off += [apart(ours[name][0], p[n, n]) for name, n in (("position", 0), ("velocity", 1), ("coupled", 7))]
        if channel.gradient is None:
            off.append(apart(ours["tilt"][0], p[2, 2] - start[2, 2]))
    compared("An outage with varying biases", "T-21", "solver written by others", ORACLE, off, 5e-4)


def test_a_curve_is_its_points():
    channel = random_channel(np.random.default_rng(4))
    error, times = FreeError([channel]), np.linspace(0.0, 90.0, 37)
    curve = error.later(times, gravity_gradient(G))
    for n in (0, 1, 17, 36):
        for name, values in error.later(times[n], gravity_gradient(G)).items():
            assert curve[name][0, n] == pytest.approx(float(values[0]), rel=1e-9, abs=1e-25)


@pytest.mark.long
def test_over_an_aperture(compared):
    """Of a free INS some time after the last fix, and smoothed."""
    rng, free, smoothed, states = np.random.default_rng(5), [], [], []
    for _ in range(12):
        channel, aperture, coast = random_channel(rng), between(rng, 1, 20), between(rng, 0.5, 30)
        after = float(channel.interval) * int(rng.integers(0, 20))
        ours = FreeError([channel]).over_aperture(coast, aperture)
        theirs = oracle.along(channel, float(coast), float(aperture))
        free += [apart(ours[name][0], theirs[name]) for name in VARIANCES if theirs[name] > 1e-9 * theirs["mean"]]
        (ours,) = smoothed_error([channel], aperture, np.array(after), np.array(0.0), COLUMNS)
        theirs = oracle.along(channel, 0.0, float(aperture), after)
        smoothed += [apart(ours[name], theirs[name]) for name in VARIANCES if theirs[name] > 1e-8 * theirs["mean"]]
        known = np.diag(theirs["covariance"]).copy()
        known[oracle.TILT] += float(channel.markov) ** 2 - known[oracle.BIAS]
        for n, name in enumerate(IN_THE_MIDDLE):
            if n < 2 or channel.gradient is None:
                states.append(apart(ours[name], known[n]))
    compared("Real time over an aperture, varying biases", "T-21", "solver written by others", ORACLE, free, 1e-4)
    compared("Smoothed over an aperture, varying biases", "P-3", "solver written by others", ORACLE, smoothed, 1e-4)
    compared("Smoothed states, varying biases", "P-3", "solver written by others", ORACLE, states, 1e-4)


def level(vrw, arw, fix, interval, markov, time):
    """A level channel of random walks per root hour, with an accelerometer's instability."""
    zero, long = np.array(0.0), np.array(3600.0)
    return Channel(
        np.array(vrw / 60), np.array(G * arw * DEGREE / 60), np.array(fix), np.array(interval),
        markov=np.array(markov * G), markov_time=np.array(time), jerk=zero, jerk_time=long, walk=zero, jerk_walk=zero,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("unit", "instability", "time", "name", "known"),
    [
        ((0.03, 0.012), 1e-3, 3600.0, "11", (0.253, 0.340)),
        ((0.03, 0.012), 1e-3, 3600.0, "33", (2.72e-4, 1.32e-3)),
        ((0.06, 0.15), 5e-5, 300.0, "tilt", (0.000223 * G, 0.0002287 * G)),
    ],
)
def test_known_designs(unit, instability, time, name, known):
    """1 m at 1 Hz, just after a fix: without instability and with it."""
    for size, value in zip((0.0, instability), known, strict=True):
        _, after = FreeError([level(*unit, 1.0, 1.0, size, time)]).at_fix()
        assert math.sqrt(float(after[name][0])) == pytest.approx(value, rel=3e-3)
