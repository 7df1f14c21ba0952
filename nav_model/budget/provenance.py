"""Where each number of a budget comes from: equation, method and caution, by its key in the JSON.

Pages, reports and JSON share this table.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

from nav_model.budget.result import Budget
from nav_model.design import Design
from nav_model.design.parts import OUTDATED

_TURN_SAID = 0.005  # part of the quadratic phase below which the turn of the line of sight is not mentioned

WIDE_SAWTOOTH = 0.5
"""lambda·dt above which a design is flagged: the closed form is then far from both ends of its cycle."""

INPUT, CLOSED, DISCRETE, SERIES, RESPONSE, SMOOTHER, STEP = (
    "input",
    "closed form",
    "discrete Riccati equation, solved in closed form",
    "linear covariance propagation",
    "aperture integral",
    "fixed-interval smoother, in state space",
    "derivative by the size of each source",
)


@dataclass(frozen=True)
class Provenance:
    """Equation mark, method and, where one is due, a caution."""

    equation: str
    method: str
    note: str = ""


_TABLE: dict[str, Provenance] = {
    "steady_state.position_sigma_m.horizontal": Provenance("[T-3]", CLOSED, "cycle rms"),
    "steady_state.position_sigma_m.vertical": Provenance("[T-4]", CLOSED, "cycle rms"),
    "steady_state.velocity_sigma_m_s.horizontal": Provenance("[T-3]", CLOSED, "cycle rms"),
    "steady_state.velocity_sigma_m_s.vertical": Provenance("[T-4]", CLOSED, "cycle rms"),
    "steady_state.tilt_sigma_rad": Provenance("[T-3]", CLOSED, "cycle rms"),
    "steady_state.gyro_dominance": Provenance("[T-6]", CLOSED),
    "steady_state.asymptote": Provenance("[T-7]", CLOSED, "holds for gyro dominance far above one"),
    "steady_state.shares": Provenance("[T-18]", STEP, "of the average between fixes"),
    "steady_state.lambda_dt": Provenance("[T-8]", CLOSED),
    "steady_state.discrete.prior": Provenance("[T-8]", DISCRETE, "just before a fix"),
    "steady_state.discrete.posterior": Provenance("[T-8]", DISCRETE, "just after a fix"),
    "coast.time_s": Provenance("", INPUT, "seconds since the last fix"),
    "coast.position_sigma_m": Provenance("[T-9], [T-10]", CLOSED, "biases in quadrature"),
    "coast.velocity_sigma_m_s": Provenance("[T-9], [T-10]", CLOSED, "biases in quadrature"),
    "coast.tilt_sigma_rad": Provenance("[T-9]", CLOSED, "gyro bias in quadrature"),
    "coast.yaw_growth_rad": Provenance("[T-5]", CLOSED, "growth alone; the initial yaw error adds"),
    "coast.refined_position_sigma_m": Provenance("[T-17]", SERIES, "biases in quadrature"),
    "coast.perfect_start_position_sigma_m": Provenance("[T-11]", CLOSED),
    "coast.initial_tilt_position_sigma_m": Provenance("[T-12]", CLOSED),
    "coast.end.time_s": Provenance("", INPUT, "coast.duration"),
    "coast.end.refined_position_sigma_m": Provenance("[T-17]", SERIES, "biases in quadrature"),
    "coast.end.shares": Provenance("[T-17], [T-18]", STEP, "of the refined curve's end"),
    "sar.wavelength_m": Provenance("[T-13]", CLOSED),
    "sar.aperture_time_s": Provenance("[S-3]", CLOSED),
    "sar.aperture_length_m": Provenance("[S-3]", CLOSED),
    "sar.cell_length_m": Provenance("[S-3]", CLOSED, "first null of the unweighted response"),
    "sar.autofocus_order": Provenance("", INPUT),
    "sar.quadratic_phase_sigma_rad": Provenance("[S-5]", CLOSED, "before autofocus"),
    "sar.cubic_phase_sigma_rad": Provenance("[S-6]", CLOSED, "before autofocus"),
    "sar.detrended_phase_sigma_rad": Provenance("[T-15], [S-6]", CLOSED, "after autofocus"),
    "sar.lines": Provenance("[S-5], [S-6]", CLOSED),
    "sar.initial_tilt_shares": Provenance("[T-18]", STEP),
    "sar.along_track_quadratic_phase_sigma_rad": Provenance(
        "[S-2]", CLOSED, "separate; not part of the quadratic phase total"
    ),
    "sar.impulse_response": Provenance("[S-3], [S-5]", RESPONSE, "1σ quadratic phase, before autofocus"),
    "sar.impulse_response_after_autofocus": Provenance(
        "[S-3], [S-5]", RESPONSE, "1σ quadratic phase if autofocus_order is 1, else no quadratic phase"
    ),
    "processing.mode": Provenance("", INPUT),
    "post_processed": Provenance("[P-3], [P-5]", SMOOTHER, "fixes before, in and after the aperture"),
    "post_processed.tilt_sigma_rad": Provenance("[P-5]", SMOOTHER),
    "post_processed.lines": Provenance("[P-4]", SMOOTHER, "shares of the quadratic phase's variance"),
    "post_processed.turning_quadratic_phase_sigma_rad": Provenance(
        "[P-5], [S-2]", SMOOTHER, "both quadratic phases, and the effect of the turn on position"
    ),
    "post_processed.turning_detrended_phase_by_order_sigma_rad": Provenance(
        "[P-5], [S-2]", SMOOTHER, "residuals along the line of sight as it turns"
    ),
    "post_processed.azimuth_shift_sigma_m": Provenance("[P-5]", SMOOTHER, "without the position along the track"),
    "geolocation": Provenance("[P-7]", CLOSED, "flat scene; azimuth first, then ground range"),
    "spectral.echoes": Provenance("[P-8], [P-9]", CLOSED, "lines beyond the main lobe, highest first"),
    "spectral.islr_db": Provenance("[P-11]", CLOSED, "of fast phase errors alone; the window's side lobes add"),
    "spectral.peak_loss_db": Provenance("[P-11]", CLOSED, "of fast phase errors alone"),
    "spectral.islr_shares": Provenance("[P-11]", CLOSED),
    "verdict": Provenance("[T-8], [T-17], [S-2], [S-5], [P-3]", "comparison with the limits"),
    "other_verdict": Provenance("[T-8], [T-17], [S-2], [S-5], [P-3]", "the same limits, processed the other way"),
}

_CYCLE = frozenset(key for key, entry in _TABLE.items() if entry.note == "cycle rms")


def steady_marks(design: Design) -> tuple[str, str]:
    """Marks of the steady state's equations, horizontal and vertical; velocity fixes have another equation."""
    return ("[T-3]", "[T-4]") if design.gnss.velocity_noise is None else ("[P-6]", "[P-6]")


_AUGMENTED_NOTE = "no closed form covers the slow GNSS error; white noise only"


def provenance(budget: Budget) -> Mapping[str, Provenance]:
    """JSON key -> where that number comes from, for this budget.

    With a slow GNSS error the closed forms describe the white noise only and say so; the phase budget starts from
    their tilt and what the slow error adds to that just after a fix.
    """
    table = dict(_TABLE)
    if budget.design.gnss.velocity_noise is not None:
        table |= {key: replace(_TABLE[key], equation=steady_marks(budget.design)[0]) for key in _CYCLE}
        for key in ("steady_state.gyro_dominance", "steady_state.asymptote"):
            table[key] = replace(_TABLE[key], note="of position fixes alone; velocity fixes are left out")
    if not budget.design.gnss.correlated:
        return MappingProxyType(table)
    for key, entry in tuple(table.items()):
        if key.startswith(("steady_state", "coast")) and entry.method == CLOSED:
            table[key] = Provenance(entry.equation, entry.method, _AUGMENTED_NOTE)
        elif entry.method == SERIES:
            table[key] = Provenance(
                entry.equation, entry.method, f"{entry.note}; from the augmented filter's posterior"
            )
        elif entry.method == DISCRETE:
            table[key] = Provenance(
                entry.equation, "augmented discrete Riccati equation", f"{entry.note}; slow GNSS error modelled"
            )
        elif key.startswith("sar.") and "[S-5]" in entry.equation:
            table[key] = Provenance(
                f"{entry.equation}, [T-8]", entry.method, "with the tilt that the slow GNSS error adds"
            )
    return MappingProxyType(table)


def cautions(budget: Budget) -> tuple[str, ...]:
    """Cautions about this budget, in sentences."""
    steady, coast, design = budget.steady_state, budget.coast, budget.design
    said: list[str] = []
    if steady.lambda_dt > WIDE_SAWTOOTH:
        closed = steady.closed.position_horizontal
        prior, posterior = (m.position_horizontal / closed for m in (steady.prior, steady.posterior))
        said.append(
            f"λ·dt = {steady.lambda_dt:.2g} exceeds 0.5, a wide sawtooth: horizontal position is {prior:.2f} "
            f"times the average just before a fix and {posterior:.2f} times just after it [T-8]."
        )
    for label, refined, polynomial in (
        ("horizontal", coast.refined_horizontal, coast.position_horizontal),
        ("vertical", coast.refined_vertical, coast.position_vertical),
    ):
        ratio = float(refined[-1] / polynomial[-1]) if len(polynomial) else 1.0
        if ratio > 1.05:
            said.append(
                f"At {coast.time[-1]:.4g} s the {label} polynomial is optimistic by "
                f"{100 * (1 - 1 / ratio):.0f} %; requirements are checked with Schuler and Coriolis terms [T-17]."
            )
    table = design.oscillator.phase_noise
    if table and table[0][0] * budget.sar.aperture_time > 1:
        said.append(
            f"The oscillator's table begins at {table[0][0]:.3g} Hz, above one cycle per aperture. Slower noise is "
            "not included."
        )
    if (smoothed := budget.smoothed) is not None:
        counted = math.hypot(*(smoothed.navigation[f"{name}quadratic_phase"] for name in ("", "along_track_")))
        change = smoothed.turning_quadratic / counted - 1
        if abs(change) > _TURN_SAID:
            said.append(
                "The line of sight turns over the aperture. The along-track phase [S-2] has its effect on velocity "
                f"errors. Its effect on position errors {'raises' if change > 0 else 'lowers'} quadratic and "
                f"along-track phase together by {100 * abs(change):.2g} %; the verdict does not include it [P-5]."
            )
        order = budget.sar.autofocus_order
        change = smoothed.turning_by_order[order - 1] / smoothed.by_order[order - 1] - 1 if order < 3 else 0.0
        if abs(change) > _TURN_SAID:
            said.append(
                f"The residual after autofocus of order {order} is along the line of sight of mid-aperture. With the "
                f"turn it is {100 * abs(change):.2g} % {'larger' if change > 0 else 'smaller'}, which the verdict "
                "leaves out [P-5]."
            )
    said += [f"{key} has no effect any more: {OUTDATED[key][1]}." for key in design.outdated]
    said += [sentence for holds, sentence in _STANDING if holds(design)]
    return tuple(said)


_STANDING: tuple[tuple[Callable[[Design], bool], str], ...] = (
    (
        lambda design: design.radar.squint_angle != 0,
        "Squint lengthens the aperture by 1/cos [S-3] and multiplies the along-track quadratic phase by cos² "
        "[S-2]. The line-of-sight weights [S-1] stay, since both horizontal axes have the same errors. The SAR "
        "page has the effect of the turning line of sight on velocity errors of the other axes.",
    ),
    (
        lambda design: _rounded(design),
        "Neither fix interval is a whole multiple of the other. Post-processed figures take the nearest whole number "
        "of fixes, with the noise that keeps their density.",
    ),
    (
        lambda design: design.coast.before_aperture > 0,
        "Post-processed position, velocity and tilt are those in the middle of the aperture, after the time without "
        "fixes before it. In real time they are those with fixes throughout.",
    ),
    (
        lambda design: not _fix_after(design),
        "No fix comes in the time after the aperture: post-processed figures rest on the fixes before and in it "
        "alone. They take a constant sensor bias for absorbed, which then it is not.",
    ),
    (
        lambda design: design.radar.grazing_angle > math.radians(89.5),
        "At this grazing angle the range says next to nothing about the ground range: CE90 has no meaning.",
    ),
    (
        lambda design: design.imu.vibration_factor == 1,
        "A vibration factor of 1 assumes bench noise. In road tests, errors were 8 to 35 times larger.",
    ),
    (
        lambda design: design.imu.accelerometer_bias == 0 and design.imu.gyro_bias == 0,
        "Residual biases are set to zero: fully estimated before the last fix.",
    ),
    (
        lambda design: bool(design.gnss.correlated),
        "A slow GNSS error is on. Figures before and after a fix, the outage with Schuler and Coriolis terms, and "
        "the tilt at the aperture's start include it (augmented discrete filter); the closed-form curves do not.",
    ),
    (
        lambda design: (
            design.gnss.velocity_noise is not None
            and design.gnss.velocity_interval not in (None, design.gnss.interval)
        ),
        "Real-time figures take velocity with each position fix, its noise scaled to the same density. Where "
        "velocity comes 10 times as often, figures before a fix are up to 11 % high, figures after it up to 9 % low "
        "and the outage up to 3 % low. Where it comes a tenth as often, all are up to 14 % low in the last interval "
        "before a velocity fix. With a slow GNSS error it is up to 30 % and 60 %. Post-processed figures take the "
        "velocity interval as it is.",
    ),
    (
        lambda design: (
            bool(design.motion.lines or design.motion.spectrum)
            and design.motion.imu_bandwidth is None
            and design.motion.delay == 0
        ),
        "Vibration is given without an IMU bandwidth and without a delay to the radar, so all of it counts as "
        "compensated.",
    ),
    (
        lambda design: bool(design.motion.spectrum) and design.imu.vibration_factor > 1,
        "Vibration counts twice: as a spectrum, and as noise in the vibration factor. With a spectrum, set the "
        "factor to 1.",
    ),
    (
        lambda design: design.radar.autofocus_order > 1,
        "Quadratic phase is quoted and checked before autofocus; detrended phase is what autofocus leaves.",
    ),
)


def _fix_after(design: Design) -> bool:
    gnss = design.gnss
    often = gnss.interval if gnss.velocity_noise is None else min(gnss.interval, gnss.velocity_interval or math.inf)
    return design.processing.leg_after >= often


def _rounded(design: Design) -> bool:
    """Whether position and velocity fixes come at intervals of which neither divides the other, to a thousandth."""
    gnss = design.gnss
    if gnss.velocity_noise is None or gnss.velocity_interval is None:
        return False
    ratio = max(gnss.interval, gnss.velocity_interval) / min(gnss.interval, gnss.velocity_interval)
    return bool(abs(ratio - round(ratio)) > 1e-3 * ratio)
