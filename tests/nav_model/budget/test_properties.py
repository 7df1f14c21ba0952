"""What must hold for any design: a smoother is no worse than the filter it starts from, and no error helps."""

import math
from dataclasses import replace

import numpy as np
import pytest

from nav_model.budget.figures import figures
from nav_model.budget.inputs import inputs_of
from nav_model.budget.real_time import RealTime
from nav_model.design import Design
from nav_model.design.figures import FIGURES, REQUIRED, STEADY
from nav_model.design.processing import POST_PROCESSED, REAL_TIME

SMOOTHED = [name for name in REQUIRED if FIGURES[name].smoothed_mark]


def between(rng, low, high):
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def random_values(rng):
    values = {
        "imu.velocity_random_walk": between(rng, 0.003, 0.3) / 60,
        "imu.angle_random_walk": math.radians(between(rng, 0.001, 1)) / 60,
        "imu.accelerometer_bias": 1e-4, "imu.gyro_bias": 1e-6, "gnss.position_noise": between(rng, 0.01, 5),
        "gnss.interval": between(rng, 0.05, 60), "gnss.vertical_position_noise": between(rng, 0.01, 8),
        "radar.aperture_time": between(rng, 0.3, 40), "radar.slant_range": between(rng, 1e3, 3e4),
        "flight.speed": between(rng, 20, 300), "radar.autofocus_order": int(rng.integers(1, 4)),
        "processing.leg_after": float(rng.choice([0, 1]) * between(rng, 1, 300)),
        "requirements.steady_state": str(rng.choice(["prior", "closed", "posterior"])),
    }  # fmt: skip
    if rng.random() < 0.5:
        values["gnss.velocity_noise"] = between(rng, 0.005, 0.5)
        if rng.random() < 0.6:
            values["gnss.velocity_interval"] = values["gnss.interval"] * float(rng.choice([0.25, 0.5, 1, 2, 5]))
    if rng.random() < 0.4:
        size = values["gnss.position_noise"] * between(rng, 0.1, 10)
        values |= {"gnss.correlated": True, "gnss.correlated_noise": size}
        values["gnss.vertical_correlated_noise"] = size * between(rng, 0.3, 3)  # else by the noise
        values["gnss.correlation_time"] = between(rng, 0.5, 2000)
    if rng.random() < 0.3:
        values["coast.before_aperture"] = between(rng, 0.1, 60)
    return values


@pytest.mark.long
def test_post_processed_is_never_worse_than_real_time():
    """300 designs, but for what real time leaves out and says: that velocity fixes are rarer than those of position
    and, in steady state, fixes missing before the aperture.
    """
    rng, count = np.random.default_rng(1), 0
    while count < 300:
        values = random_values(rng)
        if values.get("gnss.velocity_interval", 0) > values["gnss.interval"]:
            continue
        count += 1
        x = replace(inputs_of(Design(values)), steady_state="prior")
        names = [name for name in SMOOTHED if name not in STEADY or "coast.before_aperture" not in values]
        now, later = (figures(replace(x, processing=mode), names) for mode in (REAL_TIME, POST_PROCESSED))
        for name in names:
            assert later[name] <= 1.02 * now[name], (name, values)


VIBRATION = tuple((at, size, "acceleration density") for at, size in ((5.0, 0.1), (20.0, 4.0), (2e3, 0.1)))
NOISE = ((0.1, 1e-6, "phase noise"), (10.0, 1e-10, "phase noise"))
GROWING = (
    "imu.velocity_random_walk", "imu.angle_random_walk", "imu.accelerometer_bias", "imu.gyro_bias",
    "imu.vibration_factor", "gnss.position_noise", "gnss.vertical_position_noise", "gnss.velocity_noise",
    "gnss.correlated_noise", "gnss.vertical_correlated_noise",
)  # fmt: skip


def more_errors(rng, design):
    """One design for each source of error that is added, or that becomes larger."""
    for key in GROWING:
        if design[key] and ("correlated_noise" not in key or design.gnss.correlated):
            yield key, {key: design[key] * between(rng, 1.001, 3)}
    if not design.gnss.correlated:
        yield "a slow error", {
            "gnss.correlated": True, "gnss.correlated_noise": between(rng, 1e-6, 3),
            "gnss.correlation_time": between(rng, 0.5, 2000),
        }  # fmt: skip
    yield "terrain", {"processing.scene_height_error": 3.0}
    yield "vibration", {"motion.spectrum": VIBRATION, "motion.delay": 1e-3}
    yield "rectification", {"motion.spectrum": VIBRATION, "motion.rectification": 1e-5}
    yield "a line", {"motion.unsensed_lines": ((12.0, 1e-4, "length"),)}
    yield "an oscillator", {"oscillator.phase_noise": NOISE}


@pytest.mark.long
@pytest.mark.parametrize("processing", [REAL_TIME, POST_PROCESSED])
def test_no_added_error_makes_a_figure_smaller(processing):
    """To 1e-4, by which the closed form and the filter that is sampled may differ in what a slow error adds."""
    rng = np.random.default_rng(2)
    for _ in range(25):
        design = Design(random_values(rng))
        before = figures(replace(inputs_of(design), processing=processing))
        for source, changes in more_errors(rng, design):
            after = figures(replace(inputs_of(design.replace(changes)), processing=processing))
            for name, figure in before.items():
                assert after[name] >= figure * (1 - 1e-4), (source, name, design.content_hash, changes)


@pytest.mark.long
def test_no_outage_improves_a_velocity_or_a_tilt():
    """From the error before a fix on, which an outage as long as the interval has reached, none becomes smaller."""
    rng = np.random.default_rng(3)
    for _ in range(200):
        design = Design(random_values(rng))
        x = replace(inputs_of(design), steady_state="prior")
        model, seconds = RealTime(x), float(x.interval) * np.geomspace(1.0, 1000.0, 30)
        for name in ("horizontal_velocity", "vertical_velocity", "tilt"):
            curve = np.append(model.value(name), model.value(f"coast_{name}", seconds))
            assert np.all(np.diff(curve) > -1e-9 * curve[0]), (name, design.content_hash)


@pytest.mark.parametrize("position", [0.02, 1.0])
def test_a_micrometre_of_slow_error_changes_nothing(position):
    """White noise and slow error start the aperture from the same covariance."""
    design = Design({"gnss.interval": 5.0, "gnss.position_noise": position})
    slow = {"gnss.correlated": True, "gnss.correlated_noise": 1e-6, "gnss.correlation_time": 60.0}
    for processing in (REAL_TIME, POST_PROCESSED):
        without, with_it = (
            figures(replace(inputs_of(variant), processing=processing)) for variant in (design, design.replace(slow))
        )
        for name, figure in without.items():
            assert float(with_it[name]) == pytest.approx(float(figure), rel=1e-6), name
