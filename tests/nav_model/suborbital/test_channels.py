import numpy as np
import pytest
from scipy.integrate import solve_ivp

from nav_model.suborbital.channels import (
    channel_error,
    closed_form_errors,
    height_e_folding_time,
    height_growth,
    schuler_rate,
)

HEIGHT, END = 500e3, 1500.0
RATE = float(schuler_rate(HEIGHT))
VERTICAL = 1j * np.sqrt(2.0)  # times the rate of the horizontal channels


def test_e_folding_times():
    """star_tracker.md: 569.5, 637.9, 708.8 s at 0, 500, 1000 km."""
    times = height_e_folding_time(np.array([0.0, 500e3, 1000e3]))
    np.testing.assert_allclose(times, [569.5, 637.9, 708.8], atol=0.05)


@pytest.mark.parametrize(
    ("forcing", "horizontal", "vertical"),
    [
        ({"bias": 9.80665e-3}, 8713.7, 17152.0),
        ({"position": 100.0}, -9.1837, 529.83),
        ({"velocity": 1.0}, 898.3, 3319.0),
        ({"tilt_rate": 10.0 * np.pi / 180.0 / 3600.0}, 23740.0, 35883.0),
    ],
)
def test_printed_check_values(forcing, horizontal, vertical):
    """star_tracker.md, 500 km and 1500 s, 1e-4 relative."""
    assert channel_error(RATE, END, **forcing) == pytest.approx(horizontal, rel=1e-4)
    assert channel_error(VERTICAL * RATE, END, **forcing) == pytest.approx(vertical, rel=1e-4)


@pytest.mark.parametrize(("rate", "spring"), [(RATE, RATE**2), (VERTICAL * RATE, -2.0 * RATE**2)])
def test_closed_forms_solve_the_channel_equation(rate, spring, compared):
    """All forcings together against an ODE solver."""

    def slope(t, y):
        force = 2e-3 + 3e-5 * t + 5e-3 * np.sin(0.011 * t)
        return [y[1], force - spring * y[0]]

    answer = solve_ivp(slope, (0.0, END), [40.0, -0.3], rtol=1e-11, atol=1e-9, dense_output=True)
    t = np.linspace(0.0, END, 31)
    forcing = {"bias": 2e-3, "tilt_rate": 3e-5, "amplitude": 5e-3, "frequency": 0.011}
    result = channel_error(rate, t, position=40.0, velocity=-0.3, **forcing)
    solved = answer.sol(t)[0]
    np.testing.assert_allclose(result, solved, rtol=1e-6, atol=1e-4)
    compared(
        "Decoupled channels by formula",
        "B-6",
        "solver written by others",
        "SciPy's solver of initial value problems on the channel equation, written out in the test",
        np.abs(result - solved).max() / np.abs(solved).max(),
        1e-6,
        "largest difference over the largest error",
    )


def test_resonant_forcing_is_the_limit():
    at, near = (channel_error(RATE, END, amplitude=1e-3, frequency=RATE * factor) for factor in (1.0, 1.0 + 1e-5))
    assert at == pytest.approx(near, rel=1e-4)


def test_decoupled_channels_fail_on_the_long_arc(study, differs):
    """star_tracker.md, LIMIT: the gyro total in height is 36.8 km instead of 13.6 km."""
    k = study.case("gyro total")
    assert study.channels_m[k, -1, 2] == pytest.approx(36.8e3, rel=0.005)
    assert study.pure.position_m[k, -1, 2] == pytest.approx(13.6e3, rel=0.005)
    differs(
        "Height error from the gyros at the end of the worked flight", "B-5",
        f"{study.channels_m[k, -1, 2] / 1e3:.1f} km by decoupled channels",
        f"{study.pure.position_m[k, -1, 2] / 1e3:.1f} km by the integrated INS", "the integrated INS",
        "the local frame turns by more than half a radian on the arc, which the decoupled channels leave out; DOP853 "
        "confirms the integrated INS",
    )  # fmt: skip


def test_decoupled_channels_hold_while_the_local_frame_has_not_turned(study):
    """During the first 150 s the local frame turns by about a degree: both must agree to a few per cent."""
    for name in ("accelerometer bias", "initial position and velocity"):
        k = study.case(name)
        size = np.linalg.norm(study.pure.position_m[k, 150])
        gap = np.linalg.norm(study.channels_m[k, 150] - study.pure.position_m[k, 150])
        assert gap < 0.05 * size


def test_height_channel_grows_along_the_exponential_slope(study):
    """The slope 1/k on a log plot. Of the free height error [B-5] the growing part is z + z'/k; along the
    real heights it follows exp of the integral of k times the k^(-1/2) of a slowly changing k (WKB), to 3 %.
    The INS itself does not stay on that slope: its local frame turns by half a radian and more in coast."""
    growth = height_growth(study.flight)[::10]
    slow = height_e_folding_time(study.flight.height_m[::10])
    height = study.channels_m[study.case("initial position"), :, 2]
    growing = height + np.gradient(height, 1.0) * slow
    for start, stop in ((300, 800), (800, 1100), (1000, 1400)):
        expected = np.log(growth[stop] / growth[start]) + 0.5 * np.log(slow[stop] / slow[start])
        assert np.log(growing[stop] / growing[start]) == pytest.approx(expected, rel=0.03)
    assert growth[1] == pytest.approx(np.exp(1.0 / height_e_folding_time(0.0)), rel=1e-6)


def test_closed_forms_hold_where_their_constants_are_and_fail_after(study):
    """[B-6] with one height and constant forcing, against the integrated INS in height."""
    closed = closed_form_errors(study.flight, study.parameters, study.inputs.errors)[..., 2]
    ins, time = study.pure.position_m[..., 2], study.pure.time_s

    def gap(name, until):
        k, part = study.case(name), time <= until
        return np.abs(closed[k, part] - ins[k, part]).max() / np.abs(ins[k, part]).max()

    assert gap("initial position and velocity", 1000) < 0.06
    assert gap("accelerometer instability", 1300) < 0.10
    assert gap("gyro total", 1500) > 10  # f = 0 in coast: the forcing the form assumes is gone
