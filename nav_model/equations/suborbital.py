"""Equations of the suborbital study, marks B. Derivations: docs/star_tracker.md."""

from __future__ import annotations

from nav_model.equations.entry import Equation

SUBORBITAL: tuple[Equation, ...] = (
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
