"""analyse: what goes in comes out of the equations, everywhere."""

import dataclasses
import math

import numpy as np
import pytest
import riccati

from nav_model.base.constants import MEAN_RADIUS
from nav_model.base.errors import InputError
from nav_model.budget import Budget, analyse
from nav_model.budget.inputs import inputs_of
from nav_model.budget.navigation import COAST_POINTS
from nav_model.budget.provenance import cautions
from nav_model.budget.real_time import RealTime
from nav_model.design import Design
from nav_model.design.catalogue import catalogue
from nav_model.design.figures import STEADY
from nav_model.design.file import parse_design

DEGREE = math.pi / 180
BASE = Design(
    {
        "imu.velocity_random_walk": 0.05 / 60,
        "imu.angle_random_walk": 0.5 * DEGREE / 60,
        "gnss.position_noise": 1.0,
        "gnss.interval": 1.0,
        "radar.frequency": 299792458 / 0.03,
        "radar.aperture_time": 5.0,
        "radar.grazing_angle": 0.6,
    }
)


def test_biases_add_in_quadrature():
    t = np.array([0.0, 5.0, 80.0])
    b, d, g = 3e-3, 2e-6, BASE.flight.gravity
    plain = analyse(BASE, t).coast
    biased = analyse(BASE.replace({"imu.accelerometer_bias": b, "imu.gyro_bias": d}), t).coast
    level = (b * t**2 / 2) ** 2 + (g * d * t**3 / 6) ** 2
    upright = (b * t**2 / 2) ** 2
    for name, extra in (
        ("position_horizontal", level),
        ("refined_horizontal", level),
        ("position_vertical", upright),
        ("refined_vertical", upright),
        ("velocity_horizontal", (b * t) ** 2 + (g * d * t**2 / 2) ** 2),
        ("velocity_vertical", (b * t) ** 2),
        ("tilt", (b / g) ** 2 + (d * t) ** 2),
        ("perfect_start_horizontal", 0 * t),
        ("initial_tilt", 0 * t),
        ("yaw_growth", (d * t) ** 2),
    ):
        np.testing.assert_allclose(
            getattr(biased, name) ** 2, getattr(plain, name) ** 2 + extra, rtol=1e-12, err_msg=name
        )


def _numbers(thing, path=""):
    """Every number of a result, by path; designs left out."""
    if isinstance(thing, Design):
        return
    if isinstance(thing, Budget):
        parts = (thing.steady_state, thing.coast, thing.sar, thing.spectral, thing.verdict, thing.other_verdict)
        thing = (dict(thing), *parts, *map(thing.response, ("real time", "post-processed")))
    if dataclasses.is_dataclass(thing):
        for field in dataclasses.fields(thing):
            yield from _numbers(getattr(thing, field.name), f"{path}.{field.name}")
    elif hasattr(thing, "items"):
        for key, value in thing.items():
            yield from _numbers(value, f"{path}.{key}")
    elif isinstance(thing, tuple | list) or np.ndim(thing):
        for i, value in enumerate(thing):
            yield from _numbers(value, f"{path}.{i}")
    elif isinstance(thing, float | int):
        yield path, float(thing)


@pytest.mark.parametrize("slow", [False, True])
def test_vibration_multiplies_both_random_walks_everywhere(slow):
    base = BASE.replace(
        {
            "gnss.correlated": slow, "coast.before_aperture": 3.0, "imu.gyro_bias": 1e-6,
            "requirements.quadratic_phase": 1.0, "requirements.tilt": 0.1, "requirements.confidence": 2.0,
        }
    )  # fmt: skip
    shaken = analyse(base.replace({"imu.vibration_factor": 12.0}))
    direct = analyse(
        base.replace(
            {
                "imu.velocity_random_walk": 12 * base.imu.velocity_random_walk,
                "imu.angle_random_walk": 12 * base.imu.angle_random_walk,
            }
        )
    )
    a, b = dict(_numbers(shaken)), dict(_numbers(direct))
    assert len(a) > 3000
    assert a.keys() == b.keys()
    for path, value in a.items():
        assert value == pytest.approx(b[path], rel=1e-12, abs=1e-300), path
    assert shaken.steady_state.closed["tilt"] > 5 * analyse(base).steady_state.closed["tilt"]


def test_times_are_taken_exactly_and_in_order():
    t = [7.5, 0.0, 1e-3, 7.5, 2000.0]
    coast = analyse(BASE, t).coast
    assert coast.time.tolist() == t
    assert coast.position_horizontal[0] == coast.position_horizontal[3]
    order = np.argsort(t)
    np.testing.assert_allclose(coast.refined_vertical[order], analyse(BASE, np.sort(t)).coast.refined_vertical)
    assert analyse(BASE, 3.0).coast.time.tolist() == [3.0]
    default = analyse(BASE).coast.time
    assert len(default) == COAST_POINTS == 300
    assert (default[0], default[-1]) == (0.0, BASE.coast.duration)


@pytest.mark.parametrize("times", [[-1.0], [math.nan], [math.inf], [[1.0, 2.0]], [1.0, 7201.0]])
def test_other_times_are_refused(times):
    with pytest.raises(InputError, match="times"):
        analyse(BASE, times)


def test_the_end_of_the_coast_does_not_depend_on_the_times():
    assert analyse(BASE, [1.0])["coast_horizontal_position", "real time"].sigma == pytest.approx(
        analyse(BASE).coast.refined_horizontal[-1], rel=1e-12
    )


def test_vertical_noise_touches_the_vertical_only():
    state = analyse(BASE).steady_state
    two = analyse(BASE.replace({"gnss.vertical_position_noise": 2.0})).steady_state
    for moment in ("closed", "prior", "posterior"):
        a, b = getattr(state, moment), getattr(two, moment)
        for name in ("horizontal_position", "tilt"):
            assert b[name] == pytest.approx(a[name], rel=1e-12)
        assert b["vertical_position"] > 1.4 * a["vertical_position"]
    # v11 ~ s^(3/2), but for gravity by height: the sigma goes with the 3/4 power
    assert two.closed["vertical_position"] / state.closed["vertical_position"] == pytest.approx(2**0.75, rel=2e-3)


def test_slow_error_through_the_whole_budget():
    """Prior from SciPy's discrete solver on the augmented system; the aperture starts with what that adds."""
    slow = BASE.replace({"gnss.correlated": True, "gnss.correlated_noise": 1.5, "gnss.correlation_time": 60.0})
    g, decay = BASE.flight.gravity, math.exp(-1 / 60)
    phi, q = (
        np.pad(part, (0, 1)) for part in riccati.van_loan(*riccati.channel(0.05 / 60, 0.5 * DEGREE / 60, g), 1.0)
    )
    phi[3, 3], q[3, 3] = decay, 1.5**2 * (1 - decay**2)
    row, unit = np.array([[1.0, 0, 0, 1]]), np.array([1, 1, g, 1.0])

    def settled(n):
        return riccati.settled(phi[:n, :n], q[:n, :n], row[:, :n], 1.0, unit[:n])

    (prior, posterior), (_, white) = settled(4), settled(3)
    budget = analyse(slow)
    assert budget.steady_state.prior["horizontal_position"] == pytest.approx(math.sqrt(prior[0, 0]), rel=1e-8)
    assert budget.steady_state.prior["tilt"] == pytest.approx(math.sqrt(prior[2, 2]), rel=1e-8)
    line = next(line for line in budget.sight_lines() if line.source == "initial tilt")
    tilt = math.sqrt(budget.steady_state.closed["tilt"] ** 2 + posterior[2, 2] - white[2, 2])
    expected = 4 * math.pi / 0.03 * math.cos(0.6) * g * tilt * 25 / 8
    assert line.quadratic == pytest.approx(expected, rel=1e-8)
    assert budget.steady_state.closed == analyse(BASE).steady_state.closed  # and the page says so
    assert any("slow GNSS error" in sentence for sentence in cautions(budget))
    names = (*STEADY, "coast_horizontal_position", "coast_vertical_position", "along_track_quadratic_phase")
    for shares in (*(budget[name, "real time"].shares for name in names), budget.tilt_shares):
        assert math.fsum(shares.values()) == pytest.approx(1, abs=1e-12)
        assert shares["slow GNSS error"] > 0


def _all_shares(budget):
    yield from (figure.shares for figure in budget.values())
    yield budget.tilt_shares
    for lines in (budget.phase_lines("real time"), budget.sight_lines()):
        yield {line.source: line.share for line in lines}
        yield {line.source: line.detrended_share for line in lines}


@pytest.mark.parametrize("name", [n for n, e in catalogue("imu").items() if "velocity_random_walk" in e.values])
def test_every_catalogue_unit_gives_a_budget_whose_shares_add_up(name):
    design = parse_design(f'[imu]\npreset = "{name}"\ngyro_bias = "1 °/h"\n[coast]\nbefore_aperture = "5 s"')
    budget = analyse(design)
    for shares in _all_shares(budget):
        assert math.fsum(shares.values()) == pytest.approx(1, abs=1e-12)
        assert min(shares.values()) >= 0
    for path, value in _numbers(budget):
        assert math.isfinite(value), path


def test_coast_shares_are_what_each_source_alone_leaves():
    """Take the gyro bias and accelerometer bias away: the variance drops by their shares."""
    full = BASE.replace({"imu.accelerometer_bias": 2e-3, "imu.gyro_bias": 5e-6})

    def end(design):
        return analyse(design).coast.refined_horizontal[-1] ** 2

    budget = analyse(full)
    for key, source in (("imu.accelerometer_bias", "accelerometer bias"), ("imu.gyro_bias", "gyro bias")):
        without = end(full.replace({key: 0.0}))
        assert budget["coast_horizontal_position", "real time"].shares[source] == pytest.approx(
            1 - without / end(full), rel=1e-9
        )


def test_sar_numbers_hang_together():
    budget = analyse(BASE.replace({"radar.aperture_time": None}))
    sar, flight = budget.sar, BASE.flight
    assert sar.wavelength == pytest.approx(0.03, rel=1e-15)
    assert sar.aperture_time == pytest.approx(0.8858929413789045 * 0.03 * 7000 / (2 * 0.5 * flight.speed), rel=1e-13)
    assert sar.aperture_length == pytest.approx(sar.aperture_time * flight.speed, rel=1e-15)
    assert sar.cell_length == pytest.approx(0.5 / 0.8858929413789045, rel=1e-13)
    lines = budget.phase_lines("real time")
    for part in ("quadratic", "cubic", "detrended"):
        whole = budget.figure(f"{part}_phase").sigma
        assert whole == pytest.approx(math.hypot(*(getattr(line, part) for line in lines)), rel=1e-13)
    for line in lines:
        assert line.share == pytest.approx((line.quadratic / budget.figure("quadratic_phase").sigma) ** 2, abs=1e-13)


def test_along_track_takes_the_velocity_over_the_aperture():
    """Nearly that of mid-aperture, closed form with biases, times pi V T²/(lambda R); noise inside counts less."""
    design = BASE.replace({"coast.before_aperture": 20.0, "imu.accelerometer_bias": 1e-3, "imu.gyro_bias": 1e-6})
    model = RealTime(inputs_of(design))
    model.at_last_fix = model.cycle.posterior  # where the outage starts
    start, middle = model.coast_horizontal_velocity(np.array([20.0, 22.5]))
    along = float(model.along_track_quadratic_phase)
    assert along == pytest.approx(math.pi * 100.0 * 25 * middle / (0.03 * 7000), rel=1e-3)
    assert along > 1.09 * math.pi * 100.0 * 25 * start / (0.03 * 7000)


@pytest.mark.parametrize("seconds", [0.0, 10.0, 60.0])
def test_velocity_and_tilt_in_an_outage_start_with_the_slow_error_of_the_fixes(seconds):
    """SciPy's discrete solver on the augmented channel, then its matrix exponential: the LN-100 under SBAS."""
    design = parse_design('[imu]\npreset = "LN-100"\n[gnss]\npreset = "SBAS"\ninterval = "1 s"')
    imu, gnss, g = design.imu, design.gnss, design.flight.gravity
    decay, unit = math.exp(-1 / gnss.correlation_time), np.array([1, 1, g, 1.0])
    oracle = {}
    for fix, slow, size in (
        (gnss.position_noise, gnss.correlated_noise, 3),
        (gnss.vertical_position_noise, gnss.vertical_correlated_noise, 2),
    ):
        axis = [part[:size, :size] for part in riccati.channel(imu.velocity_random_walk, imu.angle_random_walk, g)]
        rising = axis[0] + np.diag([2 * g / MEAN_RADIUS], -1) if size == 2 else axis[0]
        phi, q = (np.pad(part, (0, 1)) for part in riccati.van_loan(rising, axis[1], 1.0))
        phi[size, size], q[size, size] = decay, slow**2 * (1 - decay**2)
        row, scale = np.eye(1, size + 1) + np.eye(1, size + 1, size), unit[[*range(size), 3]]
        start = riccati.settled(phi, q, row, fix**2, scale)[1][:size, :size]
        free, added = riccati.van_loan(rising, axis[1], seconds)
        oracle[size] = np.sqrt(np.diag(free @ start @ free.T + added))
    coast = analyse(design, [seconds]).coast
    assert coast.velocity_horizontal[0] == pytest.approx(oracle[3][1], rel=1e-6)
    assert coast.tilt[0] == pytest.approx(oracle[3][2], rel=1e-6)
    assert coast.velocity_vertical[0] == pytest.approx(oracle[2][1], rel=1e-6)


def test_an_aperture_beyond_an_hour_is_refused_by_key():
    with pytest.raises(InputError) as caught:
        analyse(Design({"radar.azimuth_resolution": 1e-3, "radar.frequency": 1e9, "flight.speed": 10.0}))
    assert caught.value.key == "radar.azimuth_resolution"


@pytest.mark.parametrize("smoothed", [False, True])
def test_values_that_double_precision_cannot_hold_together_are_refused(smoothed):
    """In 120 digits the position just after a fix is 0.1991 m; in double precision 0.1919 m."""
    design = BASE.replace({
        "gnss.position_noise": 1700.0, "gnss.interval": 0.006, "gnss.velocity_noise": 3e-4, "gnss.correlated": True,
        "gnss.correlated_noise": 600.0, "gnss.correlation_time": 4.0,
        "processing.mode": "post-processed" if smoothed else "real time",
    })  # fmt: skip
    with pytest.raises(InputError) as caught:
        analyse(design)
    assert caught.value.key == "gnss.correlated_noise"
    for text in ("600 m is too far from", "gnss.position_noise 1700 m", "gnss.velocity_noise 0.0003 m/s", "closer"):
        assert text in caught.value.reason


def test_autofocus_rescores_the_detrended_phase_only():
    order_1, order_2, order_3 = (analyse(BASE.replace({"radar.autofocus_order": n})) for n in (1, 2, 3))
    quadratic = {budget.figure("quadratic_phase").sigma for budget in (order_1, order_2, order_3)}
    assert len(quadratic) == 1
    first, second, third = (budget.figure("detrended_phase").sigma for budget in (order_1, order_2, order_3))
    assert first > second > third > 0
    assert order_2.response_after_autofocus().peak_loss_db == pytest.approx(0, abs=1e-9)
    assert order_1.response_after_autofocus() == order_1.response("real time")


def test_wide_sawtooth_is_flagged():
    def flagged(design):
        return any("sawtooth" in sentence for sentence in cautions(analyse(design)))

    assert not flagged(BASE)  # 0.23
    assert flagged(BASE.replace({"gnss.position_noise": 0.02}))  # 0.83


@pytest.mark.parametrize(
    ("changes", "due"),
    [
        ({"processing.leg_after": 10.0}, False),
        ({"processing.leg_after": 9.9}, True),
        ({"processing.leg_after": 0.0}, True),
        ({"processing.leg_after": 9.9, "gnss.velocity_noise": 0.05, "gnss.velocity_interval": 2.0}, False),
        ({"processing.leg_after": 9.9, "gnss.velocity_noise": 0.05}, True),  # with each position fix
    ],
)
def test_an_aperture_without_a_fix_after_it_is_flagged(changes, due):
    messages = cautions(analyse(BASE.replace({"gnss.interval": 10.0, **changes})))
    assert any("No fix falls in the time after the aperture" in sentence for sentence in messages) is due


def test_squint_lengthens_the_aperture_and_a_target_behind_the_horizon_is_refused():
    broad, squinted = (analyse(Design({"radar.squint_angle": math.radians(angle)})) for angle in (0, 40))
    assert squinted.sar.aperture_time == pytest.approx(broad.sar.aperture_time / math.cos(math.radians(40)))
    assert squinted.sar.cell_length == pytest.approx(broad.sar.cell_length)
    longer = analyse(Design({"radar.aperture_time": squinted.sar.aperture_time}))
    assert squinted["along_track_quadratic_phase", "real time"].sigma == pytest.approx(
        math.cos(math.radians(40)) ** 2 * longer["along_track_quadratic_phase", "real time"].sigma
    )
    with pytest.raises(InputError, match=r"radar\.squint_angle.*at least -55°"):
        analyse(Design({"radar.squint_angle": math.radians(-56)}))


def test_a_geometry_that_no_ground_allows_is_told() -> None:
    """Seven kilometres at 35 degrees are four kilometres up; over a plain at 1.8 km a flight is as much higher."""

    def warned(**changes: float) -> bool:
        design = BASE.replace({"radar.slant_range": 7000.0, "radar.grazing_angle": math.radians(35)} | changes)
        return any("do not agree" in sentence for sentence in cautions(analyse(design)))

    assert [warned(**{"flight.altitude": height}) for height in (3000.0, 4015.0, 5800.0, 14000.0)] == [
        True, False, False, True,
    ]  # fmt: skip
