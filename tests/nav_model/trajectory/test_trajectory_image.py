"""Image figures along a straight line against the budget, which has them from a smoother without a flight."""

import math

import numpy as np
import pytest
from entered import entered

from nav_model.base.constants import STANDARD_GRAVITY
from nav_model.budget import analyse
from nav_model.budget.inputs import inputs_of
from nav_model.budget.real_time import RealTime
from nav_model.design import Design
from nav_model.design.file import read_design
from nav_model.simulation.design_study import settling, specification
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.simulation.truth import true_states
from nav_model.trajectory.aperture import apertures_of, directions
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import covariance_specification
from nav_model.trajectory.errors import error_model
from nav_model.trajectory.plan import fly
from nav_model.trajectory.result import TrajectoryResult
from nav_model.trajectory.waypoints import Plan, Waypoint

BASES = [read_design(f"examples/{name}_x_band.toml") for name in ("mems", "tactical")]
NAMES = ("quadratic_phase", "cubic_phase", "detrended_phase", "azimuth_shift")
REVIEWED = [
    (0.01, 0.5, 70.0, 1),
    (0.02, 0.5, 70.0, 1),
    (0.008, 0.5, 12.0, 1),
    (0.02, 0.5, 60.0, 3),
    (1.0, 1.0, 20.0, 3),
]
"""Fix [m], interval [s], aperture [s] and order at which a review found figures 1.7 to 170 % off."""
MOST_STEPS = 20_000  # of any of these flights, so that none takes a minute


def drawn(base: Design, seed: int) -> Design:
    """Fixes of 5 mm to 5 m, apertures of 0.5 to 120 s, every order, some with fixes of velocity or a slow error."""
    draw = np.random.default_rng(seed)

    def between(low: float, high: float) -> float:
        return float(np.exp(draw.uniform(np.log(low), np.log(high))))

    changes = {
        "gnss.position_noise": between(0.005, 5.0),
        "gnss.interval": float(draw.choice([0.2, 0.5, 1.0, 2.0])),
        "radar.aperture_time": between(0.5, 120.0),
        "radar.autofocus_order": int(draw.integers(1, 4)),
        "imu.angle_random_walk": base.imu.angle_random_walk * between(0.2, 5.0),
        "imu.velocity_random_walk": base.imu.velocity_random_walk * between(0.2, 5.0),
    }
    if draw.random() < 0.4:
        changes["gnss.velocity_noise"] = between(0.005, 0.2)
    if draw.random() < 0.5:
        slow = {"correlated": True, "correlated_noise": between(0.05, 3.0), "correlation_time": between(20.0, 600.0)}
        changes |= {f"gnss.{key}": value for key, value in slow.items()}
    return plain(base, changes)


def plain(base: Design, changes: dict[str, object]) -> Design:
    required = dict.fromkeys((f"requirements.{name}" for name in NAMES), 1.0)
    still = {"gnss.vertical_position_noise": None, "gnss.correlated": False, "coast.before_aperture": 0.0}
    return base.replace(still | required | changes)


def flown(design: Design) -> TrajectoryResult:
    """Along a straight line with the aperture in its middle."""
    interval = design.gnss.interval
    side = min(settling(design), 300.0) + 0.5 * design.radar.aperture_time
    duration = 2 * math.ceil(side / interval) * interval
    study = specification(design, trajectory="straight", duration=duration, every=duration / 2)
    return covariance(covariance_specification(design, study), MOST_STEPS)


def compare(design: Design) -> None:
    result = flown(design)
    middle, length, interval = 1, design.radar.aperture_time, design.gnss.interval
    begin = math.floor((result.time_s[middle] - length / 2) / interval + 1e-9) * interval
    # The flight goes on for the smoother after its last result.
    end = result.time_s[-1] + result.spec.flown_further
    waiting = {"processing.mode": "post-processed", "processing.leg_after": end - begin - length}
    smoothed = analyse(design.replace(waiting)).verdict.checks
    # In real time the aperture begins just after a fix; the budget's own figures begin at the average between fixes.
    free = RealTime(inputs_of(design))
    free.at_last_fix = free.cycle.posterior
    for name in NAMES:
        # The Earth's terms, which closed forms leave out, reach 1 % in a free INS after 100 s.
        assert result.real_time.figures[name][middle] == pytest.approx(float(free.value(name)), rel=0.012), name
        sigma = next(check.sigma for check in smoothed if check.name == name)
        # What the sums of an aperture leave counts as of a free INS where it is little: 1 % of a detrended phase.
        off = 0.012 if name == "detrended_phase" else 0.005
        assert result.post_processed.figures[name][middle] == pytest.approx(sigma, rel=off), name
        for part in (result.real_time, result.post_processed):
            assert part.shares[name][:, middle].sum() == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("case", REVIEWED)
@pytest.mark.parametrize("base", BASES, ids=["mems", "tactical"])
def test_where_a_review_found_them_wrong(base: Design, case: tuple[float, float, float, int]) -> None:
    keys = ("gnss.position_noise", "gnss.interval", "radar.aperture_time", "radar.autofocus_order")
    compare(plain(base, dict(zip(keys, case, strict=True))))


@pytest.mark.long
@pytest.mark.parametrize("seed", [*range(16), *(pytest.param(n, marks=pytest.mark.slow) for n in range(16, 200))])
def test_random_designs(seed: int) -> None:
    compare(drawn(BASES[seed % 2], seed))


def test_a_flight_begins_with_the_covariance_of_a_settled_filter() -> None:
    """A turn-on bias of 0.5 mg: the tilt is root of noise² + (b/g)² from the first moment, as in the budget."""

    def straight(bias: str) -> TrajectoryResult:
        design = entered(BASES[0], {"accelerometer.turn_on_bias": bias, "filter.states": "15"})
        study = specification(design, trajectory="straight", duration=900.0, every=30.0)
        return covariance(covariance_specification(design, study))

    result, plain = straight("0.5 mg"), straight("0 mg")
    np.testing.assert_allclose(result.real_time.attitude[:, :2], 0.000548, rtol=0.01)
    np.testing.assert_allclose(result.real_time.position[:, 2], 0.21, rtol=0.01)
    for name in ("quadratic_phase", "detrended_phase"):
        inside = np.isfinite(plain.real_time.figures[name])
        for first, second in ((result.real_time, plain.real_time), (result.post_processed, plain.post_processed)):
            np.testing.assert_allclose(first.figures[name][inside], second.figures[name][inside], rtol=0.002)
    tilt = dict(zip(result.sources, result.real_time.shares["tilt"][:, 0], strict=True))
    assert tilt["accelerometer turn-on bias"] == pytest.approx((0.0005 / 0.000548) ** 2, rel=0.02)


def test_after_a_turn_without_fixes_what_acts_is_the_bias_as_it_has_turned() -> None:
    """By 90° it is sqrt(2) b: the quadratic phase of the bias against that of a bias which no tilt cancels."""
    bias = 0.5e-3 * STANDARD_GRAVITY
    east = 1 / (6.38e6 * math.cos(math.radians(45.0)))
    start, legs = math.radians(45.0), ((0.0, 0.0), (6000 / 6.38e6, 0.0), (6000 / 6.38e6, 9000 * east))
    flight = fly(Plan(tuple(Waypoint(start + north, along, 3000.0) for north, along in legs), 60.0))
    design = entered(BASES[0], {"gnss.interval": "1 s", "accelerometer.turn_on_bias": "0.5 mg"})
    turn = [(85.0, math.floor(flight.duration) - 1.0)]
    study = specification(
        design, trajectory=flight.trajectory, duration=math.floor(flight.duration), every=1.0, outages=turn
    )
    result, x = covariance(covariance_specification(design, study)), inputs_of(design)
    shares = dict(zip(result.sources, result.real_time.shares["quadratic_phase"], strict=True))
    share = shares["accelerometer turn-on bias"]
    time = result.time_s[np.argmax(np.abs(result.truth.velocity[:, 0]) < 0.01)]
    at = int(np.argmax(result.time_s > time + x.aperture))
    of_bias = np.sqrt(share[at]) * result.real_time.figures["quadratic_phase"][at]
    level = bias * math.sqrt(2) * math.cos(float(x.grazing_angle))
    expected = float(x.to_phase) * level * float(x.aperture) ** 2 / 8
    assert of_bias == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("sensor", ["gyro", "accelerometer"])
def test_a_bias_that_is_forgotten_in_a_millisecond_acts_as_white_noise(sensor: str) -> None:
    """Of the density of the sensor's own, it makes that noise sqrt(2) times as large."""
    key = {"gyro": "imu.angle_random_walk", "accelerometer": "imu.velocity_random_walk"}[sensor]
    sigma_w = BASES[0][key] * BASES[0].imu.vibration_factor
    sigma = sigma_w / math.sqrt(2 * 1e-3)
    short = {f"{sensor}.bias_instability": sigma, f"{sensor}.correlation_time": 1e-3}
    sizes = []
    for design in (BASES[0].replace(short), BASES[0].replace({key: BASES[0][key] * math.sqrt(2)})):
        study = specification(design, trajectory="straight", duration=300.0, every=100.0)
        sizes.append(covariance(covariance_specification(design, study)).real_time.position[-1])
    np.testing.assert_allclose(*sizes, rtol=1e-3)


def test_the_line_of_sight_in_a_turn_is_that_of_the_middle_of_the_aperture() -> None:
    study = specification(BASES[0], trajectory="turns", duration=200.0)
    spec = covariance_specification(BASES[0], study)
    looks = apertures_of(error_model(spec), spec.inputs, study.gnss.interval)
    middle = looks.begin + 0.5 * float(spec.inputs.aperture)
    velocity = true_states(plan_trajectory(study.trajectory, study.duration), middle).velocity
    np.testing.assert_allclose(looks.sight, directions(velocity, spec.inputs)[0], atol=0.003)
