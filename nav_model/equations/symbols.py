"""The symbols of the equations, with meaning and SI unit."""

from __future__ import annotations

from nav_model.equations.entry import Symbol

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
"""Those of every report."""

SYMBOLS_OF_CITED: tuple[Symbol, ...] = (
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
"""Those of equations that a report has only where something cites them."""
