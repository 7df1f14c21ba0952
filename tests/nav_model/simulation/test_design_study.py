"""Design -> SimulationSpec, and a study beside the closed forms of its design."""

import json
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
import riccati
from entered import entered

from nav_model.base.constants import MEAN_RADIUS
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.simulation.conditions import conditions
from nav_model.simulation.design_study import (
    LONGEST_OUTAGE,
    closed_form,
    conclude,
    specification,
    study_of,
    to_document,
)
from nav_model.simulation.monte_carlo import run_chunk, simulate
from nav_model.simulation.single_run import POSTERIOR, fly_without_errors
from nav_model.simulation.specification import TrajectorySpec
from nav_model.simulation.statistics import Statistics

DPH = math.radians(1) / 3600
PAPER = Design({"flight.speed": 50.0})  # 0.05 m/s/√h, 0.5 °/√h, 1 m at 1 Hz are the defaults


def test_every_input_reaches_its_place() -> None:
    design = Design(
        {
            "imu.velocity_random_walk": 0.06 / 60,
            "imu.angle_random_walk": math.radians(0.2) / 60,
            "imu.accelerometer_bias": 2e-3,
            "imu.gyro_bias": 3 * DPH,
            "imu.vibration_factor": 4.0,
            "imu.rate": 200.0,
            "gnss.position_noise": 0.5,
            "gnss.vertical_position_noise": 0.8,
            "gnss.interval": 0.2,
            "gnss.correlated": True,
            "gnss.correlated_noise": 1.5,
            "gnss.correlation_time": 77.0,
            "flight.speed": 90.0,
            "flight.altitude": 4000.0,
            "flight.latitude": -0.6,
            "flight.heading": 1.2,
            "filter.states": 15,
        }
    )
    spec = specification(design, trajectory="climb", runs=7, seed=9, duration=250, outages=[(100, 150)], every=2)
    assert spec.imu.gyro.random_walk == math.radians(0.2) / 60
    assert (spec.imu.gyro.residual_bias, spec.imu.gyro.turn_on_bias) == (3 * DPH, 0.0)
    assert spec.imu.accelerometer.random_walk == 0.06 / 60
    assert (spec.imu.accelerometer.residual_bias, spec.imu.accelerometer.turn_on_bias) == (2e-3, 0.0)
    assert (spec.imu.rate, spec.imu.vibration_factor) == (200.0, 4.0)
    assert spec.gnss.axis_noise == (0.5, 0.5, 0.8)
    assert (spec.gnss.interval, spec.gnss.markov_time) == (0.2, 77.0)
    assert (spec.gnss.markov_noise, spec.gnss.vertical_markov_noise) == (1.5, pytest.approx(1.5 * 0.8 / 0.5))
    flight = spec.trajectory
    assert (flight.kind, flight.speed, flight.height) == ("climb", 90.0, 4000.0)
    assert (flight.latitude, flight.heading) == (-0.6, 1.2)
    assert (spec.filter.states, spec.runs, spec.seed, spec.duration) == (15, 7, 9, 250)
    assert (spec.outages, spec.every) == (((100.0, 150.0),), 2)
    off = specification(design.replace({"gnss.correlated": False}))
    assert (off.gnss.markov_noise, off.gnss.vertical_markov_noise) == (0.0, 0.0)


def test_runs_start_at_the_steady_state_of_the_theory_page() -> None:
    start = specification(PAPER).initial
    assert start.position == pytest.approx(0.474565, abs=5e-7)
    assert start.velocity == pytest.approx(0.0654609, abs=5e-8)
    assert math.degrees(start.tilt) == pytest.approx(0.0351388, abs=5e-8)


def test_the_closed_form_gives_the_theory_pages_figures() -> None:
    coast = np.array([0.0, 10.0, 20.0, 50.0, 100.0])
    elapsed = 400.0 + coast
    spec = specification(PAPER)
    compare = pickle.loads(pickle.dumps(closed_form(PAPER, spec)))
    sigmas = compare(coast, elapsed)
    assert sigmas.shape == (5, 9)
    # [T-3] and [T-4], printed in theory.md section 2; in an outage SciPy's, from just after a fix.
    f, q = riccati.channel(0.05 / 60, math.radians(0.5) / 60, 9.80665)
    for size, column, settled in ((3, 0, 0.474565), (2, 2, 0.202052)):
        axis = f[:size, :size], q[:size, :size]
        rising = axis[0] + np.diag([2 * 9.80665 / MEAN_RADIUS], -1) if size == 2 else axis[0]  # while fixes come
        start = riccati.settled(*riccati.van_loan(rising, axis[1], 1.0), np.eye(1, size), 1.0)[1]
        steps = [riccati.van_loan(*axis, seconds) for seconds in coast[1:]]
        drifting = [math.sqrt((phi @ start @ phi.T + added)[0, 0]) for phi, added in steps]
        assert sigmas[0, column] == pytest.approx(settled, rel=1.5e-3 if size == 2 else 2e-6)
        assert sigmas[1:, column] == pytest.approx(drifting, rel=1e-7)
    assert np.array_equal(sigmas[:, 0], sigmas[:, 1])
    assert sigmas[0, 3:5] == pytest.approx([0.0654609] * 2, abs=5e-8)
    assert sigmas[0, 5] == pytest.approx(0.00583273, rel=1.5e-3)  # gravity by height takes 0.1 %
    assert np.degrees(sigmas[0, 6:8]) == pytest.approx([0.0351388] * 2, abs=5e-8)
    # [T-5]: an ARW of 0.5 °/√h over 400 s, on 0.1° at the start.
    assert math.degrees(sigmas[0, 8]) == pytest.approx(math.hypot(0.1, 0.5 * math.sqrt(400 / 3600)), rel=1e-12)
    louder = closed_form(PAPER.replace({"imu.vibration_factor": 3.0}), spec)(coast, elapsed)
    assert math.degrees(louder[0, 8]) == pytest.approx(math.hypot(0.1, 1.5 * math.sqrt(400 / 3600)), rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "options", "key"),
    [
        ({"imu.rate": 5.0}, {}, "imu.rate"),
        ({"imu.rate": 10.0, "gnss.interval": 0.05}, {}, "gnss.interval"),
        ({"flight.latitude": math.radians(89)}, {}, "flight.latitude"),
        ({"flight.speed": 5000.0}, {}, "flight.speed"),
        ({"flight.speed": 3.0}, {"trajectory": "climb"}, "flight.speed"),
        ({}, {"trajectory": "loop"}, "trajectory"),
        ({}, {"runs": 0}, "runs"),
        ({}, {"seed": -1}, "seed"),
        ({}, {"duration": -1.0}, "duration"),
        ({}, {"duration": math.nan}, "duration"),
        ({}, {"every": 0.001}, "every"),
        ({}, {"every": 1e4}, "every"),
        ({}, {"outages": [(5, 2)]}, "outage"),
        ({}, {"outages": [(1, 20), (10, 30)]}, "outage"),
        ({}, {"outages": [(0, LONGEST_OUTAGE + 1)], "duration": 9000}, "outage"),
        ({"filter.states": 12}, {}, "filter.states"),
    ],
)
def test_what_cannot_be_flown_is_refused_under_its_own_name(changes, options, key) -> None:
    with pytest.raises(InputError) as caught:
        specification(PAPER.replace(changes), **options)
    assert caught.value.key == key
    assert "\n" not in str(caught.value)


def test_a_refusal_speaks_in_the_designs_units() -> None:
    with pytest.raises(InputError, match=r"flight\.latitude: 89° cannot be simulated; must be within 85 deg"):
        specification(PAPER.replace({"flight.latitude": math.radians(89)}))


@pytest.fixture(scope="module")
def study():
    spec = specification(PAPER, runs=40, duration=180.0, outages=[(120, 180)], every=2.0)
    return study_of(PAPER, simulate(spec, closed_form=closed_form(PAPER, spec)))


def test_the_filter_follows_the_refined_curve_in_the_outage(study, compared) -> None:
    result = study.result
    coasting = result.coast_s > 0
    assert coasting.sum() == 30
    assert np.isnan(study.refined_sigma[~coasting]).all()
    # Covariance against covariance, no sampling noise; the start is settled to 1 % of the posterior [T-8], [T-17].
    ratio = result.nominal_sigma[POSTERIOR, coasting, :3] / study.refined_sigma[coasting]
    compared(
        "Refined outage to 60 s",
        "T-17",
        "our own derivation",
        "filter covariance of our own simulator",
        ratio - 1,
        0.02,
    )
    assert result.consistent, result.verdict


def test_the_path_is_the_flight_that_was_asked_for() -> None:
    for heading in (0.0, 2.0):
        design = PAPER.replace({"flight.heading": heading})
        spec = specification(design, runs=1, duration=100.0, trajectory="straight")
        path = study_of(design, simulate(spec, closed_form=closed_form(design, spec))).path
        assert path[:, 0] == pytest.approx(50.0 * np.arange(101.0), rel=1e-6, abs=1e-6)
        assert path[:, 1:] == pytest.approx(np.zeros((101, 2)), abs=1e-4)


def test_a_worker_concludes_the_same_study(study) -> None:
    spec = study.result.spec
    nominal = fly_without_errors(spec)
    total = Statistics.empty(nominal.filter_sigma[POSTERIOR])
    total.merge(run_chunk(spec, total.scale, 0, 25))
    total.merge(run_chunk(spec, total.scale, 25, 40))
    arguments = pickle.loads(pickle.dumps((study.design, spec, total, nominal, 1.0)))
    result = pickle.loads(pickle.dumps(conclude(*arguments)))
    assert result.result.rms == pytest.approx(study.result.rms, rel=1e-12)
    assert [d.reason for d in result.departures] == [d.reason for d in study.departures]
    assert [d.ratio for d in result.departures] == pytest.approx([d.ratio for d in study.departures], rel=1e-12)
    assert result.conditions == study.conditions


def test_the_document_has_the_contracts_keys_and_no_nan(study) -> None:
    document = json.loads(json.dumps(to_document(study), allow_nan=False))
    assert {"runs", "time_s", "departures", "conditions", "added", "design"} <= document.keys()
    refined = document["position"]["north"]["refined_sigma_m"]
    assert refined[60] is None
    assert refined[61] > 0


def test_conditions_say_what_differs() -> None:
    def words(**changes: float | bool) -> str:
        given = {key.replace("__", "."): value for key, value in changes.items()}
        design = PAPER.replace({**given, "filter.states": 9})
        return " ".join(conditions(design, specification(design)))

    plain = words()
    # Normal gravity at 45° and 3 km: 9.80620 - 3.0855e-6 x 3000 m/s², by the usual free-air gradient.
    assert float(plain.split("gravity, ")[1].split()[0]) == pytest.approx(9.80620 - 3.0855e-6 * 3000, abs=2e-5)
    assert "9.80665" in plain
    assert "bias" not in plain
    assert "slow" not in plain
    assert "act from the last fix on while no fix comes" in words(imu__gyro_bias=DPH)
    assert "slow GNSS error" in words(gnss__correlated=True)
    assert "No run" not in plain
    noise = tuple((at, 1e-9 / at, "phase noise") for at in (1.0, 9.0))
    shaken = words(motion__lines=((20.0, 1.0, "acceleration"),), oscillator__phase_noise=noise)
    assert "The runs leave out the design's vibration, oscillator;" in shaken
    spec = specification(PAPER)
    filed = replace(spec, trajectory=TrajectorySpec(kind="file", samples=b"x"))
    assert "The flight comes from the file" in conditions(PAPER, filed)[0]


def test_the_filter_knows_the_biases_of_the_study_unless_told_otherwise() -> None:
    def states(given: int = 0, **texts: str) -> int:
        biased = PAPER.replace({"imu.accelerometer_bias": 1e-3, "filter.states": given})
        return specification(
            entered(biased, {key.replace("__", "."): text for key, text in texts.items()})
        ).filter.states

    walking = {"gyro__bias_instability": "1 °/h"}
    assert states() == 9  # what is left over at the last fix has no state
    assert states(accelerometer__turn_on_bias="1 mg") == 15
    assert states(**walking) == 15
    assert states(**walking, accelerometer__turn_on_bias="1 mg") == 15  # one kind of each sensor
    assert states(**walking, gyro__turn_on_bias="1 °/h") == 21
    assert states(9, **walking) == 9


def test_a_residual_bias_acts_from_the_last_fix_of_an_outage_on() -> None:
    """b t²/2 and b t, g d t³/6, g d t²/2 and d t beside 1 cm fixes and an IMU that is all but perfect; the filter
    expects it, and knows the place again two fixes later."""
    b, d, t = 5e-3, 20 * DPH, 60.0
    design = PAPER.replace(
        {
            "imu.velocity_random_walk": 1e-6,
            "imu.angle_random_walk": 1e-8,
            "imu.accelerometer_bias": b,
            "imu.gyro_bias": d,
            "gnss.position_noise": 0.01,
        }
    )
    spec = specification(design, trajectory="straight", duration=170.0, outages=[(100, 160)], runs=200)
    g, filter_sigma = design.flight.gravity, fly_without_errors(spec).filter_sigma[POSTERIOR]
    assert filter_sigma[100, :3] == pytest.approx(0.0, abs=0.01)
    result = simulate(spec)
    for sigmas, bound in ((filter_sigma, 0.01), (result.rms[POSTERIOR], 4 / math.sqrt(2 * 200))):
        place, speed = (math.hypot(b * t**2 / 2, g * d * t**3 / 6), math.hypot(b * t, g * d * t**2 / 2))
        expected = [place, place, b * t**2 / 2, speed, speed, b * t, d * t, d * t]
        assert sigmas[160, :8] == pytest.approx(expected, rel=bound)
        assert sigmas[163, :3] == pytest.approx(0.0, abs=0.05)


def test_vibration_acts_in_runs_by_the_bias_that_it_makes() -> None:
    shaken = {"motion.lines": ((20.0, 9.81, "acceleration"),), "motion.rectification": 1e-5}
    bias = specification(PAPER.replace(shaken)).imu.accelerometer.residual_bias
    assert bias == pytest.approx(1e-5 * 9.81**2 / 2, rel=1e-9)
