"""Equations of navigation, marks T: error dynamics, steady state, outage, phase. Derivations: docs/theory.md."""

from __future__ import annotations

from nav_model.equations.entry import Equation

NAVIGATION: tuple[Equation, ...] = (
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
        "T-14",
        "Residual after a polynomial fit",
        "integral_0^T (e(t) - hat(e)_m (t))^2 (dif t) / T",
        "Each error process less its least-squares line (m = 1) or quadratic (m = 2) over the aperture. The "
        "coefficients of [T-15] and [S-6] are these integrals, exact.",
    ),
    Equation(
        "T-15",
        "Detrended phase after linear detrend",
        "sigma_phi^2 = ((4 pi) / lambda)^2 [cos^2 psi thin (g^2 p_33) / 720 T^4 + sigma_a^2 / 420 T^3 + "
        "cos^2 psi thin (17 g^2 sigma_omega^2) / 30240 T^5]",
        "Mean square over the aperture. Biases and a coast before the aperture add the terms of [S-6].",
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
)
