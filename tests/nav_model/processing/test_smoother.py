"""The smoother against a batch least squares and the spectrum, and the free INS against the closed forms."""

import math
from dataclasses import replace

import batch
import numpy as np
import pytest
import riccati
import spectral
from exact_sight import directions

from nav_model.analytic.channel import Noise
from nav_model.analytic.coast import horizontal_growth
from nav_model.analytic.doubling import carried
from nav_model.analytic.steady_state import horizontal
from nav_model.aperture.phase import phase_budget, total
from nav_model.base.constants import MEAN_RADIUS
from nav_model.budget.inputs import inputs_of
from nav_model.budget.real_time import RealTime
from nav_model.budget.smoothed import Smoothed
from nav_model.budget.varying import channels
from nav_model.design import Design
from nav_model.processing import stretch
from nav_model.processing.flight import Channel
from nav_model.processing.geolocation import free_line
from nav_model.processing.smoother import COLUMNS, smoothed_error
from nav_model.sar.line_of_sight import ApertureGeometry

VARIANCES = (
    "quadratic", "cubic", "left_1", "left_2", "left_3", "slope", "turned", "curved", "mean", "position", "velocity",
    "tilt", "cubic_turned", "cubic_curved",
)  # fmt: skip
SLOWLY = ("quadratic", "left_1", "slope", "mean", "position", "velocity", "tilt")
ZERO = np.array(0.0)


def channel_of(*values):
    return Channel(*(None if value is None else np.array(value) for value in values))


def between(rng, low, high):
    return np.array(math.exp(rng.uniform(math.log(low), math.log(high))))


def random_channel(rng, ratio):
    """MEMS to navigation grade, 1 cm to 5 m every 0.05 to 20 s; `ratio` of velocity interval to that of position."""
    gyro = None if rng.random() < 0.25 else 9.80665 * np.radians(between(rng, 0.002, 0.7)) / 60
    interval = between(rng, 0.05, 20)
    channel = Channel(between(rng, 0.003, 0.2) / 60, gyro, between(rng, 0.01, 5), interval)
    if ratio is not None:
        channel = replace(channel, velocity=between(rng, 0.003, 0.3), velocity_interval=interval * ratio(rng))
    if rng.random() < 0.35:  # slow, or as good as white
        channel = replace(channel, slow=channel.fix * between(rng, 0.1, 5), slow_time=between(rng, 0.1, 600))
    return channel


def random_case(rng, ratio):
    """A channel with apertures of 0.3 s to a minute, fixes for up to 100 s after it, and gaps before it."""
    while True:
        channel, aperture = random_channel(rng, ratio), between(rng, 0.3, 60)
        after, gap = (between(rng, 0.1, 100) * (rng.random() < share) for share in (0.7, 0.3))
        often = min(channel.interval, channel.interval if ratio is None else channel.velocity_interval)
        if (aperture + after) / often < 250:
            return channel, aperture, after, gap


@pytest.mark.parametrize(
    ("kind", "ratio"),
    [
        ("position fixes", None),
        ("velocity with each fix", lambda rng: 1.0),
        ("more velocity fixes", lambda rng: 1 / rng.integers(2, 9)),
        ("fewer velocity fixes", lambda rng: float(rng.integers(2, 9))),
        ("intervals that do not divide, rounded", lambda rng: math.exp(rng.uniform(-2, 2))),
    ],
    ids=["alone", "together", "more", "fewer", "rounded"],
)
def test_batch_least_squares(kind, ratio, compared):
    rng = np.random.default_rng(11)
    off, paired = [], []
    for _ in range(25):
        channel, aperture, after, gap = random_case(rng, ratio)
        (ours,) = smoothed_error([channel], aperture, after, gap, COLUMNS)
        theirs = batch.smoothed(batch.whole_ratio(channel), *map(float, (aperture, after, gap)))
        for name in VARIANCES:
            # Where next to nothing is left of the position error, double precision leaves the batch no digits of it.
            if theirs[name] > 1e-8 * theirs["mean"] or (name in SLOWLY[5:] and (name != "tilt" or channel.gyro)):
                off.append(math.sqrt(float(ours[name]) / theirs[name]) - 1)
        for name, (row, column) in spectral.PAIRS.items():
            if row != column:
                first, second = (
                    next(n for n, pair in spectral.PAIRS.items() if pair == (k, k)) for k in (row, column)
                )
                size = math.sqrt(ours[first] * ours[second])
                if size > 1e-8 * theirs["mean"]:
                    paired.append(float(ours[name] - theirs[name]) / size)
    oracle = "generalised least squares of all fixes at once, SciPy's Riccati and Cholesky, written out in the test"
    compared(f"Smoothed error, {kind}", "P-3", "solver written by others", oracle, off, 1e-3)
    compared(f"Covariances in it, {kind}", "P-3", "solver written by others", oracle, paired, 1e-3,
             "largest difference of a correlation")  # fmt: skip


@pytest.mark.long
def test_intervals_that_do_not_divide():
    """Everyday receivers, with their own intervals: half of them within 0.5 %, phase within 5 %, velocity 10 %."""
    rng, off, phase = np.random.default_rng(5), [], []
    for _ in range(20):
        interval = between(rng, 0.2, 2)
        channel = Channel(
            between(rng, 0.003, 0.2) / 60, 9.80665 * np.radians(between(rng, 0.01, 0.7)) / 60, between(rng, 0.1, 3),
            interval, between(rng, 0.01, 0.1), interval * math.exp(rng.uniform(-1.5, 1.5)),
        )  # fmt: skip
        aperture, after = between(rng, 0.5, 15), between(rng, 0.5, 40)
        (ours,) = smoothed_error([channel], aperture, after, ZERO, SLOWLY)
        theirs = batch.smoothed(channel, float(aperture), float(after), start=batch.run_up(channel, 300.0))
        apart = [abs(math.sqrt(float(ours[name]) / theirs[name]) - 1) for name in SLOWLY]
        off.append(max(apart))
        phase.append(max(apart[:2]))
    assert max(phase) < 0.05
    assert max(off) < 0.1
    assert np.median(off) < 0.005


@pytest.mark.parametrize("slow", [None, 1.0])
@pytest.mark.parametrize("squint", [0.0, 0.4])
@pytest.mark.parametrize("after", [300.0, 8.0])
def test_along_the_exact_line_of_sight(after, squint, slow):
    """Targets so near that the turn counts: exact directions on the errors of all fixes at once."""
    for distance in (2000.0, 5000.0):
        values = {
            "gnss.position_noise": 0.5, "gnss.interval": 1.0, "radar.slant_range": distance,
            "radar.squint_angle": squint, "radar.aperture_time": 6.0, "processing.leg_after": after,
            "processing.mode": "post-processed", "gnss.correlated": slow is not None,
        }  # fmt: skip
        x = inputs_of(Design(values | ({"gnss.correlated_noise": slow} if slow else {})))
        geometry = ApertureGeometry(distance, float(x.speed), float(x.grazing_angle), squint)
        nodes, weights = spectral.NODES, spectral.WEIGHTS
        sight = directions(geometry, np.concatenate([[0.0], (nodes + 1) * 3.0, [6.0]]))[1:-1]
        level, upright = (batch.errors(c, 6.0, after, batch.initial(c, 0.0))[:60, :60] for c in channels(x))
        along = sum(np.outer(u, u) * block for u, block in zip(sight.T, (level, level, upright), strict=True))
        model = Smoothed(x)
        result = {
            name: getattr(model, name)
            for name in ("quadratic_phase", "line_of_sight_quadratic_phase", "along_track_quadratic_phase",
                         "detrended_phase_1", "detrended_phase_2", "line_of_sight_detrended_phase")
        }  # fmt: skip
        if distance == 2000.0:
            fit = spectral.KERNELS["quadratic0"][1:-1] * weights
            theirs = float(x.to_phase) * math.sqrt(fit @ along @ fit)
            parts = (result[f"{part}_quadratic_phase"] for part in ("line_of_sight", "along_track"))
            apart = math.hypot(*map(float, parts))
            assert theirs / apart > 1.02
            # third order in the turn, 0.135, is left out
            assert float(result["quadratic_phase"]) == pytest.approx(theirs, rel=0.01)
            continue
        sigma = {}
        for order in (1, 2):
            fit = np.polynomial.polynomial.polyvander(nodes, order)
            take = np.eye(60) - fit @ np.linalg.solve(fit.T @ (weights[:, None] * fit), fit.T * weights)
            sigma[order] = float(x.to_phase) * math.sqrt(weights / 2 @ np.diag(take @ along @ take.T))
            assert float(result[f"detrended_phase_{order}"]) == pytest.approx(sigma[order], rel=0.01)
        assert sigma[1] / float(result["line_of_sight_detrended_phase"]) > 1.015


def test_dense_fixes_are_the_spectrum(compared):
    """Endless legs of thirty designs, apertures of a second to a quarter of an hour, upright too."""
    rng, off = np.random.default_rng(2), []
    for n in range(30):
        fix, interval = between(rng, 0.01, 5), between(rng, 0.002, 0.02)
        gyro = None if n % 4 == 0 else between(rng, 1e-4, 1e-2)
        channel = Channel(between(rng, 1e-4, 3e-3), gyro, fix, interval)
        if n % 2:
            channel = replace(channel, velocity=between(rng, 0.02, 0.3), velocity_interval=interval)
        if n % 3 == 0:
            channel = replace(channel, slow=fix * between(rng, 0.1, 2), slow_time=between(rng, 5, 300))
        aperture = between(rng, 1, 900)
        (ours,) = smoothed_error([channel], aperture, np.array(1e5), ZERO, COLUMNS)
        theirs = spectral.smoothed(channel, aperture)
        for name in VARIANCES:
            if name in theirs and theirs[name] > 1e-10 * theirs["position"]:
                off.append(math.sqrt(float(ours[name]) / theirs[name]) - 1)
        for name in ("with_curved", "cubic_with_curved"):
            off.append(float(ours[name]) / theirs[name] - 1)
    oracle = "[P-1] to [P-5] as a spectrum through the aperture, quadrature written out in the test"
    compared("Smoothed error of an endless leg", "P-5", "our own derivation", oracle, off, 2e-3)


def test_free_ins_is_the_closed_forms(compared):
    """An aperture without fixes, whole or of seven pieces, from a known start and with nothing after it."""
    a, w, g, off = 1.3e-3, 1.4e-4, 9.80665, []
    start = horizontal(a, w, 1.0, g)
    unit = np.array([1.0, 1.0, g])
    known = start.matrix() * np.outer(unit, unit)
    for aperture in (0.7, 5.4, 40.0):
        noise = Noise(np.array([a**2]), np.array([(g * w) ** 2]), np.zeros(1))
        piece = stretch.free(np.array([aperture / 7]), noise)
        pieces = piece
        for _ in range(6):
            pieces = stretch.joined(pieces, piece)
        for free in (stretch.free(np.array([aperture]), noise), pieces):
            along = free.lines[0, :, :3]
            c = free.spread[0] + along @ known @ along.T  # orthonormal polynomials
            residuals = [np.trace(c[m:, m:]) + free.rest[0] for m in (2, 3, 4)]
            for order, result in zip((1, 2, 3), residuals, strict=True):
                closed = total(phase_budget(start.p33, a, w, 0.0, 0.0, g, aperture, 0.0, 0.0, order))
                off.append(result / float(closed.detrended) - 1)
            off += [c[2, 2] * 45 / 4 / closed.quadratic - 1, c[3, 3] * 175 / 4 / closed.cubic - 1]
            line = free_line(start, a, w, 0.0, 0.0, g, 0.0, aperture)
            off += [c[0, 0] / line.mean - 1, c[1, 1] * 12 / aperture**2 / line.slope - 1]
            off.append(c[0, 1] * math.sqrt(12) / aperture / line.covariance - 1)
            end, closed = carried(known, free.segment)[0], horizontal_growth(start, a, w, g, aperture)
            off += [
                end[0, 0] / closed.position - 1,
                end[1, 1] / closed.velocity - 1,
                end[2, 2] / g**2 / closed.tilt - 1,
            ]
    oracle = "formulas [S-5], [S-6]"
    compared("Free INS by the smoother's stretches", "S-5", "our own derivation", oracle, off, 1e-8)


def test_fixes_count_by_their_number_and_never_harm():
    rng = np.random.default_rng(8)
    afters, gaps = np.linspace(0.0, 60.0, 121), np.linspace(0.0, 20.0, 21)
    for ratio in (None, lambda rng: 1.0, lambda rng: 0.25, lambda rng: 3.0):
        for _ in range(10):
            channel = replace(random_channel(rng, ratio), gyro=between(rng, 1e-5, 1e-2))
            step = channel.interval if ratio is None else min(channel.interval, channel.velocity_interval)
            spans = afters * (step / 1.5)
            result = smoothed_error([channel], step * 4, spans, ZERO, VARIANCES)[0]
            same = np.diff(np.floor(spans / step + 1e-9)) == 0
            for name in VARIANCES:
                np.testing.assert_array_equal(np.diff(result[name])[same], 0.0)
                # of a residual beside whose position error it is tiny, the last digits are rounding
                assert np.all(np.diff(result[name]) <= 1e-9 * result[name][1:] + 1e-12 * result["mean"][1:]), name
            result = smoothed_error([channel], step * 4, np.array(200.0), gaps, VARIANCES)[0]
            for name in VARIANCES:  # where the fixes before a gap are moves with it
                assert np.all(np.diff(result[name]) >= -2e-3 * result[name][1:]), name
                np.testing.assert_allclose(result[name][gaps < step], result[name][0], rtol=1e-9, err_msg=name)


@pytest.mark.parametrize("velocity", [(), (0.02, 1.0), (0.02, 0.25), (0.02, 0.3), (0.02, 1.7)])
def test_a_complex_step_is_answered_with_a_slope(velocity):
    step, after = np.array(1.0 + 1e-20j), np.array(10.0)
    values = [np.array(x) for x in (1.2e-3, 6e-4, 1.0, 1.0, *velocity)]
    total_slope = 0.0
    for n in [0, 1, 2, 4][: 3 + bool(velocity)]:  # the variance is of degree one in the sources' variances
        scaled = [value * step if n == m else value for m, value in enumerate(values)]
        (result,) = smoothed_error([Channel(*scaled)], np.array(5.1), after, ZERO, ["quadratic"])
        total_slope += float(result["quadratic"].imag / result["quadratic"].real) * 1e20
    assert total_slope == pytest.approx(2, abs=1e-9)
    for n, (span, interval) in enumerate(((step, 1), (1, step))):  # smooth between fixes, and in their interval
        slopes = []
        for by in (step, np.array(1 + 1e-5), np.array(1 - 1e-5)):
            timed = [value * by if m in (3, 5) and n else value for m, value in enumerate(values)]
            aperture = np.array(5.1) * (1 if n else by)
            slopes.append(
                smoothed_error([Channel(*timed)], aperture, after + 0.5, ZERO, ["quadratic"])[0]["quadratic"]
            )
        by_difference = float(slopes[1] - slopes[2]) / 2e-5
        assert float(slopes[0].imag) * 1e20 == pytest.approx(by_difference, rel=1e-5), (span, interval)


@pytest.mark.parametrize("velocity", [(None, None), (0.05, 1.0)])
def test_a_slow_error_forgotten_between_fixes_is_white(velocity):
    """10 m of 0.1 s at 1 Hz beside 1 m of white noise: sqrt(101) m."""
    arguments = np.array(4.0), np.array(30.0), ZERO, VARIANCES
    (slow,) = smoothed_error([channel_of(2e-3, 1e-3, 1.0, 1.0, *velocity, 10.0, 0.1)], *arguments)
    (white,) = smoothed_error([channel_of(2e-3, 1e-3, math.sqrt(101), 1.0, *velocity)], *arguments)
    for name in VARIANCES:
        assert slow[name] == pytest.approx(white[name], rel=5e-4), name


def test_one_design_beyond_double_precision_leaves_the_others():
    fixes = np.array([1.0, 1e-200, 1e200, 0.5])
    channel = Channel(np.array(2e-3), np.array(1e-3), fixes, np.array(1.0), np.array(0.03), np.array(0.2))
    with np.errstate(all="ignore"):
        (together,) = smoothed_error([channel], np.array(4.0), np.array(30.0), ZERO, VARIANCES)
    for n in (0, 3):
        (alone,) = smoothed_error([replace(channel, fix=fixes[n])], np.array(4.0), np.array(30.0), ZERO, VARIANCES)
        for name in VARIANCES:
            assert together[name][n] == pytest.approx(float(alone[name]), rel=1e-12), name


def test_gravity_by_height_drives_a_vertical_error_on():
    """A navigation grade unit under a slow error of minutes: filter and smoother of SciPy and NumPy, written out."""
    a, g, h, r, slow, time = 2e-4, 9.80665, 0.2, 2.8, 3.47, 211.0
    for gradient, sign in ((2 * g / MEAN_RADIUS, 1), (0.0, 0)):
        f = np.array([[0.0, 1.0], [gradient, 0.0]])
        phi, q = (np.pad(part, (0, 1)) for part in riccati.van_loan(f, np.diag([0.0, a**2]), h))
        phi[2, 2], q[2, 2] = math.exp(-h / time), slow**2 * -math.expm1(-2 * h / time)
        row, unit = np.array([[1.0, 0.0, 1.0]]), np.array([1.0, 100.0, 1.0])
        prior, posterior = riccati.settled(phi, q, row, r**2, unit)
        info = np.zeros((3, 3))
        for _ in range(20_000):  # of all fixes that follow, from the last to the first
            info = info + row.T @ row / r**2
            info = phi.T @ info @ np.linalg.solve(np.eye(3) + q @ info, phi)
        smoothed = np.linalg.inv(np.linalg.inv(posterior) + info)
        if sign:
            x = inputs_of(Design({
                "imu.velocity_random_walk": a, "gnss.interval": h, "gnss.position_noise": r, "gnss.correlated": True,
                "gnss.correlated_noise": slow, "gnss.correlation_time": time, "radar.aperture_time": 0.2,
                "processing.leg_after": 3600.0,
            }))  # fmt: skip
            before = RealTime(x).cycle.prior.vertical
            assert float(before.v11) == pytest.approx(prior[0, 0], rel=1e-6)
            assert float(before.v22) == pytest.approx(prior[1, 1], rel=1e-6)
            assert float(Smoothed(x).vertical_position) ** 2 == pytest.approx(smoothed[0, 0], rel=1e-3)
            filtered, both = math.sqrt(prior[0, 0]), math.sqrt(smoothed[0, 0])
        else:  # it shows: worse in real time, better with the fixes that follow
            assert filtered > 1.1 * math.sqrt(prior[0, 0])
            assert both < 0.7 * math.sqrt(smoothed[0, 0])
