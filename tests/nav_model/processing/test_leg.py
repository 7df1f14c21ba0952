"""The smoother in state space against a batch least squares, and the free INS against the closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from exact_sight import directions
from scipy.linalg import cho_factor, cho_solve

from nav_model.analytic.coast import horizontal_growth
from nav_model.analytic.steady_state import horizontal
from nav_model.aperture.phase import phase_budget, total
from nav_model.budget.figures import channels, smoothed_figures
from nav_model.budget.inputs import inputs_of
from nav_model.design import Design
from nav_model.processing.geolocation import free_line
from nav_model.processing.leg import smoothed_in_leg
from nav_model.processing.leg_fixes import fixes_in_legs
from nav_model.processing.modes import Fixes, Inside, smoothed_modes
from nav_model.processing.smoother import by_state_space, smoothed_error
from nav_model.processing.spectrum import Channel, Leg, rates, smoothed
from nav_model.sar.line_of_sight import ApertureGeometry

pytestmark = pytest.mark.long

NAMES = (
    "quadratic", "cubic", "left_1", "left_2", "left_3", "slope", "turned", "mean", "position", "velocity", "tilt",
)  # fmt: skip
SMALL = ("left_2", "left_3", "cubic")
NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)


def covariance(channel, one, two, kind_one, kind_two):
    """Of two errors that grow from nothing: position (kind 0), velocity (1), acceleration by tilt (2)."""
    x, weights = np.polynomial.legendre.leggauss(4)
    least = np.minimum(one[:, None], two[None, :])
    found = np.zeros(least.shape)

    def response(kind, rest):
        gyro = 0.0 if channel.gyro is None else float(channel.gyro) * rest ** (2 - kind) / math.factorial(2 - kind)
        return (float(channel.accelerometer) * rest ** (1 - kind) if kind < 2 else 0 * rest), gyro

    for node, weight in zip(x, weights, strict=True):
        u = least * (node + 1) / 2
        (a, w), (b, v) = response(kind_one, one[:, None] - u), response(kind_two, two[None, :] - u)
        found += least * weight / 2 * (a * b + w * v)
    return found


def errors(channel, aperture, leg):
    """Covariance of the position error at `NODES`, and of position, velocity and acceleration in the middle.

    Generalised least squares of the start and of all fixes at once, with the covariance of what grows between.

    No filter and no state: the error is three unknowns of the leg's start (two without a gyro) and a random process
    of known covariance; the fixes are that and their noise.
    """

    def fixes(step):
        k = np.arange(math.ceil(-leg.before / step - 1e-9), math.floor((aperture + leg.after) / step + 1e-9) + 1)
        return k * step + leg.before

    groups = [(fixes(channel.interval), 0)]
    if channel.velocity is not None:
        groups.append((fixes(channel.velocity_interval), 1))
    at = leg.before + (NODES + 1) / 2 * aperture
    middle = np.array([leg.before + aperture / 2])
    wanted = [(at, 0), (middle, 0), (middle, 1), (middle, 2)]

    def basis(times, kind):
        rest = times[:, None] - leg.before
        powers = [rest**n / math.factorial(n) for n in range(3 if channel.gyro is not None else 2)]
        return np.hstack([np.zeros_like(rest)] * kind + powers)[:, : len(powers)]

    def block(rows, columns):
        return np.block([[covariance(channel, s, t, i, j) for t, j in columns] for s, i in rows])

    noise = np.concatenate(
        [np.full(len(t), float(channel.fix if kind == 0 else channel.velocity) ** 2) for t, kind in groups]
    )
    known = block(groups, groups) + np.diag(noise)
    if channel.slow is not None:
        times = groups[0][0]
        slow = float(channel.slow) ** 2 * np.exp(-abs(times[:, None] - times) / float(channel.slow_time))
        known[: len(times), : len(times)] += slow
    factor = cho_factor(known, lower=True)
    across = block(groups, wanted)
    start, there = (np.vstack([basis(t, kind) for t, kind in group]) for group in (groups, wanted))
    reduced, seen = cho_solve(factor, across), cho_solve(factor, start)
    rest = there - across.T @ seen
    return block(wanted, wanted) - across.T @ reduced + rest @ np.linalg.solve(start.T @ seen, rest.T)


def batch(channel, aperture, leg):
    """What `smoothed_error` finds, from those errors."""
    found = errors(channel, aperture, leg)
    c, inside = found[:40, :40], np.diag(found)[40:]
    legendre = np.polynomial.legendre.legvander(NODES, 3) * WEIGHTS[:, None] / 2 * np.array([1, 3, 5, 7])
    coefficients = legendre.T @ c @ legendre
    left = [WEIGHTS @ np.diag(c) / 2]
    for m in range(4):
        left.append(left[-1] - coefficients[m, m] / (2 * m + 1))
    turned = coefficients[1, 1] + 9 / 7 * coefficients[1, 3] + (9 / 14) ** 2 * coefficients[3, 3]
    return {
        "quadratic": 9 / 4 * coefficients[2, 2], "cubic": 25 / 4 * coefficients[3, 3],
        "left_1": left[2], "left_2": left[3], "left_3": left[4], "slope": coefficients[1, 1] * 4 / aperture**2,
        "turned": turned, "mean": coefficients[0, 0], "position": inside[0], "velocity": inside[1],
        "tilt": inside[2],
    }  # fmt: skip


def random_design(rng, sparse):
    """MEMS to navigation grade, 1 cm to 5 m, with and without velocity and slow error; legs of 1/w0 to 20/w0."""

    def between(low, high):
        return np.array(math.exp(rng.uniform(math.log(low), math.log(high))))

    while True:
        vertical = rng.random() < 0.25
        values = {
            "accelerometer": between(0.003, 0.2) / 60,
            "gyro": None if vertical else 9.80665 * np.radians(between(0.002, 0.7)) / 60,
            "fix": between(0.01, 5), "interval": between(0.05, 20 if sparse else 2),
        }  # fmt: skip
        if rng.random() < 0.4:
            values |= {"velocity": between(0.01, 0.2), "velocity_interval": values["interval"]}
        if rng.random() < 0.25:
            values |= {"slow": values["fix"] * between(0.1, 3), "slow_time": between(20, 600)}
        channel = Channel(**values)
        rate = float(rates(channel)[1])
        leg = Leg(between(1, 20) / rate, between(1, 20) / rate, np.array(0.0))
        aperture = between(0.5, 20)
        count = (leg.before + leg.after + aperture) / channel.interval
        if 6 <= count <= 250 and leg.before > 2 * channel.interval and leg.after > channel.interval:
            return channel, aperture, leg


@pytest.mark.parametrize("sparse", [False, True])
def test_batch_least_squares(sparse, compared):
    rng = np.random.default_rng(11 + sparse)
    off, slow_off, methods = [], [], set()
    for _ in range(200 if not sparse else 60):
        channel, aperture, leg = random_design(rng, sparse)
        theirs = batch(channel, aperture, leg)
        # Where next to nothing is left of the position error, double precision leaves the batch no digits of it.
        names = [
            name
            for name in NAMES
            if (channel.gyro is not None or name != "tilt")
            and (name not in SMALL or theirs[name] > 1e-7 * theirs["position"])
        ]
        ours = smoothed_error([channel], aperture, leg, names)[0]
        methods.add(bool(by_state_space(channel, leg)))
        worst = max(abs(math.sqrt(float(ours[name]) / theirs[name]) - 1) for name in names)
        (slow_off if channel.slow is not None else off).append(worst)
    assert methods == {False, True}
    oracle = "generalised least squares of all fixes at once, SciPy's Cholesky, written out in the test"
    kind, how = "solver written by others", "sparse" if sparse else "dense"
    compared(f"Smoothed error, legs of 1/w0 to 20/w0, {how} fixes", "P-3", kind, oracle, max(off), 0.01,
             "largest ratio − 1")  # fmt: skip
    compared(f"Smoothed error with a slow GNSS error, {how} fixes", "P-3", kind, oracle, max(slow_off), 0.02,
             "largest ratio − 1")  # fmt: skip


@pytest.mark.parametrize(
    "values",
    [
        {"velocity": 0.02, "interval": 2.0},  # position is averaged over all of the leg
        {"velocity": 0.02, "interval": 2.0, "slow": 1.0, "slow_time": 300.0, "fix": 0.1},
        {"fix": 0.005, "gyro": 0.027, "interval": 10.0},  # little is known between fixes
        {"velocity": 0.05, "velocity_interval": 0.5},  # many velocity fixes for each of position
        {"accelerometer": 0.01, "velocity": 0.002, "interval": 2.0},  # each fix of velocity bends the error sharply
        {"fix": 0.3, "interval": 0.2},  # too many fixes in the aperture to take them one by one
    ],
)
def test_where_other_times_than_the_drift_count(values):
    design = {"accelerometer": 1e-3, "gyro": 1.2e-3, "fix": 2.5, "interval": 5.0} | values
    if "velocity" in design:
        design = {"velocity_interval": design["interval"], **design}
    channel = Channel(**{name: np.array(value) for name, value in design.items()})
    sides = (400.0, 35.0) if design["interval"] > 1 else (40.0, 10.0)
    leg = Leg(*map(np.array, (*sides, 0.0)))
    ours, theirs = smoothed_in_leg(channel, np.array(9.7), leg), batch(channel, np.array(9.7), leg)
    for name in ("quadratic", "left_1", "slope", "mean", "position", "velocity", "tilt"):
        assert math.sqrt(float(ours[name]) / theirs[name]) == pytest.approx(1, abs=0.004), name


@pytest.mark.parametrize("slow", [None, 1.0])
@pytest.mark.parametrize("squint", [0.0, 0.4])
@pytest.mark.parametrize("after", [40.0, 8.0])
def test_quadratic_along_the_exact_line_of_sight(after, squint, slow):
    """A target near enough that the turn counts: exact directions on the errors of all fixes at once."""
    values = {
        "gnss.position_noise": 0.5, "gnss.interval": 1.0, "radar.slant_range": 2000.0, "radar.squint_angle": squint,
        "radar.aperture_time": 6.0, "processing.leg_before": 40.0, "processing.leg_after": after,
        "processing.mode": "post-processed", "gnss.correlated": slow is not None,
    }  # fmt: skip
    x = inputs_of(Design(values | ({"gnss.correlated_noise": slow} if slow else {})))
    geometry = ApertureGeometry(2000.0, float(x.speed), float(x.grazing_angle), squint)
    sight = directions(geometry, np.concatenate([[0.0], (NODES + 1) * 3.0, [6.0]]))[1:-1]
    fit = 15 / 4 * WEIGHTS * np.polynomial.legendre.legval(NODES, [0, 0, 1])
    leg = Leg(np.array(40.0), np.array(after), np.array(0.0))
    level, upright = (errors(channel, np.array(6.0), leg)[:40, :40] for channel in channels(x))
    variance = sum(
        fit @ (np.outer(u, u) * one) @ fit for u, one in zip(sight.T, (level, level, upright), strict=True)
    )
    found = smoothed_figures(x, ("turning_quadratic_phase", "quadratic_phase", "along_track_quadratic_phase"))
    ours = float(found["turning_quadratic_phase"])
    apart = math.hypot(float(found["quadratic_phase"]), float(found["along_track_quadratic_phase"]))
    theirs = float(x.to_phase) * math.sqrt(variance)
    assert theirs / apart > 1.02
    assert ours == pytest.approx(theirs, rel=0.01)  # third order in the turn, 0.135, is left out


@pytest.mark.parametrize("slow", [None, 1.0])
@pytest.mark.parametrize("squint", [0.0, 0.4])
@pytest.mark.parametrize("after", [300.0, 8.0])
def test_residuals_along_the_exact_line_of_sight(after, squint, slow):
    """What is left after a line, and after a parabola, of the errors of all fixes at once along exact directions."""
    values = {
        "gnss.position_noise": 0.5, "gnss.interval": 1.0, "radar.slant_range": 5000.0, "radar.squint_angle": squint,
        "radar.aperture_time": 6.0, "processing.leg_before": 60.0, "processing.leg_after": after,
        "processing.mode": "post-processed", "gnss.correlated": slow is not None,
    }  # fmt: skip
    x = inputs_of(Design(values | ({"gnss.correlated_noise": slow} if slow else {})))
    geometry = ApertureGeometry(5000.0, float(x.speed), float(x.grazing_angle), squint)
    sight = directions(geometry, np.concatenate([[0.0], (NODES + 1) * 3.0, [6.0]]))[1:-1]
    leg = Leg(np.array(60.0), np.array(after), np.array(0.0))
    axes = [errors(channel, np.array(6.0), leg)[:40, :40] for channel in (channels(x)[0], *channels(x))]
    along = sum(np.outer(u, u) * one for u, one in zip(sight.T, axes, strict=True))
    found = smoothed_figures(x, ("turning_detrended_phase_1", "turning_detrended_phase_2", "detrended_phase_1"))
    left = {}
    for order in (1, 2):
        fit = np.polynomial.polynomial.polyvander(NODES, order)
        take = np.eye(40) - fit @ np.linalg.solve(fit.T @ (WEIGHTS[:, None] * fit), fit.T * WEIGHTS)
        left[order] = float(x.to_phase) * math.sqrt(WEIGHTS / 2 @ np.diag(take @ along @ take.T))
        assert float(found[f"turning_detrended_phase_{order}"]) == pytest.approx(left[order], rel=0.01)
    assert left[1] / float(found["detrended_phase_1"]) > 1.015


@pytest.mark.parametrize("modes", [8, 32])
@pytest.mark.parametrize("aperture", [0.7, 5.4, 40.0])
def test_free_ins_by_the_same_filters(modes, aperture, compared):
    """An aperture without fixes, from a known start and with nothing after it, against the closed forms."""
    a, w, g = 1.3e-3, 1.4e-4, 9.80665
    start = horizontal(a, w, 1.0, g)
    unit = np.array([1.0, 1.0, g])
    known = np.linalg.inv(start.matrix() * np.outer(unit, unit))[..., None]
    row = {
        name: np.array([value]) for name, value in (("a", a**2), ("w", (g * w) ** 2), ("t", aperture), ("none", 0.0))
    }
    none = Fixes(row["none"][:, None] + 0.5, row["none"][:, None])
    found = smoothed_modes(Inside(row["a"], row["w"], row["t"], known, 0 * known, none, None, None), modes)
    off = []
    for order in (1, 2, 3):
        closed = total(phase_budget(start.p33, a, w, 0.0, 0.0, g, aperture, 0.0, 0.0, order))
        off.append(float(found[f"left_{order}"][0] / closed.detrended) - 1)
    off += [float(found["quadratic"][0] / closed.quadratic) - 1, float(found["cubic"][0] / closed.cubic) - 1]
    middle = horizontal_growth(start, a, w, g, aperture / 2)
    off += [float(found["position"][0] / middle.position) - 1, float(found["velocity"][0] / middle.velocity) - 1]
    off.append(float(found["tilt"][0] / (g**2 * middle.tilt)) - 1)
    line = free_line(start, a, w, 0.0, 0.0, g, 0.0, aperture)
    off += [
        float(found[name][0] / part) - 1
        for name, part in (("mean", line.mean), ("slope", line.slope), ("mean_slope", line.both))
    ]
    compared("Free INS by the filters of the smoother", "S-5", "our own derivation", "[S-5], [S-6] in closed form",
             off, 1e-9, "largest ratio − 1")  # fmt: skip


def pace_design(rng, ratio):
    """Fixes of two kinds, velocity at `ratio` of the interval of position: sharp, poor, dense and sparse ones."""

    def between(low, high):
        return np.array(math.exp(rng.uniform(math.log(low), math.log(high))))

    while True:
        interval = between(0.05, 10)
        gyro = 9.80665 * np.radians(between(0.002, 2)) / 60
        channel = Channel(
            between(0.003, 0.5) / 60, gyro, between(0.01, 5), interval, between(0.001, 0.3), interval * ratio(rng)
        )
        rate = float(rates(channel)[1])
        leg, aperture = Leg(between(1, 10) / rate, between(1, 10) / rate, np.array(0.0)), between(0.5, 60)
        often, seldom = sorted([float(channel.interval), float(channel.velocity_interval)])
        count = float(leg.before + leg.after + aperture) / often
        # In a longer leg double precision leaves the batch too few digits.
        if 6 <= count <= 300 and 2 * seldom < leg.before < 200 and seldom < leg.after < 200:
            return channel, aperture, leg


@pytest.mark.parametrize(
    ("ratio", "most", "usual"),
    [
        (lambda rng: 1.0, 0.006, 1e-4),
        (lambda rng: float(rng.integers(2, 7)) ** rng.choice([-1, 1]), 0.006, 1e-4),
        (lambda rng: math.exp(rng.uniform(-2.0, 2.0)), 0.02, 1e-3),  # no whole number of fixes: far ones are spread
    ],
    ids=["together", "a whole number", "any ratio"],
)
def test_two_kinds_of_fixes_at_their_own_pace(ratio, most, usual):
    """Velocity of 1 mm/s to 0.3 m/s against the batch, apertures of up to a minute, as chosen and by doubling."""
    rng = np.random.default_rng(4)
    off = {None: [], 3: []}
    for _ in range(40):
        channel, aperture, leg = pace_design(rng, ratio)
        theirs = batch(channel, aperture, leg)
        names = [name for name in NAMES if name not in SMALL or theirs[name] > 1e-7 * theirs["position"]]
        for level, found in off.items():
            ours = smoothed_in_leg(channel, aperture, leg, None if level is None else np.array(level))
            found.append(max(abs(math.sqrt(float(ours[name]) / theirs[name]) - 1) for name in names))
    for found in off.values():
        assert max(found) < most
    assert np.median(off[3]) < usual


@pytest.mark.parametrize("velocity_interval", [None, 1.0, 0.3, 2.7])
def test_a_leg_counts_by_its_fixes_alone(velocity_interval):
    """Legs with as many fixes give the same figures to the last digit, and legs with others other ones."""
    values = [np.array(x) for x in (1.2e-3, 6e-4, 1.0, 1.0)]
    velocity = () if velocity_interval is None else (np.array(0.03), np.array(velocity_interval))
    channel, aperture, gap = Channel(*values, *velocity), np.array(4.3), np.array(0.7)
    lengths = np.linspace(0.7, 12.0, 150)
    for side, leg in enumerate((Leg(lengths, np.array(9.0), gap), Leg(np.array(9.0), lengths, gap))):
        same = np.all(np.diff(fixes_in_legs(channel, aperture, leg)[:, side]) == 0, axis=0)
        found = smoothed_in_leg(channel, aperture, leg)["position"]
        np.testing.assert_array_equal(np.diff(found) == 0, same)
        assert 0 < np.count_nonzero(~same) < 60


def test_more_leg_and_better_sensors_never_harm():
    channel = Channel(*(np.array(x) for x in (1.2e-3, 6e-4, 1.0, 1.0)))
    legs = np.array([0.0, 5.0, 10.0, 20.0, 50.0, 79.0, 81.0, 200.0])
    found = smoothed_error([channel], np.array(5.0), Leg(np.array(200.0), legs, np.array(0.0)), NAMES)[0]
    for name in NAMES:
        assert np.all(np.diff(found[name]) <= 2e-3 * found[name][1:]), name
    gaps = np.array([0.0, 1.0, 5.0, 20.0])
    found = smoothed_error([channel], np.array(5.0), Leg(np.array(200.0), np.array(200.0), gaps), NAMES)[0]
    for name in NAMES:
        assert np.all(np.diff(found[name]) >= -2e-3 * found[name][1:]), name


@pytest.mark.parametrize(
    ("velocity", "aperture"),
    [
        ((), 5.1),
        ((0.02, 1.0), 5.1),
        ((0.02, 0.25), 5.1),
        ((0.02, 0.3), 5.1),
        ((0.02, 1.7), 1.1),  # with a fix in the second half alone
    ],
)
@pytest.mark.parametrize("level", [1, 3])
def test_a_complex_step_is_answered_with_a_slope(velocity, aperture, level):
    step = np.array(1.0 + 1e-20j)
    leg = Leg(*(np.array(x) for x in (10.0, 10.0, 0.0)))
    values = [np.array(x) for x in (1.2e-3, 6e-4, 1.0, 1.0, *velocity)]
    total_slope = 0.0
    sources = [0, 1, 2, 4][: 3 + bool(velocity)]
    for n in sources:  # the variance is of degree one in the sources' variances
        scaled = [value * step if n == m else value for m, value in enumerate(values)]
        found = smoothed_in_leg(Channel(*scaled), np.array(aperture), leg, np.array(level))["quadratic"]
        total_slope += float(found.imag / found.real) * 1e20
    assert total_slope == pytest.approx(2, abs=1e-5)
    slopes = []  # and the figures in the aperture are smooth between fixes
    for span in (np.array(aperture) * step, np.array(aperture * (1 + 1e-5)), np.array(aperture * (1 - 1e-5))):
        slopes.append(smoothed_in_leg(Channel(*values), span, leg, np.array(level))["quadratic"])
    by_difference = float(slopes[1] - slopes[2]) / 2e-5
    assert float(slopes[0].imag) * 1e20 == pytest.approx(by_difference, rel=1e-5)


def test_a_very_long_aperture_is_all_middle():
    """Where next to nothing of an aperture is near its ends, its figures are those of the spectrum, upright too."""
    channel = Channel(*(np.array(x) for x in (2e-3, 1e-3, 0.05, 0.2)))
    leg, aperture = Leg(*(np.array(x) for x in (100.0, 100.0, 0.0))), np.array(2000.0)
    names = ("quadratic", "cubic", "left_1", "slope", "position")
    for gyro, tilted in ((channel.gyro, channel.gyro), (np.array(0.0), None)):
        with np.errstate(divide="raise", invalid="raise"):
            ours = smoothed_in_leg(replace(channel, gyro=gyro), aperture, leg)
            theirs = smoothed(replace(channel, gyro=tilted), aperture, names)
        for name in names:
            assert np.sqrt(ours[name] / theirs[name]) == pytest.approx(1, abs=2e-4), name
