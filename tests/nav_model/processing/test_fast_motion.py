"""Vibration, unsensed motion and oscillator: against sums over all frequencies, impulse responses and noise."""

import math
from operator import attrgetter

import numpy as np
import pytest
from scipy.special import jv, spherical_jn

from nav_model.aperture.impulse_response import aperture_positions, impulse_response, response_curve, with_echoes
from nav_model.aperture.polynomial_response import quadratic_response
from nav_model.aperture.window import ideal_null_cells
from nav_model.base.arrays import Array
from nav_model.budget import analyse
from nav_model.budget.fast import scattered_floor
from nav_model.budget.figures import figures
from nav_model.budget.inputs import inputs_of
from nav_model.processing.compensation import power_left
from nav_model.processing.fast_motion import Curve, Source, through_aperture
from nav_model.processing.paired_echo import NOTHING, echo, highest_echo, scatter_exponent, scattered_ratio

pytestmark = pytest.mark.long

NONE = np.zeros(0)
TABLE = Curve(np.array([0.05, 1.0, 20.0, 2000.0]), np.array([1e-3, 2e-3, 0.5, 0.01]))


def _summed(f: Array, density: Array, aperture: float, lobe: float) -> dict[str, float]:
    """What sinusoids of these powers become through an aperture, by SciPy's Bessel functions."""
    j = [spherical_jn(m, np.pi * f * aperture) for m in range(4)]
    cells = f * aperture / lobe
    return {
        "quadratic": density @ (9 / 4 * 25 * j[2] ** 2),
        "cubic": density @ (25 / 4 * 49 * j[3] ** 2),
        "slope": density @ (9 * j[1] ** 2),
        "left_1": density @ (1 - j[0] ** 2 - 3 * j[1] ** 2),
        "left_2": density @ (1 - j[0] ** 2 - 3 * j[1] ** 2 - 5 * j[2] ** 2),
        "scattered": density @ (cells > 1),
        "near": density @ ((cells > 1) & (cells < 11)),
    }


@pytest.mark.parametrize(("bandwidth", "delay"), [(None, 0.4), (200.0, 0.0), (200.0, 5e-3)])
def test_integrals(bandwidth, delay, compared):
    """Against a sum over two million frequencies, SciPy's Bessel functions, the transfer as complex numbers."""
    aperture, lobe = 3.7, 1.0
    source = Source(NONE, NONE, TABLE, None, np.array(delay), None if bandwidth is None else np.array(bandwidth))
    made = through_aperture(source, np.array(aperture), lobe)
    edges = np.unique(np.concatenate([np.geomspace(0.05, 1, 200_001), np.linspace(1, 2000, 1_800_001)]))
    f = (edges[1:] + edges[:-1]) / 2
    w = 2 * np.pi * f
    answer = np.exp(-1j * w * delay) / (1 if bandwidth is None else 1 + 1j * f / bandwidth)
    table = np.exp(np.interp(np.log(f), np.log(TABLE.frequency), np.log(TABLE.density)))
    density = table * np.abs(1 - answer) ** 2 / w**4 * np.diff(edges)
    by_hand = _summed(f, density, aperture, lobe)
    off = [float(getattr(made, name)) / value - 1 for name, value in by_hand.items()]
    compared(
        "Vibration after compensation, through the aperture",
        "P-8",
        "solver written by others",
        "a sum over two million frequencies with SciPy's Bessel functions",
        off,
        1e-3,
    )


def test_variance_of_a_curve():
    f = np.geomspace(0.05, 2000, 2_000_001)
    table = np.exp(np.interp(np.log(f), np.log(TABLE.frequency), np.log(TABLE.density)))
    assert TABLE.variance == pytest.approx(np.trapezoid(table, f), rel=1e-9)
    falling = Curve(np.array([1.0, 100.0]), np.array([1.0, 0.01]))  # 1/f: a logarithm
    assert falling.variance == pytest.approx(math.log(100), rel=1e-12)


@pytest.mark.parametrize("late", [5e-3, 0.0])
@pytest.mark.parametrize("name", ["quadratic", "left_1", "scattered", "amplitude"])
def test_complex_steps(name, late):
    def made(aperture: Array, delay: Array) -> Array:
        source = Source(np.array([3.0]), np.array([1e-3]), TABLE, None, delay, np.array(150.0))
        return np.sum(getattr(through_aperture(source, aperture, 1.0), name))

    for step in ((1, 0), (0, 1)):
        inputs = [np.array(value * (1 + 1e-20j * on)) for value, on in zip((3.7, late), step, strict=True)]
        ends = [
            made(*(np.array(v * (1 + h * on)) for v, on in zip((3.7, late), step, strict=True)))
            for h in (1e-5, -1e-5)
        ]
        slope, size = (ends[0] - ends[1]) / 2e-5, abs(ends[0])
        assert float(made(*inputs).imag / 1e-20) == pytest.approx(float(slope), abs=1e-5 * float(size))


@pytest.mark.parametrize(
    ("low", "high", "delay"),
    [
        (200e3, 201e3, 4.7e-5),
        (192.1e3, 193.1e3, 4.7e-5),
        (1700.0, 1750.0, 5e-3),
        (3.34, 3.36, None),
        (40.0, 40.2, 0.3),
    ],
)
def test_narrow_bands_far_above_the_oscillation(low, high, delay):
    """Bands of less than a period of a factor: against a sum over 200,000 frequencies."""
    aperture, lobe = 5.38, 1.0
    late = None if delay is None else np.array(delay)
    source = Source(NONE, NONE, None, Curve(np.array([low, high]), np.ones(2)), late)
    made = through_aperture(source, np.array(aperture), lobe)
    count = 200_000
    f, weights = low + (high - low) * (np.arange(count) + 0.5) / count, np.full(count, (high - low) / count)
    density = weights if delay is None else weights * 4 * np.sin(np.pi * f * delay) ** 2
    for name, theirs in _summed(f, density, aperture, lobe).items():
        assert float(getattr(made, name)) == pytest.approx(theirs, rel=2e-3), name


@pytest.mark.parametrize(("band", "islr"), [((200e3, 201e3), -41.80), ((192.1e3, 193.1e3), -67.7)])
def test_islr_of_a_narrow_band_of_the_oscillator(open_design, band, islr):
    """Two-way, the echo of 7 km takes away what it has a whole number of periods of: a band of a twentieth of one."""
    noise = tuple((at, 1e-8, "phase noise") for at in band)
    ratio = float(figures(inputs_of(open_design.replace({"oscillator.phase_noise": noise})), ["islr"])["islr"])
    assert 20 * math.log10(ratio) == pytest.approx(islr, abs=0.05)


def _lines(frequency: float, phase: float, aperture: float):
    source = Source(np.array([frequency]), np.array([phase]))
    return through_aperture(source, np.array(aperture), 1.0)


@pytest.mark.parametrize("window", ["uniform", "hamming", "taylor"])
def test_paired_echoes_of_the_impulse_response(window, compared):
    """Power of the product's own response where the echo is said to be, over that of its peak."""
    x, cells, padding, off = aperture_positions(1024), 200, 4, []
    starts = np.linspace(0, 2 * np.pi, 8, endpoint=False)[:, None]
    for phase in (0.02, 0.05, 0.1, 0.3, 0.6, 1.0):
        aperture = np.exp(1j * phase * np.cos(np.pi * cells * x + starts))
        at, power = response_curve(aperture, window, extent_cells=cells + 2, zero_padding=padding)
        peak, beside = (10 ** (power[:, at == place] / 10) for place in (0, cells))
        off.append(10 * math.log10(np.mean(beside / peak)) - 20 * math.log10(float(echo(np.array(phase)))))
        assert np.all(np.abs(at[np.argmax(np.where(at > cells / 2, power, -999), axis=1)] - cells) <= 1 / padding)
    compared(
        "Paired echoes of 0.02 to 1 rad",
        "P-9",
        "our own derivation",
        "the product's impulse response of the sinusoid, 200 cells from the peak",
        off,
        0.1,
        "largest difference, dB",
    )


def test_echo_is_the_ratio_of_bessel_functions():
    p = np.linspace(0.001, 2.3, 50)
    np.testing.assert_allclose(echo(p), jv(1, p) / jv(0, p), rtol=1e-13)
    assert float(echo(np.array(50.0))) == float(echo(np.array(2.3)))  # nothing of the target's peak is left


def test_the_highest_echo_counts_and_slow_lines_do_not():
    fast, slow = _lines(20.0, 0.1, 3.0), _lines(0.2, 0.5, 3.0)
    k, aperture = np.array(1.0), np.array(3.0)
    assert float(highest_echo([slow, fast], k, aperture, 1.0)) == pytest.approx(jv(1, 0.1) / jv(0, 0.1), rel=1e-12)
    assert float(highest_echo([slow], k, aperture, 1.0)) == NOTHING


@pytest.mark.parametrize(
    ("window", "density", "falls"),
    [("uniform", 1e-4, 0.0), ("uniform", 0.02, -2.0), ("hamming", 5e-3, -1.0), ("taylor", 1e-4, 0.0)],
)
def test_islr_of_random_phase(window, density, falls, compared):
    """400 random phases of the spectrum through the product's impulse response; the window's side lobes taken off."""
    aperture, samples, runs = 4.0, 1024, 400
    f = np.array([3.0, 100.0])
    curve = Curve(f, density * (f / f[0]) ** falls)
    lobe = ideal_null_cells(window)
    made = through_aperture(Source(NONE, NONE, None, curve), np.array(aperture), lobe)
    exponent = scatter_exponent([made], np.array(1.0), np.array(aperture), lobe)
    islr = 20 * math.log10(float(scattered_ratio(exponent)))
    rng = np.random.default_rng(7)
    long = 8  # the noise is that of a record eight apertures long, cut: as a real flight's
    at = np.arange(1, samples * long // 2) / (aperture * long)
    inside = (at >= f[0]) & (at <= f[1])
    amplitude = np.sqrt(np.where(inside, density * (at / f[0]) ** falls, 0) / (aperture * long))
    noise = rng.standard_normal((runs, len(at))) + 1j * rng.standard_normal((runs, len(at)))
    spectrum = np.zeros((runs, samples * long), complex)
    spectrum[:, 1 : len(at) + 1] = amplitude * noise
    phase = np.fft.fft(spectrum, axis=1).real[:, :samples]
    assert phase.var() == pytest.approx(float(made.scattered), rel=0.1)
    ideal = quadratic_response(0.0, window)
    side = 10 ** (ideal.islr_fixed_db / 10)
    islr_power = 10 ** (np.asarray(impulse_response(np.exp(1j * phase), window, 8).islr_fixed_db) / 10)
    random = (islr_power - side) / (1 + side)
    mean, error = random.mean(), random.std() / math.sqrt(runs)
    assert error < 0.02 * mean  # 0.09 dB
    compared(
        "ISLR of random phase",
        "P-11",
        "our own derivation",
        "400 random phase histories through the product's impulse response",
        islr - 10 * math.log10(mean),
        0.3,
        "difference, dB",
    )


@pytest.mark.parametrize("window", ["uniform", "taylor"])
def test_response_with_echoes(window):
    """Peak loss, PSLR and ISLR of a line on top of a quadratic, mean over the line's phase."""
    quadratic, phase, cells = 0.9, 0.25, 40.0
    x = aperture_positions(1024)
    starts = np.linspace(0, 2 * np.pi, 16, endpoint=False)[:, None]
    real = impulse_response(np.exp(1j * (quadratic * x**2 + phase * np.cos(np.pi * cells * x + starts))), window)
    power_at_target = float(jv(0, phase)) ** 2
    made = with_echoes(quadratic_response(quadratic, window), float(echo(np.array(phase))), power_at_target, 1.0)
    for name in ("peak_loss_db", "pslr_fixed_db", "islr_fixed_db", "islr_null_db"):
        assert float(np.mean(getattr(real, name))) == pytest.approx(float(getattr(made, name)), abs=0.15), name


def test_oscillator_filter():
    """4 sin² of half the phase that turns on the way to the target and back."""
    w, way = 2 * np.pi * np.geomspace(0.1, 1e6, 50), np.array(2 * 7000.0 / 299792458)
    np.testing.assert_allclose(power_left(w, way), (2 * np.sin(w * 7000.0 / 299792458)) ** 2, rtol=1e-9)


def _line_fitted(f: Array, aperture: float) -> tuple[Array, Array]:
    """Mean squares, over their phase, of the mean and the slope of sinusoids of one metre: a least squares line."""
    t = (np.arange(4000) + 0.5) / 4000 * aperture - aperture / 2
    turning = np.exp(2j * np.pi * f[:, None] * t)
    slope = turning @ t / (t @ t)
    return np.abs(turning.mean(axis=1)) ** 2 / 2, np.abs(slope) ** 2 / 2


def test_what_vibrates_shifts_the_image(open_design):
    """Range and azimuth of a line and of a spectrum that the IMU does not feel, by a line fitted to sinusoids."""
    rows = ((0.1, 1e-6, "length density"), (5.0, 1e-8, "length density"))
    design = open_design.replace(
        {"motion.unsensed_lines": ((0.15, 2e-3, "length"),), "motion.unsensed_spectrum": rows}
    )
    plain, moved = analyse(open_design), analyse(design)
    aperture = plain.sar.aperture_time
    line = _line_fitted(np.array([0.15]), aperture)
    f = np.geomspace(0.1, 5.0, 4000)
    density = 2 * np.exp(np.interp(np.log(f), np.log([0.1, 5.0]), np.log([1e-6, 1e-8])))
    mean, slope = (
        4e-6 * float(of_line[0]) + np.trapezoid(density * of_all, f)
        for of_line, of_all in zip(line, _line_fitted(f, aperture), strict=True)
    )
    lever = design.radar.slant_range / design.flight.speed
    for mode in ("real time", "post-processed"):
        for name, more in (("range_shift", mean), ("azimuth_shift", lever**2 * slope)):
            before, after = plain[name, mode], moved[name, mode]
            assert after.sigma**2 - before.sigma**2 == pytest.approx(more, rel=1e-4)
        assert after.shares["unsensed motion"] == pytest.approx(lever**2 * slope / after.sigma**2, rel=1e-4)
    slope_shift = attrgetter("slope_shift")
    more = moved.beside(slope_shift) ** 2 - plain.beside(slope_shift) ** 2
    assert more == pytest.approx(lever**2 * slope, rel=1e-4)


@pytest.mark.parametrize("variance", [1.5, 3.0])
def test_islr_of_large_random_phase(variance):
    """Above 1 rad² most energy scatters: 400 histories, what varies from one to the next over what all of them have.

    In the response of one history speckle lies on the target too, more of it the narrower the spectrum.
    """
    samples, runs, cells = 1024, 400, 200.0
    rng = np.random.default_rng(5)
    f = np.arange(2, int(cells) + 1)  # cells, beyond the main lobe
    x = np.arange(samples) / samples
    amplitude = np.sqrt(variance / len(f))
    drawn = rng.standard_normal((2, runs, len(f))) * amplitude
    turns = 2 * np.pi * np.outer(f, x)
    phase = drawn[0] @ np.cos(turns) + drawn[1] @ np.sin(turns)
    field = np.exp(1j * phase)
    at_target = np.mean(field, axis=1)
    coherent = np.abs(at_target.mean()) ** 2
    scattered = np.mean(np.abs(field - at_target.mean()) ** 2)
    formula = 20 * math.log10(float(scattered_ratio(np.array(variance))))
    assert formula == pytest.approx(10 * math.log10(scattered / coherent), abs=0.3)


@pytest.mark.parametrize("window", ["uniform", "taylor"])
def test_the_floor_of_the_response_is_the_mean_of_random_histories(open_design, window):
    """300 histories of an unsensed motion in the response with the target's own peak, 8 to 40 cells away: 0.5 dB."""
    rows = ((0.5, 4e-8, "length density"), (40.0, 1e-8, "length density"))
    design = open_design.replace({"motion.unsensed_spectrum": rows, "radar.window": window})
    budget = analyse(design)
    aperture, wavelength = budget.sar.aperture_time, budget.sar.wavelength
    rng = np.random.default_rng(8)
    step = 1 / (16 * aperture)
    f = np.arange(0.5, 40.0, step)
    density = np.exp(np.interp(np.log(f), np.log([0.5, 40.0]), np.log([4e-8, 1e-8])))
    amplitude = 4 * math.pi / wavelength * np.sqrt(density * step)
    t = (aperture_positions(1024) + 1) / 2 * aperture
    drawn = rng.standard_normal((2, 300, len(f))) * amplitude
    phase = drawn[0] @ np.cos(2 * np.pi * np.outer(f, t)) + drawn[1] @ np.sin(2 * np.pi * np.outer(f, t))
    beyond = f * aperture > ideal_null_cells(window)
    assert budget.spectral.random == pytest.approx(np.sum(amplitude[beyond] ** 2), rel=0.02)
    _, power = response_curve(np.exp(1j * phase), window, extent_cells=41.0)
    cells, response = response_curve(np.ones((1, 1024), complex), window, extent_cells=41.0)
    mean = np.mean(10 ** (power / 10), axis=0) - 10 ** (response[0] / 10) * math.exp(-np.sum(amplitude**2))
    floor = scattered_floor(design, cells, wavelength, aperture, budget.spectral.random)
    for low, high in ((8, 12), (20, 40)):
        there = (np.abs(cells) > low) & (np.abs(cells) < high)
        assert 10 * math.log10(mean[there].mean() / floor[there].mean()) == pytest.approx(0.0, abs=0.5)
    assert np.all(floor[np.abs(cells) < 0.9] == 0)


@pytest.mark.parametrize("p", [1e-4, 1e-3, 3e-3])
def test_a_small_line_keeps_its_digits_through_a_complex_step(p: float) -> None:
    """-2 ln J0(p) by its series, and its slope."""
    line = Source(np.array([50.0]), np.array([p]))
    effect = through_aperture(line, np.array(2.0), 1.0).scaled(np.asarray(1 + 1e-20j))
    exponent = scatter_exponent([effect], np.array(1.0), np.array(2.0), 1.0)
    assert exponent.real == pytest.approx(p**2 / 2 + p**4 / 32 + p**6 / 288, rel=1e-14, abs=0)
    assert exponent.imag / 1e-20 == pytest.approx(p**2 + p**4 / 8 + p**6 / 48, rel=1e-13, abs=0)
