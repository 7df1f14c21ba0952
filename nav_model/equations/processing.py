"""Equations of processing after the flight and of fast motion, marks P. Derivations: docs/processing.md."""

from __future__ import annotations

from nav_model.equations.entry import Equation

PROCESSING: tuple[Equation, ...] = (
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
        "The limit of dense white fixes for ever before and after: w₀ Δt up to 0.7 and 6/w₀ of fixes after the "
        "aperture, w₀ = (g σ_ω/s)^(1/3). The product computes every design in state space: the settled filter before "
        "the aperture, the fixes after it, and the two joined over it. Velocity has the density w² S_e.",
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
        "P-13",
        "Covariance along a flight",
        "bold(z) <- bold(Phi) bold(z) + bold(w), quad bold(z) <- (1 - bold(K) bold(H)) bold(z) + bold(K) bold(v)",
        "From node to node and at a fix. The gain acts on what the filter estimates; the rest is considered. Every "
        "source's covariance goes through the same gains.",
    ),
    Equation(
        "P-14",
        "Smoothed error along a flight",
        "bold(lambda) <- bold(H)^T bold(S)^(-1) bold(r) + (1 - bold(K) bold(H))^T bold(lambda), quad "
        "bold(lambda) <- bold(Phi)^T bold(lambda), quad bold(e) - bold(P) bold(lambda)",
        "Bryson and Frazier's smoother, backwards at a fix and over a step, and the smoothed error. It equals that "
        "of Rauch, Tung and Striebel.",
    ),
    Equation(
        "P-15",
        "Image errors along a flight",
        "c_m = sum_k bold(a)_(m k)^T bold(z)_k, quad bold(z)_k = bold(A)_k bold(z)_0 + bold(w)_k + bold(D)_k bold(n)",
        "Legendre coefficients of the line-of-sight error over an aperture: weighted sums of errors at its nodes, "
        "made of the error at its start, noises inside it and what later fixes say at its end.",
    ),
)
