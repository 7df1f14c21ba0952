"""Equations of the radar, marks S: line of sight, aperture, phase errors. Derivations: docs/sar.md."""

from __future__ import annotations

from nav_model.equations.entry import Equation

RADAR: tuple[Equation, ...] = (
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
        "S-4",
        "Limits on phase, in metres of line of sight",
        "pi / 4 = hat(lambda / 16), quad pi / 2 = hat(lambda / 8), quad pi = hat(lambda / 4)",
        "A hat reads: corresponds to.",
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
        "Detrended phase after autofocus, and cubic phase",
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
    Equation(
        "S-7",
        "GNSS noise through the quadratic fit",
        'sigma_"QPE" = T^2 / 4 sigma_"GNSS" sqrt(180 / (Delta t^4 N (N^2 - 1)(N^2 - 4)))',
        "In metres at the ends of the aperture.",
    ),
)
