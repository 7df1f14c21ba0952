"""The equations a report rests on, their symbols and the literature: a table of data.

Written once, in Typst's math notation; the PDF sets it and the HTML carries it as MathML. Marks are those of the
product: T for the navigation theory, S for the radar, P for processing after the flight.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass


@dataclass(frozen=True)
class Equation:
    """A numbered equation.

    Attributes
    ----------
    mark : str
        Its number, such as ``"T-9"``; texts cite it in brackets.
    title : str
        What it gives, in a few words.
    math : str
        The equation in Typst's math notation, which every renderer typesets.
    says : str
        What it means, in a sentence or two; may cite other marks.
    """

    mark: str
    title: str
    math: str
    says: str


@dataclass(frozen=True)
class Symbol:
    """A row of the table of symbols.

    Attributes
    ----------
    math : str
        The symbol in Typst's math notation.
    meaning, unit : str
        What it denotes, and its SI unit.
    marks : tuple of str
        Marks of the equations that use it; empty for the symbols of every report.
    """

    math: str
    meaning: str
    unit: str
    marks: tuple[str, ...] = ()


_CITED = re.compile(r"\[([TSBP]-\d+)\]")

EQUATIONS: tuple[Equation, ...] = (
    Equation(
        "T-1",
        "Error dynamics, straight and level flight",
        "dot(delta bold(r)) = delta bold(v), quad dot(delta bold(v)) = bold(G) bold(psi) + bold(w)_a, quad "
        "dot(bold(psi)) = bold(w)_omega, quad bold(G) = mat(0, -g, 0; g, 0, 0; 0, 0, 0)",
        "Position, velocity and attitude errors; white noise of the accelerometers and gyros, independent per axis.",
    ),
    Equation(
        "T-2",
        "Density of the fixes",
        'R = sigma_"GNSS"^2 delta(t) thick arrow.r.double thick s = sigma_"GNSS" sqrt(Delta t)',
        "A fix every Δt seconds is, to the continuous filter, white noise of this density.",
    ),
    Equation(
        "T-3",
        "Steady state, horizontal channel",
        "p_11^4 / 4 = 2 g sigma_omega s^5 p_11 + s^6 sigma_a^2, quad p_22 = p_11^3 / (2 s^4) - g sigma_omega s, "
        "quad p_33 = (p_11^2 sigma_omega) / (2 g s^3)",
        "Variances of position, velocity and tilt over a cycle of the filter.",
    ),
    Equation(
        "T-4",
        "Steady state, vertical channel",
        "v_11 = sqrt(2) thin s^(3 slash 2) sigma_a^(1 slash 2), quad v_12 = sigma_a s, quad v_22 = v_11 sigma_a / s",
        "Variances of height and vertical velocity.",
    ),
    Equation(
        "T-5",
        "Yaw",
        "sigma_psi^2 (t) = psi_0^2 + sigma_omega^2 t",
        "ψ is the yaw error here: unobservable on a straight path, it only grows.",
    ),
    Equation(
        "T-6",
        "Gyro dominance",
        "u^4 = 1 + kappa u, quad u = p_11 / v_11, quad kappa = (2 sqrt(2) thin g sigma_omega s^(1 slash 2)) / "
        "sigma_a^(3 slash 2)",
        "One number tells which sensor limits the horizontal channel.",
    ),
    Equation(
        "T-7",
        "Gyro-dominated limit",
        "p_11 -> 2 s^(5 slash 3) (g sigma_omega)^(1 slash 3), quad p_22 -> 3 g sigma_omega s, quad "
        "p_33 -> 2 (s sigma_omega^5 / g)^(1 slash 3)",
        "Holds for gyro dominance far above one.",
    ),
    Equation(
        "T-8",
        "Discrete filter",
        "bold(P)^- = bold(Phi) bold(P)^+ bold(Phi)^upright(T) + bold(Q), quad bold(P)^+ = bold(P)^- - "
        "(bold(P)^- bold(H)^upright(T) bold(H) bold(P)^-) / (bold(H) bold(P)^- bold(H)^upright(T) + "
        'sigma_"GNSS"^2), quad lambda Delta t = (p_11 Delta t) / s^2',
        "Prior, just before a fix, and posterior, just after it: the ends of the sawtooth. Above λ Δt = 0.5 the "
        "closed form is far from both.",
    ),
    Equation(
        "T-9",
        "Outage, horizontal channel",
        "sigma_x^2 (t) &= p_11 + 2 p_12 t + (p_22 + g p_13) t^2 + (sigma_a^2 / 3 + g p_23) t^3 + (g^2 p_33) / 4 t^4 "
        "+ (g^2 sigma_omega^2) / 20 t^5 \\ "
        "sigma_v^2 (t) &= p_22 + (sigma_a^2 + 2 g p_23) t + g^2 p_33 t^2 + (g^2 sigma_omega^2) / 3 t^3, quad "
        "sigma_theta^2 (t) = p_33 + sigma_omega^2 t",
        "Starts from the closed form at the last fix. Residual biases add in quadrature, with t²/2 and g t³/6.",
    ),
    Equation(
        "T-10",
        "Outage, vertical channel",
        "sigma_z^2 (t) = v_11 + 2 v_12 t + v_22 t^2 + sigma_a^2 / 3 t^3",
        "Optimistic after about 45 s; see [T-17].",
    ),
    Equation(
        "T-11",
        "Outage from a perfect start",
        "sigma_x^2 (t) = sigma_a^2 / 3 t^3 + (g^2 sigma_omega^2) / 20 t^5, quad sigma_z^2 (t) = sigma_a^2 / 3 t^3",
        "The error from the sensors alone.",
    ),
    Equation(
        "T-12",
        "Share of the initial tilt",
        "sigma_x (t) = g / 2 sqrt(p_33) thin t^2",
        "Horizontal only.",
    ),
    Equation(
        "T-13",
        "Phase of a line-of-sight error",
        "phi = (4 pi) / lambda thin delta r",
        "Two-way.",
    ),
    Equation(
        "T-15",
        "Residual phase after linear detrend",
        "sigma_phi^2 = ((4 pi) / lambda)^2 [cos^2 psi thin (g^2 p_33) / 720 T^4 + sigma_a^2 / 420 T^3 + "
        "cos^2 psi thin (17 g^2 sigma_omega^2) / 30240 T^5]",
        "Mean square over the aperture. Biases and a coast before the aperture add the terms of [S-6].",
    ),
    Equation(
        "T-17",
        "Refined outage",
        "dot(delta v)_x = -g / R_e delta x + dots.h, quad dot(delta v)_z = (2 g) / R_e delta z + 2 Omega cos phi.alt "
        "thin delta v_E + (2 V) / R_e delta v_x, quad dot(bold(P)) = bold(F) bold(P) + bold(P) bold(F)^upright(T) + "
        "bold(Q), quad bold(P)(0) = bold(P)^+",
        "Schuler, gravity-gradient and Coriolis terms, from the posterior covariance of [T-8]; residual biases in "
        "quadrature. Requirements after the last fix are checked against this curve.",
    ),
    Equation(
        "T-18",
        "Shares in steady state",
        '(partial ln p_(i j)) / (partial ln q_k) = ("part of " q_k " in " p_(i j)) / p_(i j), quad '
        'q_k in {sigma_a^2, sigma_omega^2, sigma_"GNSS"^2}',
        "The gain is optimal, so the share of a source is the sensitivity to it.",
    ),
    Equation(
        "S-1",
        "Line of sight, broadside",
        'sigma_"LOS"^2 = cos^2 psi thin sigma_y^2 + sin^2 psi thin sigma_z^2',
        "Grazing angle ψ weighs cross-track against vertical errors.",
    ),
    Equation(
        "S-2",
        "Quadratic phase from along-track velocity",
        "phi = (pi V T^2 thin delta V) / (lambda R)",
        "The line of sight turns over the aperture, so a velocity error does more than shift the image. Checked "
        "separately against the limit on quadratic phase. Broadside; under squint, times the square of its cosine.",
    ),
    Equation(
        "S-3",
        "Aperture and cell",
        'T = (k lambda R) / (2 rho_a V), quad rho_"cell" = (lambda R) / (2 V T)',
        "k is the half-power width of the window in cells: 0.8859 uniform, 1.1875 Taylor (−35 dB, n̄ = 5), "
        "1.3030 Hamming. Broadside; under squint the speed is that across the line of sight, V times the cosine.",
    ),
    Equation(
        "S-5",
        "Quadratic phase over the aperture",
        'sigma_"QPE"^2 = ((4 pi) / lambda)^2 T^4 / 64 [cos^2 psi thin g^2 (p_33 + b_g^2 (T_c + T / 2)^2 + '
        "sigma_omega^2 T_c + 181 / 462 sigma_omega^2 T) + b_a^2 + 10 / 7 sigma_a^2 / T]",
        "Phase at the ends of the aperture, source by source, before autofocus.",
    ),
    Equation(
        "S-6",
        "Residual phase after autofocus, and cubic phase",
        'm = 1: quad &"[T-15]" + ((4 pi) / lambda)^2 [T^4 / 720 (b_a^2 + cos^2 psi thin g^2 (sigma_omega^2 T_c + '
        "b_g^2 (T_c + T / 2)^2)) + cos^2 psi thin (g^2 b_g^2) / 100800 T^6] \\ "
        "m = 2: quad &((4 pi) / lambda)^2 [sigma_a^2 / 2520 T^3 + cos^2 psi thin g^2 ( sigma_omega^2 / 55440 T^5 + "
        "b_g^2 / 100800 T^6)] \\ "
        "m = 3: quad &((4 pi) / lambda)^2 [sigma_a^2 / 6930 T^3 + cos^2 psi thin (g^2 sigma_omega^2) / 540540 T^5] "
        "\\ "
        'sigma_"CPE"^2 = &((4 pi) / lambda)^2 [25 / 4 (7 / 3960 sigma_a^2 T^3 + 7 / 61776 cos^2 psi thin '
        "g^2 sigma_omega^2 T^5) + cos^2 psi thin (g^2 b_g^2) / 2304 T^6]",
        "m is the highest order of phase that autofocus removes; 1 is the line only.",
    ),
)

SYMBOLS: tuple[Symbol, ...] = (
    Symbol("sigma_a", "velocity random walk, times the vibration factor", "m/s/√s"),
    Symbol("sigma_omega", "angle random walk, times the vibration factor", "rad/√s"),
    Symbol("b_a, b_g", "residual biases of accelerometer and gyro at the last fix, 1σ", "m/s², rad/s"),
    Symbol('sigma_"GNSS", Delta t, s', "noise of one fix, fix interval, density of the fixes", "m, s, m·√s"),
    Symbol("p_(i j), v_(i j)", "covariance of (position, velocity, tilt), horizontal and vertical", "m, m/s, rad"),
    Symbol("bold(P)^-, bold(P)^+", "covariance just before and just after a fix", "as above"),
    Symbol("kappa, u", "gyro dominance; horizontal over vertical position variance", "1"),
    Symbol("lambda Delta t", "filter bandwidth times fix interval", "1"),
    Symbol("g, R_e, Omega", "gravity, Earth radius plus altitude, Earth rate", "m/s², m, rad/s"),
    Symbol("t, T, T_c", "time since the last fix, aperture time, coast before the aperture", "s"),
    Symbol("lambda, R, V, rho_a", "wavelength, slant range, ground speed, azimuth resolution", "m, m, m/s, m"),
    Symbol("psi, phi.alt", "grazing angle, but yaw in [T-5]; latitude in [T-17]", "rad"),
)

REFERENCES: tuple[str, ...] = (
    "[A] Makarem and Cheraghi Mahmudabadi, Accuracy analysis of integrated INS/GNSS navigation in a straight path "
    "with constant velocity for airborne SAR. Journal of Radar 7(2), 2019. Source of [T-1] to [T-7] and [T-9] to "
    "[T-12].",
    "[C] Cheraghi Mahmudabadi, Makarem and Hatam, Challenges of inertial and integrated navigation systems in SAR "
    "application. Source of [T-13] and of the correction limits; its gyro term is printed with √21 where the "
    "integral gives √20, which is used here.",
    "[T-8], [T-15], [T-17], [T-18] and [S-1] to [S-6] are derived in NavBudget and verified against Riccati and "
    "covariance solutions and Monte Carlo runs in its test suite.",
    "The table of inputs gives the source of each sensor and radar value.",
)

# --- beyond a report: what the other pages rest on ---------------------------------------------------------

_BEYOND: tuple[Equation, ...] = (
    Equation(
        "P-1",
        "Position drift of the IMU, as a spectral density",
        "S_p (w) = sigma_a^2 / w^4 + (g^2 sigma_omega^2) / w^6",
        "Two-sided, over angular frequency w; the vertical has the first term only.",
    ),
    Equation(
        "P-2",
        "Position error of the receiver, as a spectral density",
        "1 / (S_n (w)) = 1 / (s^2 + S_c (w)) + w^2 / s_v^2, quad s_v = sigma_v sqrt(Delta t_v), quad "
        "S_c (w) = (2 sigma_c^2 tau) / (1 + w^2 tau^2)",
        "Position fixes with their slow error, combined with velocity fixes.",
    ),
    Equation(
        "P-3",
        "Smoothed position error, as a spectral density",
        r"S_e (w) = 1 / (1 \/ S_p + 1 \/ S_n), quad sigma^2 = 1 / pi integral_0^oo S_e dif w",
        "A smoother with fixes on both sides, in a leg of 6/w₀ and more on each, w₀ = (g σ_ω/s)^(1/3), and with "
        "w₀ Δt up to 0.7; otherwise it is computed in state space. Velocity has the density w² S_e.",
    ),
    Equation(
        "P-4",
        "Shares of the smoothed error",
        "S_e = sum_i (1 - H)^2 S_(p, i) + sum_j H^2 S_(n, j), quad H = S_p / (S_p + S_n)",
        "Drift sources i, receiver sources j; the smoother is optimal, so a share is the sensitivity to its source.",
    ),
    Equation(
        "P-5",
        "The aperture as a filter",
        'sigma_"QPE"^2 &= ((4 pi) / lambda)^2 9 / (4 pi) integral_0^oo 25 j_2^2 S dif w, quad '
        'sigma_"CPE"^2 = ((4 pi) / lambda)^2 25 / (4 pi) integral_0^oo 49 j_3^2 S dif w \\ '
        "sigma_m^2 &= ((4 pi) / lambda)^2 1 / pi integral_0^oo (1 - sum_(n = 0)^m (2 n + 1) j_n^2) S dif w, quad "
        "sigma_dot(r)^2 = (2 / T)^2 1 / pi integral_0^oo 9 j_1^2 S dif w",
        "j_n is the spherical Bessel function of w T/2, S the density of the line of sight [S-1], m the order that "
        "autofocus removes. Quadratic phase from the error along the track: the filter (3 j₁ − 9/2 j₃)² [S-2].",
    ),
    Equation(
        "P-6",
        "Steady state with velocity fixes",
        "c_0 = (g sigma_omega) / s, quad c_1^2 = sigma_a^2 / s^2 + rho c_0^2 + 2 c_0 c_2, quad "
        "c_2^2 = sigma_a^2 / s_v^2 + 2 c_1, quad rho = s^2 / s_v^2, quad "
        "p_11 = (s^2 (c_2 + rho c_0)) / sqrt(1 + rho (c_2 + rho c_0)^2)",
        "The stable factor of w⁶ + (σ_a² w² + g² σ_ω²)(1/s² + w²/s_v²) = 0, a cubic in w²; the rest follows.",
    ),
    Equation(
        "P-7",
        "Where the image lies",
        "delta r = -bold(u) dot.op delta bold(p), quad delta x = delta p_x + R / V thin bold(u) dot.op dot(delta "
        "bold(p)), quad delta y = (delta r) / (cos psi) + tan psi thin delta h",
        "Range, azimuth and ground range; h is the height of the scene that the image is projected on. CE90 is the "
        "exact quantile of the two errors on the ground together.",
    ),
    Equation(
        "P-8",
        "Vibration left after IMU compensation",
        r"S_d (w) = abs(1 - B (w) e^(-upright(i) w tau_d))^2 (S_a (w)) / w^4, quad "
        r"B (w) = 1 / (1 + upright(i) w \/ w_b)",
        "Antenna and IMU feel the same motion; it is compensated with the IMU's first-order bandwidth and the delay "
        "to the radar. A line of displacement d leaves |1 − B exp(−iwτ)| d. Motion that the IMU does not sense is "
        "not compensated. The remainder is filtered by the aperture as in [P-5].",
    ),
    Equation(
        "P-9",
        "Paired echo of a line",
        "a = (J_1 (p)) / (J_0 (p)), quad Delta x = (f lambda R) / (2 V)",
        "Amplitude of each of the two echoes over the target's, p the line's phase, peak; a line slower than the "
        "main lobe blurs instead. Beyond p = 2.3 nothing is left of the target's own peak.",
    ),
    Equation(
        "P-10",
        "Phase noise of the oscillator",
        r"S_phi (f) = 2 dot.op 10^(L (f) \/ 10) thin (f_c / f_o)^2 thin 4 sin^2 ((2 pi f R) / c)",
        "One-sided, in rad²/Hz; noise that is slow compared with the echo delay cancels. Bistatic: without the "
        "sine factor.",
    ),
    Equation(
        "P-11",
        "Energy scattered by fast phase errors",
        "E = s^2 - 2 sum_k ln J_0 (p_k), quad e^E - 1, quad e^(-E)",
        "Scattered energy over the target's, and the power that stays at its peak; s² is the variance of the spectra "
        "beyond the main lobe, p_k the lines there. The window's own side lobes come on top.",
    ),
    Equation(
        "P-12",
        "Bias by vibration rectification",
        "b_v = k_v (sum_k a_k^2 / 2 + integral_0^oo S_a dif f)",
        "From the vibration's mean square; it adds to the accelerometer bias in [T-9] and [S-5]. A smoother "
        "absorbs it.",
    ),
    Equation(
        "T-14",
        "Residual after a polynomial fit",
        "integral_0^T (e(t) - hat(e)_m (t))^2 (dif t) / T",
        "Each error process less its least-squares line (m = 1) or quadratic (m = 2) over the aperture. The "
        "coefficients of [T-15] and [S-6] are these integrals, exact.",
    ),
    Equation(
        "T-16",
        "A quadratic fitted to INS minus GNSS",
        "sigma_r^2 approx s^2 / T N^4 / ((N^2 - 1)(N^2 - 4)) + sigma_a^2 / 2520 T^3 + "
        "(g^2 sigma_omega^2) / 55440 T^5",
        "N fixes in the aperture, at least three. The noise factor is exact; the inertial terms treat the fit as "
        "continuous.",
    ),
    Equation(
        "S-4",
        "Limits on phase, in metres of line of sight",
        "pi / 4 = hat(lambda / 16), quad pi / 2 = hat(lambda / 8), quad pi = hat(lambda / 4)",
        "A hat reads: corresponds to.",
    ),
    Equation(
        "S-7",
        "GNSS noise through the quadratic fit",
        'sigma_"QPE" = T^2 / 4 sigma_"GNSS" sqrt(180 / (Delta t^4 N (N^2 - 1)(N^2 - 4)))',
        "In metres at the ends of the aperture.",
    ),
    Equation(
        "B-1",
        "Sensor errors over a suborbital flight",
        "delta bold(f) = bold(B)_a + (bold(S)_a + bold(N)_a) bold(f) + bold(w)_a, quad delta bold(omega) = "
        "bold(B)_g + "
        "(bold(S)_g + bold(N)_g) bold(omega) + bold(w)_g, quad X = X_c + X_o sin (2 pi t) / tau",
        "Every parameter X is a constant plus an oscillation.",
    ),
    Equation(
        "B-2",
        "Mechanisation in the navigation frame",
        "dot(bold(C)) = bold(C) [bold(omega)_(i b) times] - [(bold(omega)_(i e) + bold(omega)_(e n)) times] bold(C), "
        "quad dot(bold(v)) = bold(C) bold(f) + bold(g) - (2 bold(omega)_(i e) + bold(omega)_(e n)) times bold(v) - "
        "bold(omega)_(i e) times (bold(omega)_(i e) times bold(r))",
        "North, east, down; position from velocity over the sphere.",
    ),
    Equation(
        "B-3",
        "Mechanisation in inertial axes",
        "dot.double(bold(r)) = bold(C)_(b i) bold(f) - mu bold(r) / abs(bold(r))^3",
        "Must agree with [B-2].",
    ),
    Equation(
        "B-4",
        "Linear errors in inertial axes",
        "dot(bold(psi)) = bold(C) delta bold(omega), quad dot.double(delta bold(r)) = bold(C) delta bold(f) "
        "+ bold(psi) "
        "times bold(f) + w^2 (3 bold(u) bold(u)^upright(T) - bold(I)) delta bold(r), quad w^2 = mu / r^3",
        "u is the unit radius. Gravity feeds a height error back with the wrong sign. Linear in the 61 numbers of "
        "[B-1], so the error is S p: within 0.5 % of the integrated INS on every row of GP-1 but one; everything "
        "together is off by 0.59 %.",
    ),
    Equation(
        "B-5",
        "Decoupled channels",
        "dot.double(x) + w^2 x = a_x, quad dot.double(z) - 2 w^2 z = a_z",
        "For a local frame that does not rotate; on a long arc they explain but do not predict.",
    ),
    Equation(
        "B-6",
        "Channels in closed form",
        "x &= b / w^2 (1 - cos w t) + (f epsilon) / w^2 (t - (sin w t) / w) + x_0 cos w t + v_0 / w sin w t + "
        "A / (w^2 - O^2) (sin O t - O / w sin w t) \\ "
        "z &= b / k^2 (cosh k t - 1) + (f epsilon) / k^2 ((sinh k t) / k - t) + z_0 cosh k t + v_0 / k sinh k t + "
        "A / (k^2 + O^2) (O / k sinh k t - sin O t), quad k = sqrt(2) w",
        "Accelerometer bias b, gyro bias ε under constant specific force f, start x₀ and v₀, oscillation A sin(O t).",
    ),
    Equation(
        "B-7",
        "Aiding by a star tracker, without a filter",
        "bold(C)_(b n) = bold(C)_(i n) (phi.alt, l + Omega t) thin bold(C)_(b i)",
        "The tracker's attitude takes the gyros' place at each frame, l is longitude; between frames the "
        "gyros carry on.",
    ),
    Equation(
        "B-8",
        "Star camera",
        'x = f_c X / Z, quad y = f_c Y / Z, quad "FOV" = 2 arctan (N p) / (2 f_c)',
        "Pin-hole: focal length, N pixels of pitch p.",
    ),
    Equation(
        "B-9",
        "Covariance of an attitude from stars",
        'bold(P)_"opt" &= sigma^2 (sum_k bold(I) - bold(b)_k bold(b)_k^upright(T))^(-1) \\ '
        'bold(P)_"TRIAD" &= sigma^2 (bold(I) + (bold(b)_1 dot.op bold(b)_2) (bold(b)_1 bold(b)_2^upright(T) '
        "+ bold(b)_2 "
        "bold(b)_1^upright(T)) / abs(bold(b)_1 times bold(b)_2)^2) \\ "
        'bold(P)_"N" &= sigma^2 / 4 sum_k [bold(w)_k times] (bold(I) - bold(b)_k bold(b)_k^upright(T)) '
        "[bold(w)_k times]^upright(T), quad bold(w)_k = (sum_j bold(b)_j bold(b)_j^upright(T))^(-1) bold(b)_k",
        "Optimal methods, TRIAD of two stars, and the N-vector after projection on a rotation; σ is the noise of a "
        "direction per axis. TRIAD's mean error has a heavy tail: two stars close together dominate it.",
    ),
)


def _place(equation: Equation) -> tuple[int, int]:
    letter, _, number = equation.mark.partition("-")
    return "TSPB".index(letter), int(number)


ALL_EQUATIONS: tuple[Equation, ...] = tuple(sorted((*EQUATIONS, *_BEYOND), key=_place))
"""Every equation of the product: navigation, radar, suborbital flight."""

_BEYOND_SYMBOLS: tuple[Symbol, ...] = (
    Symbol("S_p, S_n, S_e, S_c", "densities of drift, receiver, smoothed error, slow GNSS error", "m²·s",
           ("P-1", "P-2", "P-3", "P-4", "P-5")),
    Symbol("sigma_v, Delta t_v, s_v", "noise of one velocity fix, its interval, density", "m/s, s, m/s·√s",
           ("P-2", "P-6")),
    Symbol("sigma_c, tau", "slow GNSS error and its correlation time", "m, s", ("P-2",)),
    Symbol("S_d, S_a", "densities of line-of-sight displacement and acceleration", "m²·s, m²/s³", ("P-8", "P-12")),
    Symbol("w_b, tau_d", "bandwidth of the IMU, delay of its data at the radar", "rad/s, s", ("P-8",)),
    Symbol("p, p_k, J_0, J_1", "phase of a line, peak; Bessel functions", "rad, 1", ("P-9", "P-11")),
    Symbol("L, f_o, f_c", "phase noise of the oscillator, its frequency, the carrier", "dBc/Hz, Hz, Hz", ("P-10",)),
    Symbol("k_v, a_k", "vibration rectification, peak acceleration of a line", "s²/m, m/s²", ("P-12",)),
    Symbol("e, hat(e)_m", "error over the aperture, the polynomial of order m fitted to it", "m", ("T-14",)),
    Symbol("N, p", "in [T-16], [S-7] fixes in the aperture; in [B-8] pixels and their pitch", "1, m",
           ("T-16", "S-7", "B-8")),
    Symbol("bold(f), bold(omega)", "specific force and angular rate in body axes", "m/s², rad/s",
           ("B-1", "B-2", "B-3", "B-4")),
    Symbol("bold(B), bold(S), bold(N)", "bias, scale and misalignment errors of a sensor", "as sensed, 1, 1",
           ("B-1",)),
    Symbol("X_c, X_o, tau", "constant and oscillating part of a parameter, its period", "as X, s", ("B-1",)),
    Symbol("bold(C), bold(psi)", "rotation from body to the frame named, and its error", "1, rad",
           ("B-2", "B-3", "B-4", "B-7")),
    Symbol("bold(omega)_(i b), bold(omega)_(i e), bold(omega)_(e n)", "rates: body, Earth, transport", "rad/s",
           ("B-2",)),
    Symbol("mu, bold(r), bold(v)", "gravitational constant of the Earth, position, velocity", "m³/s², m, m/s",
           ("B-2", "B-3", "B-4")),
    Symbol("w, k", "Schuler rate at the radius; growth rate of a height error", "rad/s, 1/s",
           ("B-4", "B-5", "B-6")),
    Symbol("f_c, X, Y, Z", "focal length; a star's direction in camera axes", "m, 1", ("B-8",)),
    Symbol("bold(b)_k, sigma", "direction of star k in body axes, its noise per axis", "1, rad", ("B-9",)),
)  # fmt: skip

ALL_SYMBOLS: tuple[Symbol, ...] = (*SYMBOLS, *_BEYOND_SYMBOLS)


def with_cited(marks: Collection[str]) -> tuple[tuple[Equation, ...], tuple[Symbol, ...]]:
    """A report's equations and symbols, and of the others those cited by `marks` or by one another, in order."""
    wanted, found = {equation.mark for equation in EQUATIONS}, set(marks)
    while not found <= wanted:
        wanted |= found
        found = {mark for e in ALL_EQUATIONS if e.mark in wanted for mark in _CITED.findall(e.says)}
    equations = tuple(equation for equation in ALL_EQUATIONS if equation.mark in wanted)
    more = tuple(symbol for symbol in _BEYOND_SYMBOLS if not set(symbol.marks).isdisjoint(wanted))
    return equations, (*SYMBOLS, *more)


def source_of(mark: str) -> str:
    """Where an equation comes from."""
    letter, _, number = mark.partition("-")
    if letter == "T" and (int(number) <= 7 or 9 <= int(number) <= 12):
        return "[A] Makarem and Cheraghi Mahmudabadi 2019"
    if mark == "T-13":
        return "[C] Cheraghi Mahmudabadi, Makarem and Hatam"
    if letter == "B":
        return "derived here after [B] Moghtadaei Rad, Heyrani Nobari and Nikkhah, whose printed equations are lost"
    if mark in {"T-16", "S-7"}:
        return "derived here for the correction of [C] Cheraghi Mahmudabadi, Makarem and Hatam"
    return "derived here"
