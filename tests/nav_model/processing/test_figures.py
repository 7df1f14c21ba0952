"""Post-processed figures of whole designs: printed check values, shares, arrays, real time with velocity."""

import math
from operator import attrgetter, methodcaller

import numpy as np
import pytest
import riccati

from nav_model.analytic.discrete import SlowError, cycle
from nav_model.analytic.steady_state import horizontal, vertical
from nav_model.budget import analyse
from nav_model.budget.inputs import inputs_of
from nav_model.budget.json import to_json
from nav_model.budget.smoothed import Smoothed
from nav_model.design.figures import FIGURES, OF_BUDGET, STEADY

# docs/processing.md, check values: quadratic, cubic, residual after orders 1 and 2, along-track quadratic [°], slope
# of the line of sight [mm/s], azimuth shift [m], position horizontal and vertical [m], velocity [mm/s], tilt [°].
SMOOTHED = (
    *(name for name, figure in FIGURES.items() if figure.smoothed_mark and figure.kind != "response"),
    "slope_shift",
)  # fmt: skip


def smoothed_figures(x):
    model = Smoothed(x)
    return {name: getattr(model, name) for name in SMOOTHED}


PRINTED = {
    "A": (70.63, 33.24, 21.94, 6.143, 18.29, 7.254, 0.5642, 0.1591, 0.1057, 8.660, 0.005325),
    "B": (59.56, 32.99, 18.78, 6.112, 11.31, 4.651, 0.3617, 0.1121, 0.09468, 5.425, 0.004363),
    "C": (11.65, 8.479, 3.822, 1.595, 0.6097, 0.6480, 0.05040, 0.003027, 0.003965, 0.7450, 0.001496),
}


@pytest.fixture(scope="module")
def named(open_design, closed_design):
    return {"A": open_design, "B": open_design.replace({"gnss.velocity_noise": 0.03}), "C": closed_design}


def found_in(budget):
    flight = budget.design.flight
    post = {name: budget[name, "post-processed"].sigma for name in OF_BUDGET}
    lever, shift = budget.design.radar.slant_range / flight.speed, budget.beside(attrgetter("slope_shift"))
    return (
        *map(math.degrees, (post["line_of_sight_quadratic_phase"], post["line_of_sight_cubic_phase"],
                            *(budget.beside(methodcaller("sight_detrended", order)) for order in (1, 2)),
                            post["along_track_quadratic_phase"])),
        shift / lever * 1e3, shift,
        post["horizontal_position"], post["vertical_position"], post["horizontal_velocity"] * 1e3,
        math.degrees(post["tilt"]),
    )  # fmt: skip


@pytest.mark.parametrize("name", PRINTED)
def test_printed_check_values(named, name):
    budget = analyse(named[name])
    for ours, printed in zip(found_in(budget), PRINTED[name], strict=True):
        assert ours == pytest.approx(printed, rel=1e-3)


@pytest.mark.parametrize(
    ("sigma", "time", "quadratic", "residual", "position"),
    [(0.3, 300.0, 71.34, 22.14, 0.335), (1.0, 60.0, 85.46, 26.21, None)],
)
def test_slow_gnss_error(named, sigma, time, quadratic, residual, position):
    slow = {"gnss.correlated": True, "gnss.correlated_noise": sigma, "gnss.correlation_time": time}
    budget = analyse(named["A"].replace(slow | {"processing.leg_after": 3000.0}))
    assert math.degrees(budget["line_of_sight_quadratic_phase", "post-processed"].sigma) == pytest.approx(
        quadratic, rel=1e-3
    )
    assert math.degrees(budget["line_of_sight_detrended_phase", "post-processed"].sigma) == pytest.approx(
        residual, rel=1e-3
    )
    if position:
        assert budget["horizontal_position", "post-processed"].sigma == pytest.approx(position, abs=5e-4)


@pytest.mark.parametrize(
    ("after", "quadratic", "residual"),
    [(0, 147.5, 44.4), (5, 132.3, 39.9), (10, 116.6, 35.3), (20, 89.6, 27.4), (30, 75.2, 23.3), (50, 71.5, 22.2),
     (80, 70.70, 21.96)],
)  # fmt: skip
def test_how_long_one_waits(named, after, quadratic, residual):
    budget = analyse(named["A"].replace({"processing.leg_after": float(after)}))
    assert math.degrees(budget["line_of_sight_quadratic_phase", "post-processed"].sigma) == pytest.approx(
        quadratic, rel=2e-3
    )
    assert math.degrees(budget["line_of_sight_detrended_phase", "post-processed"].sigma) == pytest.approx(
        residual, rel=3e-3
    )


def test_shares_add_up_and_are_what_each_source_leaves(named):
    budget = analyse(named["B"])
    for figure in budget.values():
        assert math.fsum(figure.shares.values()) == pytest.approx(1, abs=1e-9)
    # [P-4] written out: a drift source contributes (1 - H)² S_p, a receiver source H² S_n
    x = inputs_of(named["B"])
    w = np.geomspace(1e-5, 1e4, 400001)
    bessel = (3 / (w * x.aperture / 2) ** 3 - 1 / (w * x.aperture / 2)) * np.sin(w * x.aperture / 2) - 3 / (
        w * x.aperture / 2
    ) ** 2 * np.cos(w * x.aperture / 2)
    weight = np.where(w * x.aperture / 2 < 0.05, (w * x.aperture / 2) ** 2 / 15, bessel) ** 2
    parts = dict.fromkeys(("accelerometer noise", "gyro noise", "GNSS noise", "GNSS velocity noise"), 0.0)
    wide, high = math.cos(x.grazing_angle) ** 2, math.sin(x.grazing_angle) ** 2
    for gyro, share in ((float(x.g * x.sigma_w), wide), (0.0, high)):
        a, b = float(x.sigma_a) ** 2 / w**4, gyro**2 / w**6
        p, v = float(x.fix) ** 2 * float(x.interval), (0.03**2 * float(x.interval)) / w**2
        receiver = 1 / (1 / p + 1 / v)
        h = (a + b) / (a + b + receiver)
        for name, density in (
            ("accelerometer noise", (1 - h) ** 2 * a), ("gyro noise", (1 - h) ** 2 * b),
            ("GNSS noise", h**2 * receiver**2 / p), ("GNSS velocity noise", h**2 * receiver**2 / v),
        ):  # fmt: skip
            parts[name] += share * np.trapezoid(density * weight, w)
    whole = sum(parts.values())
    for name, part in parts.items():
        assert budget["line_of_sight_quadratic_phase", "post-processed"].shares[name] == pytest.approx(
            part / whole, abs=2e-4
        )


def test_real_time_with_velocity_printed(named):
    budget = analyse(named["B"])
    steady = budget.steady_state
    for ours, (position, velocity, tilt) in (
        (steady.closed, (0.17312, 0.01236, 0.008651)),
        (steady.prior, (0.17573, 0.01292, 0.008834)),
        (steady.posterior, (0.17075, 0.01184, 0.008473)),
    ):
        assert ours["horizontal_position"] == pytest.approx(position, abs=6e-6)
        assert ours["horizontal_velocity"] == pytest.approx(velocity, abs=6e-6)
        assert math.degrees(ours["tilt"]) == pytest.approx(tilt, abs=6e-7)
    assert math.degrees(budget["line_of_sight_quadratic_phase", "real time"].sigma) == pytest.approx(
        117.81, abs=0.005
    )
    names = (*STEADY, "coast_horizontal_position", "coast_vertical_position", "along_track_quadratic_phase")
    for shares in (budget[name, "real time"].shares for name in names):
        assert math.fsum(shares.values()) == pytest.approx(1, abs=1e-9)
        assert shares["GNSS velocity noise"] > 0.001


def test_continuous_riccati_with_velocity(fleet, compared):
    """Closed form against the equation itself: what is left of F P + P F' + Q - P H' R⁻¹ H P, beside its terms."""
    rng = np.random.default_rng(5)
    s_v = fleet.s * np.exp(rng.uniform(math.log(1e-3), math.log(10), fleet.size))
    p = horizontal(fleet.sigma_a, fleet.sigma_w, fleet.s, fleet.g, s_v).matrix()
    f = np.zeros_like(p)
    f[:, 0, 1], f[:, 1, 2] = 1, fleet.g
    noise = np.zeros_like(p)
    noise[:, 1, 1], noise[:, 2, 2] = fleet.sigma_a**2, fleet.sigma_w**2
    known = np.zeros_like(p)
    known[:, 0, 0], known[:, 1, 1] = 1 / fleet.s**2, 1 / s_v**2
    grows, learnt = f @ p, p @ known @ p
    residual = grows + np.swapaxes(grows, 1, 2) + noise - learnt
    compared("Steady state with velocity fixes", "P-6", "our own derivation", "the Riccati equation, put back",
             residual / (np.abs(grows) + np.abs(np.swapaxes(grows, 1, 2)) + noise + np.abs(learnt)), 1e-9,
             "largest residual over the terms")  # fmt: skip
    assert np.all(np.linalg.eigvalsh(p) > -1e-15)
    upright = vertical(fleet.sigma_a, fleet.s, s_v)
    np.testing.assert_allclose(2 * upright.v12, upright.v11**2 / fleet.s**2 + upright.v12**2 / s_v**2, rtol=1e-10)
    np.testing.assert_allclose(fleet.sigma_a**2, upright.v12**2 / fleet.s**2 + upright.v22**2 / s_v**2, rtol=1e-10)


@pytest.mark.parametrize("slow", [None, (0.7, 40.0)])
def test_sampled_filter_with_velocity(slow, compared):
    rng = np.random.default_rng(3)
    g, worst = 9.80665, 0.0
    for _ in range(40):
        a, w, h, r, v = (
            math.exp(rng.uniform(math.log(low), math.log(high)))
            for low, high in ((1e-4, 5e-3), (1e-6, 3e-4), (0.05, 5), (0.02, 3), (0.01, 0.5))
        )
        phi, q = riccati.van_loan(*riccati.channel(a, w, g), h)
        seen = np.array([[1.0, 0, 0], [0, 1, 0]])
        if slow:
            decay = math.exp(-h / slow[1])
            phi, q = (np.pad(m, ((0, 1), (0, 1))) for m in (phi, q))
            phi[3, 3], q[3, 3] = decay, slow[0] ** 2 * (1 - decay**2)
            seen = np.array([[1.0, 0, 0, 1], [0, 1, 0, 0]])
        unit = np.array([1, h, g * h * h, 1.0])[: len(q)]
        prior, posterior = riccati.settled(phi, q, seen, np.diag([r * r, v * v]), unit)
        error = None if slow is None else SlowError(*map(np.array, (slow[0], *slow)))
        ours = cycle(a, w, g, h, r, r, error, (v, v))
        for end, theirs in ((ours.prior, prior), (ours.posterior, posterior)):
            p = end.horizontal
            off = [float(p.p11) / theirs[0, 0], float(p.p22) / theirs[1, 1], float(p.p33) / theirs[2, 2]]
            worst = max(worst, *(abs(ratio - 1) for ratio in off))
    word = "with" if slow else "without"
    compared(f"Sampled filter with velocity fixes, {word} slow GNSS error", "T-8", "solver written by others",
             "SciPy's solve_discrete_are", worst, 1e-6)  # fmt: skip


@pytest.mark.parametrize("across", [True, False])
@pytest.mark.parametrize("velocity_interval", [None, 0.4])
@pytest.mark.parametrize("aperture", ["radar.aperture_time", "radar.slant_range"])
def test_arrays_are_designs_side_by_side(named, aperture, velocity_interval, across):
    """Maps over noises of one channel or of both, apertures, and times of waiting."""
    design = named["B"].replace({"gnss.velocity_interval": velocity_interval, "coast.before_aperture": 3.0})
    spans = np.array([1.0, 3.0, 9.0]) * (1.0 if aperture == "radar.aperture_time" else 2000.0)
    columns = {aperture: spans, "imu.angle_random_walk": np.array([1e-6, 1e-5, 1e-4])}
    rows = {
        "gnss.position_noise": np.array([0.01, 0.1, 1.0, 3.0]), "gnss.vertical_position_noise": np.full(4, 2.0),
        "processing.leg_after": np.array([300.0, 60.0, 5.0, 0.0]),
        "coast.before_aperture": np.array([0.0, 1.0, 4.5, 0.3]),
    }  # fmt: skip
    shape = [(1, -1), (-1, 1)]
    changes = {key: value.reshape(shape[not across]) for key, value in columns.items()}
    grid = smoothed_figures(
        inputs_of(design, changes | {key: value.reshape(shape[across]) for key, value in rows.items()})
    )
    for i in range(3):
        for j in range(4):
            values = {key: float(value[i]) for key, value in columns.items()}
            values |= {key: float(value[j]) for key, value in rows.items()}
            single = smoothed_figures(inputs_of(design.replace(values)))
            for name, figures_of in grid.items():
                whole = np.broadcast_to(figures_of, (4, 3) if across else (3, 4))
                assert whole[(j, i) if across else (i, j)] == pytest.approx(float(single[name]), rel=1e-9), name


def test_each_verdict_names_its_processing_and_the_chosen_one_decides(named):
    budget = analyse(named["B"])
    assert (budget.verdict.processing, budget.other_verdict.processing) == ("real time", "post-processed")
    assert (budget.verdict.closes, budget.other_verdict.closes) == (False, True)
    chosen = analyse(named["B"].replace({"processing.mode": "post-processed"}))
    assert (chosen.verdict, chosen.other_verdict) == (budget.other_verdict, budget.verdict)
    document = to_json(chosen)
    assert document["processing"] == {"mode": "post-processed"}
    assert document["verdict"]["processing"] == "post-processed"
    assert document["sar"] == to_json(budget)["sar"]  # keys of before stay real time
    lines = document["post_processed"]["lines"]
    assert math.fsum(line["share"] for line in lines) == pytest.approx(1, abs=1e-9)
