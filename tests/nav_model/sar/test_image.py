"""Images: simulated targets where they were put, widths as predicted, and the public X-band collection."""

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_history import simulate_phase_history

from nav_model.aperture.polynomial_response import quadratic_response
from nav_model.base.constants import SPEED_OF_LIGHT
from nav_model.sar.image import (
    PhaseHistory,
    back_project,
    point_target_image,
    pulse_errors,
    read_phase_history,
)
from nav_model.sar.line_of_sight import ApertureGeometry, range_error

SHARED = Path(__file__).parents[3].parent / "shared" / "data"
COLLECTION = [SHARED / f"sar_gotcha_pass1_az00{k}_HH.npz" for k in (1, 2)]
real_data = pytest.mark.skipif(
    not all(path.exists() for path in COLLECTION), reason="../shared/data (public X-band collection) is absent"
)

GEOMETRY = ApertureGeometry(6000.0, 100.0, 0.6)
TIME = np.linspace(-1.0, 1.0, 240)
FREQUENCY = 9.6e9 + np.linspace(-150e6, 150e6, 128)
WAVELENGTH = SPEED_OF_LIGHT / 9.6e9
AZIMUTH_CELL = WAVELENGTH * 6000 / (2 * 100 * 2.0)


def half_power_width(axis, cut):
    """Interpolated half-power width of a sampled cut about its highest sample."""
    top = int(cut.argmax())
    half = cut[top] / 2
    right = top + int(np.flatnonzero(cut[top:] < half)[0])
    left = int(np.flatnonzero(cut[: top + 1] < half)[-1])
    ends = [np.interp(half, [cut[right], cut[right - 1]], [axis[right], axis[right - 1]])]
    ends.append(np.interp(half, [cut[left], cut[left + 1]], [axis[left], axis[left + 1]]))
    return ends[0] - ends[1]


def strongest(image, x, y):
    """Position (x, y) [m] of the brightest pixel."""
    row, column = np.unravel_index(np.abs(image).argmax(), image.shape)
    return x[column], y[row]


def test_targets_appear_where_they_are_with_their_amplitude():
    targets = np.array([[0.0, 0.0, 0.0], [7.0, -4.0, 0.0], [-5.0, 6.0, 0.0]])
    history = simulate_phase_history(GEOMETRY, TIME, FREQUENCY, targets, [1.0, 0.5, 0.25])
    axis = np.linspace(-12, 12, 241)
    image = np.abs(back_project(history, axis, axis, window="taylor"))
    for (x, y, _), amplitude in zip(targets, (1.0, 0.5, 0.25), strict=True):
        column, row = np.argmin(np.abs(axis - x)), np.argmin(np.abs(axis - y))
        assert image[row, column] == pytest.approx(amplitude, abs=0.02)
        around = image[row - 5 : row + 6, column - 5 : column + 6]
        assert around.argmax() == 60
    assert strongest(image, axis, axis) == pytest.approx((0.0, 0.0), abs=1e-9)


def test_back_projection_is_the_direct_sum():
    history = simulate_phase_history(GEOMETRY, TIME[::8], FREQUENCY, [[3.0, -2.0, 0.0]])
    pixels = np.array([[3.0, -2.0], [3.3, -2.1], [0.0, 1.0]])
    for x, y in pixels:
        beyond = np.linalg.norm(np.array([x, y, 0.0]) - history.position, axis=1) - history.reference_range
        turns = np.exp(4j * np.pi / SPEED_OF_LIGHT * np.outer(FREQUENCY, beyond))
        expected = np.mean(history.samples * turns)
        assert back_project(history, [x], [y])[0, 0] == pytest.approx(expected, abs=3e-3)


@pytest.mark.parametrize("window", ["uniform", "taylor"])
@pytest.mark.parametrize("quadratic", [0.0, np.pi / 2, np.pi * 0.8])
def test_width_and_loss_under_a_quadratic_error_are_those_of_the_impulse_response(quadratic, window):
    history = simulate_phase_history(GEOMETRY, TIME, FREQUENCY, [[0.0, 0.0, 0.0]])
    x = np.linspace(-1, 1, len(TIME))
    error = quadratic * x**2 * history.wavelength / (4 * np.pi)
    axis = np.linspace(-4, 4, 401)
    power = np.abs(back_project(history, axis, [0.0], range_error=error, window=window)[0]) ** 2
    predicted = quadratic_response(quadratic, window)
    assert half_power_width(axis, power) / AZIMUTH_CELL == pytest.approx(predicted.width_cells, rel=0.015)
    assert 10 * np.log10(power.max()) == pytest.approx(predicted.peak_loss_db, abs=0.05)


def test_an_antenna_moved_by_a_position_error_sees_its_range_error():
    history = simulate_phase_history(GEOMETRY, TIME, FREQUENCY, [[0.0, 0.0, 0.0]])
    error = np.stack([0.02 * TIME, 0.01 * TIME**2, -0.005 * TIME**3], axis=1)
    axis = np.linspace(-2, 2, 21)
    moved = back_project(replace(history, position=history.position + error), axis, axis)
    ranged = back_project(history, axis, axis, range_error=range_error(GEOMETRY, TIME, *error.T))
    np.testing.assert_allclose(moved, ranged, atol=2e-3)


def test_point_target_image_is_the_back_projected_one():
    x = np.linspace(-1, 1, len(TIME))
    error = WAVELENGTH / (4 * np.pi) * (1.2 * x**2 + 0.8 * x**3)
    history = simulate_phase_history(GEOMETRY, TIME, FREQUENCY, [[0.0, 0.0, 0.0]])
    cells = np.linspace(-3, 3, 13)
    image = np.abs(back_project(history, cells * AZIMUTH_CELL, [0.0], range_error=error)[0])
    bandwidth = 300e6 * 128 / 127
    response = point_target_image(error, WAVELENGTH, SPEED_OF_LIGHT / (2 * bandwidth), cells, [0.0])
    np.testing.assert_allclose(10 ** (response[:, 0] / 20), image, atol=0.02)


def test_point_target_images_of_many_strategies_share_one_scale():
    x = np.linspace(-1, 1, 301)
    errors = np.stack([0 * x, 0.004 * x**2])
    cells = np.linspace(-8, 8, 65)
    images = point_target_image(errors, 0.03, 0.5, cells, cells, "taylor")
    assert images.shape == (2, 65, 65)
    assert images[0].max() == pytest.approx(0.0, abs=1e-6)
    loss = quadratic_response(4 * np.pi / 0.03 * 0.004, "taylor").peak_loss_db
    assert images[1].max() == pytest.approx(loss, abs=0.02)
    # A walk of one range cell over the aperture tilts the response: the peak drops although phase is removed.
    walk = point_target_image(0.5 * x, 1e9, 0.5, [0.0], cells)
    assert walk.max() < -1.0


def test_errors_are_laid_over_the_pulses():
    time = np.linspace(0, 5, 501)
    laid = pulse_errors(time, np.stack([time, time**2]).reshape(2, 1, 501), 117)
    assert laid.shape == (2, 1, 117)
    np.testing.assert_allclose(laid[1, 0], np.linspace(0, 5, 117) ** 2, atol=1e-4)


def joined(histories):
    """Phase histories of the same frequencies as one aperture."""
    first, *_ = histories = list(histories)
    assert all(np.array_equal(history.frequency, first.frequency) for history in histories)
    return PhaseHistory(
        np.concatenate([history.samples for history in histories], axis=1),
        first.frequency,
        np.concatenate([history.position for history in histories]),
        np.concatenate([history.reference_range for history in histories]),
    )


@pytest.fixture(scope="module")
def collection():
    """With the autofocus terms that come with it: exp(j (phase - 4 pi f range / c)), the signs that sharpen it."""

    def focused(path):
        history = read_phase_history(path.name, path.read_bytes())
        with np.load(path) as fields:
            turn = 4 * np.pi / SPEED_OF_LIGHT * np.outer(history.frequency, fields["af_r_correct"])
            return replace(history, samples=history.samples * np.exp(1j * (fields["af_ph_correct"] - turn)))

    return joined(focused(path) for path in COLLECTION)


def cross_range_cut(history, centre, **error):
    """Zoomed image about the scatterer, cut across range through its highest pixel; antenna on the x axis."""
    x = np.linspace(centre[0] - 3, centre[0] + 3, 121)
    y = np.linspace(centre[1] - 3, centre[1] + 3, 241)
    power = np.abs(back_project(history, x, y, **error)) ** 2
    return y, power[:, np.unravel_index(power.argmax(), power.shape)[1]]


@pytest.mark.long
@real_data
@pytest.mark.parametrize(("quadratic", "tolerance"), [(np.pi / 2, 0.03), (-np.pi / 2, 0.03), (np.pi, 0.05)])
def test_a_quadratic_error_widens_the_strongest_scatterer_as_predicted(
    collection, quadratic, tolerance, compared, ratio_off
):
    axis = np.linspace(-50, 50, 256)
    centre = strongest(back_project(collection, axis, axis), axis, axis)
    x = np.linspace(-1, 1, len(collection.reference_range))
    error = quadratic * x**2 * collection.wavelength / (4 * np.pi)
    clean = cross_range_cut(collection, centre)
    smeared = cross_range_cut(collection, centre, range_error=error)
    ideal, predicted = quadratic_response(0.0), quadratic_response(quadratic)
    widening = half_power_width(*smeared) / half_power_width(*clean)
    assert widening == pytest.approx(predicted.width_cells / ideal.width_cells, rel=tolerance)
    loss = 10 * np.log10(smeared[1].max() / clean[1].max())
    assert loss == pytest.approx(predicted.peak_loss_db, abs=0.15)
    # The clean width itself is the window's 0.886 of the cell of the aperture's angle.
    angle = np.ptp(np.unwrap(np.arctan2(collection.position[:, 1], collection.position[:, 0])))
    grazing = np.arctan2(collection.position[:, 2], np.hypot(*collection.position[:, :2].T)).mean()
    cell = collection.wavelength / (2 * angle * np.cos(grazing))
    oracle = "AFRL Gotcha collection, X band, its strongest scatterer"
    off = ratio_off(half_power_width(*clean), 0.8859 * cell)
    compared("Width of the unblurred image", "S-3", "real data", oracle, off, 0.05, "ratio − 1")
    oracle += ", a quadratic phase added to its data"
    off = ratio_off(widening, predicted.width_cells / ideal.width_cells)
    compared("Widening under a quadratic phase", "S-5", "real data", oracle, off, 0.05)
    compared(
        "Peak loss in an image",
        "S-5",
        "real data",
        oracle,
        loss - predicted.peak_loss_db,
        0.15,
        "largest difference, dB",
    )


@pytest.fixture
def fields():
    history = simulate_phase_history(GEOMETRY, TIME[:20], FREQUENCY[:16], [[0.0, 0.0, 0.0]])
    x, y, z = history.position.T
    return {"fp": history.samples, "freq": history.frequency, "x": x, "y": y, "z": z, "r0": history.reference_range}


def packed(fields):
    data = io.BytesIO()
    np.savez(data, **fields)
    return data.getvalue()


def test_a_file_is_read(fields):
    history = read_phase_history("a.npz", packed(fields))
    np.testing.assert_array_equal(history.samples, fields["fp"])
    np.testing.assert_array_equal(history.position.T, [fields[axis] for axis in "xyz"])
    np.testing.assert_array_equal(history.reference_range, fields["r0"])
    assert history.unambiguous_range == pytest.approx(SPEED_OF_LIGHT / (2 * 300e6 / 127))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"r0": None}, "r0 is missing"),
        ({"fp": np.zeros(5)}, "fp is missing or not"),
        ({"x": np.zeros(3)}, "x has shape"),
        ({"y": np.full(20, np.nan)}, "y holds values that are not finite"),
        ({"z": np.array(["a"] * 20)}, "'z': holds"),
        ({"fp": np.zeros((1, 2**24 + 1), np.int8)}, "fp has 16777217 samples; at most 16777216 are taken"),
        ({"freq": np.ones(16)}, "freq: the frequencies must rise"),
        ({"x": np.array([None] * 20)}, "objects and text are never unpacked"),
    ],
)
def test_malformed_files_are_refused_by_name(fields, change, message):
    changed = {name: value for name, value in (fields | change).items() if value is not None}
    with pytest.raises(ValueError, match=message) as caught:
        read_phase_history("bad.npz", packed(changed))
    assert "bad.npz" in str(caught.value)
