"""A receiver's noise from drawn fixes of known noise."""

import numpy as np
import pytest

from nav_model.design.file import parse_design
from nav_model.flown.noise_fit import adopt_receiver, receiver_of
from nav_model.flown.relation import Compared, Fitted

DESIGN = parse_design("gnss.position_noise = '1 m'")


def drawn(count, white, slow, time, step=1.0, seed=0):
    """Fixes less truth: white noise and a Gauss-Markov process on each axis."""
    rng, phi = np.random.default_rng(seed), np.exp(-step / time)
    markov = np.zeros((count, 3))
    markov[0] = slow * rng.standard_normal(3)
    for n in range(1, count):
        markov[n] = phi * markov[n - 1] + slow * np.sqrt(1 - phi**2) * rng.standard_normal(3)
    position = markov + white * rng.standard_normal((count, 3))
    velocity = 0.05 * rng.standard_normal((count, 3))
    nothing = (Fitted(0.0, 1.0),) * 3
    at = step * np.arange(count)
    return Compared(at, position, velocity, None, velocity, nothing[0], None, nothing, 0.0, "", ())


def test_intervals_contain_what_was_drawn() -> None:
    inside = {"white": 0, "slow": 0, "time": 0}
    for seed in range(20):
        fitted = receiver_of(DESIGN, drawn(3000, 0.3, 0.8, 60.0, seed=seed))["horizontal"]
        for name, true in (("white", 0.3), ("slow", 0.8), ("time", 60.0)):
            inside[name] += fitted[name]["low_95"] < true < fitted[name]["high_95"]
    assert all(count >= 16 for count in inside.values()), inside  # 95 % of 20: fewer than 16 once in 10,000


def test_white_noise_has_no_slow_part() -> None:
    fitted = receiver_of(DESIGN, drawn(1500, 0.4, 0.0, 10.0))
    assert fitted["horizontal"]["slow"] is None
    assert fitted["horizontal"]["white"]["value"] == pytest.approx(0.4, rel=0.05)
    assert fitted["velocity"]["value"] == pytest.approx(0.05, rel=0.05)
    assert fitted["seen_m"][0] == pytest.approx(0.4, rel=0.05)


def test_a_short_log_tells_no_slow_error() -> None:
    fitted = receiver_of(DESIGN, drawn(400, 0.2, 1.0, 100.0, seed=3))
    assert fitted["horizontal"]["slow"] is None
    assert "correlation times" in fitted["reason"]
    assert "needs 200" in receiver_of(DESIGN, drawn(50, 0.2, 1.0, 100.0))["reason"]


def test_one_press_takes_the_noise_with_its_origin() -> None:
    adoption = adopt_receiver(receiver_of(DESIGN, drawn(3000, 0.3, 0.8, 60.0)), "flight 7.pos")
    design = DESIGN.replace(adoption.changes, written=adoption.written, origins=adoption.origins)
    assert design.gnss.position_noise == pytest.approx(0.3, rel=0.1)
    assert design.gnss.correlated
    assert "from the fixes of flight 7.pos" in adoption.origins["gnss.correlated_noise"]


def test_fixes_that_are_those_of_the_reference_tell_nothing() -> None:
    receiver = receiver_of(DESIGN, drawn(400, 0.0, 0.0, 10.0))
    assert receiver["horizontal"]["white"] is None
    assert "horizontal: the two are the same" in receiver["reason"]
