"""Where each number of a budget comes from: equation, method and caution, by its key in the JSON (`provenance.toml`).

Pages, reports and JSON share this table.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from nav_model.base.constants import MEAN_RADIUS
from nav_model.base.text.toml_text import shipped
from nav_model.budget.inputs import CONSTANT_KEYS, VARYING_KEYS, inputs_of
from nav_model.budget.navigation import steady_marks
from nav_model.budget.result import Budget
from nav_model.budget.smoothed import model_of
from nav_model.design import Design
from nav_model.design.catalogue import Entry
from nav_model.design.parts import OUTDATED
from nav_model.design.presets import entry_of, nearest_class
from nav_model.design.processing import REAL_TIME

_LEAST_ACCURACY = 0.1  # m: below, of carrier phase over a short baseline, whose noise is white
_SLOW = 60.0  # s, of multipath in flight
_LOWEST, _HIGHEST = -500.0, 9000.0  # ground on Earth [m], from the Dead Sea's shore to the highest summit

WIDE_SAWTOOTH = 0.5
"""lambda·dt above which a design is flagged: the closed form is then far from both ends of its cycle."""

_COUNTS = 0.1  # part of a figure from which a sensor's quantization is named

CLOSED, DISCRETE = "formula", "discrete Riccati equation, exact"
"""Methods of `provenance.toml` on which a slow GNSS error has an effect."""


@dataclass(frozen=True)
class Provenance:
    """Equation mark, method and, where one is due, a caution."""

    equation: str
    method: str
    note: str = ""


_TABLE: dict[str, Provenance] = {
    key: Provenance(**row) for key, row in shipped("nav_model.budget", "provenance").items()
}

_CYCLE = frozenset(key for key, entry in _TABLE.items() if entry.note == "rms over a fix interval")


_AFTER_A_FIX = "from the covariance just after a fix [T-8]"
_GROWN = ("[T-9]", "[T-17]", "[S-2]", "[S-5]", "[S-6]", "[S-8]", "[P-7]")
"""Marks of what grows after the last fix."""
_AUGMENTED_NOTE = "white noise only, without the slow GNSS error"


def provenance(budget: Budget) -> Mapping[str, Provenance]:
    """JSON key -> where that number comes from, for this budget.

    With a slow GNSS error the closed forms describe the white noise only and say so; the phase budget starts from
    their tilt and what the slow error adds to that just after a fix. So it is with biases that vary.
    """
    table = dict(_TABLE)
    if budget.design.gnss.velocity_noise is not None:
        table |= {key: replace(_TABLE[key], equation=steady_marks(budget.design)[0]) for key in _CYCLE}
        for key in ("steady_state.gyro_dominance", "steady_state.asymptote"):
            table[key] = replace(_TABLE[key], note="of position fixes alone; velocity fixes are left out")
    if budget.design.gnss.correlated:
        table = _with_slow_error(table)
    return MappingProxyType(table if budget.x.instability_a is None else _with_varying_biases(table))


def _with_varying_biases(table: Mapping[str, Provenance]) -> dict[str, Provenance]:
    changed = dict(table)
    for key, entry in table.items():
        if key.startswith("steady_state") and entry.method == CLOSED:
            changed[key] = replace(entry, note="; ".join(filter(None, (entry.note, "without varying biases"))))
        elif key.startswith(("steady_state.discrete", "post_processed")):
            changed[key] = replace(entry, equation=f"{entry.equation}, [T-19]")
        elif any(mark in entry.equation for mark in _GROWN):
            changed[key] = replace(entry, equation=f"{entry.equation}, [T-21]")
    return changed


def _with_slow_error(table: dict[str, Provenance]) -> dict[str, Provenance]:
    table = dict(table)
    for key, entry in tuple(table.items()):
        if key.startswith("steady_state") and entry.method == CLOSED:
            table[key] = replace(entry, note=_AUGMENTED_NOTE)
        elif entry.note.endswith(_AFTER_A_FIX):
            table[key] = replace(entry, note=f"{entry.note}, of the augmented filter")
        elif entry.method == DISCRETE:
            table[key] = replace(
                entry, method="augmented discrete Riccati equation", note=f"{entry.note}; slow GNSS error modelled"
            )
        elif key.startswith("sar.") and ("[S-5]" in entry.equation or "[S-8]" in entry.equation):
            table[key] = replace(
                entry, equation=f"{entry.equation}, [T-8]", note="with the tilt that the slow GNSS error adds"
            )
    return table


def cautions(budget: Budget) -> tuple[str, ...]:
    """Cautions about this budget, in sentences."""
    steady, coast, design = budget.steady_state, budget.coast, budget.design
    sentences: list[str] = []
    if steady.lambda_dt > WIDE_SAWTOOTH:
        moments = (steady.closed, steady.prior, steady.posterior)
        closed, prior, posterior = (moment["horizontal_position"] for moment in moments)
        prior, posterior = prior / closed, posterior / closed
        sentences.append(
            f"λ·dt = {steady.lambda_dt:.2g} exceeds 0.5, a wide sawtooth: horizontal position is {prior:.2f} "
            f"times the average just before a fix and {posterior:.2f} times just after it [T-8]."
        )
    for label, refined, polynomial in (
        ("horizontal", coast.refined_horizontal, coast.position_horizontal),
        ("vertical", coast.refined_vertical, coast.position_vertical),
    ):
        ratio = float(refined[-1] / polynomial[-1]) if len(polynomial) else 1.0
        if ratio > 1.05:
            sentences.append(
                f"At {coast.time[-1]:.4g} s the {label} polynomial is optimistic by "
                f"{100 * (1 - 1 / ratio):.0f} %; requirements are checked with Schuler and Coriolis terms [T-17]."
            )
    table = design.oscillator.phase_noise
    if table and table[0][0] * budget.sar.aperture_time > 1:
        sentences.append(
            f"The oscillator's table begins at {table[0][0]:.3g} Hz, above one cycle per aperture. Slower noise is "
            "not included."
        )
    sentences += _of_quantization(budget)
    if design.autofocus.works:
        sentence = "Errors that differ over the swath stay after autofocus and are in no figure."
        if (width := widest_swath(budget)) < design.radar.slant_range:
            sentence += (
                f" They exceed λ/16 at {design.requirements.confidence:g}σ at the edges of a swath wider than "
            )
            sentence += f"{width:.3g} m on the ground [S-9]."
        sentences.append(sentence)
    sentences += _of_white_noise(design)
    sentences += _of_receiver_class(design)
    sentences += [f"{key} has no effect any more: {OUTDATED[key][1]}." for key in design.outdated]
    sentences += [sentence for holds, sentence in _STANDING if holds(design)]
    return tuple(sentences)


def widest_swath(budget: Budget) -> float:
    """Swath [m] on the ground up to which the quadratic that differs from that of its middle is below λ/16. [S-9]

    At half of it the line of sight is W sin ψ/(2R) steeper, so the error across it in the vertical plane enters.
    """
    x = budget.x
    across = replace(x, grazing_angle=x.grazing_angle + math.pi / 2, fast={})
    quadratic = budget.design.requirements.confidence * np.sqrt(model_of(across).sight_variance("quadratic"))
    edge = x.wavelength / 16 / quadratic * x.slant_range / np.sin(x.grazing_angle)
    return 2 * float(edge)


def _of_quantization(budget: Budget) -> list[str]:
    """Cautions about counts of a sensor that show beside a figure: bounded, as the remainder is carried."""
    gyro, accelerometer = budget.design.gyro.quantization, budget.design.accelerometer.quantization
    parts = ((gyro, "tilt"), (accelerometer, "horizontal_velocity"), (accelerometer, "vertical_velocity"))
    return [
        f"One count of the {'gyros' if figure == 'tilt' else 'accelerometers'}, 1σ of its rounding, is "
        f"{count / math.sqrt(12) / sigma:.0%} of the {figure.replace('_', ' ')}. It is in no figure.".replace(
            "%", " %"
        )
        for count, figure in parts
        if count / math.sqrt(12) > _COUNTS * (sigma := budget.figure(figure).sigma)
    ]


def class_for_white_noise(design: Design) -> Entry | None:
    """The receiver class nearest to a design's accuracy where that seems to be taken for white noise; else None."""
    gnss = design.gnss
    stated = gnss.preset is not None or gnss.correlated or "gnss.position_noise" in design.origins
    return None if stated or gnss.position_noise <= _LEAST_ACCURACY else nearest_class(design)


def _of_white_noise(design: Design) -> list[str]:
    """A caution where a receiver's accuracy seems to be taken for white noise, with the figure that it would have
    were most of it slow."""
    gnss, noise, nearest = design.gnss, design.gnss.position_noise, class_for_white_noise(design)
    if nearest is None:
        return []
    vertical = gnss.vertical_position_noise
    slow = design.replace(
        {
            "gnss.correlated": True,
            "gnss.correlated_noise": noise,
            "gnss.vertical_correlated_noise": vertical,
            "gnss.correlation_time": _SLOW,
            "gnss.position_noise": noise / 10,
            "gnss.vertical_position_noise": None if vertical is None else vertical / 10,
        }
    )
    white, other = (float(model_of(inputs_of(each)).value("horizontal_position")) for each in (design, slow))
    return [
        f"Position noise of {noise:.3g} m counts as white, and fixes average it to {white:.3g} m of horizontal "
        f"position. Most of a receiver's accuracy stays for minutes: with {noise:.3g} m slow over {_SLOW:g} s, and a "
        f"tenth of it white, that is {other:.3g} m. Take a receiver class (gnss.preset, the nearest is "
        f'"{nearest.name}"), or give the slow error (gnss.correlated).'
    ]


def _of_receiver_class(design: Design) -> list[str]:
    """Cautions about a receiver class that the design takes beyond what its sheet holds for."""
    entry, sentences = entry_of(design, "gnss"), []
    if entry and entry.post_processed and design.processing.mode == REAL_TIME:
        sentences.append(
            f"The fixes of the receiver class {entry.name} are computed after the flight, but the design is judged "
            "in real time. Choose post-processed (processing.mode), or a receiver class of real time."
        )
    longest = entry and entry.extra.get("longest_baseline")
    if entry and longest and design.baseline is not None and design.baseline > longest.value:
        sentences.append(
            f"The sheet of the receiver class {entry.name} holds for a base station up to {longest.text} away; that "
            f"of the design is {design.baseline / 1e3:.4g} km away (gnss.baseline). Enter a nearer base, or choose a "
            "class without one."
        )
    return sentences


_STANDING: tuple[tuple[Callable[[Design], bool], str], ...] = (
    (
        lambda design: design.radar.squint_angle != 0,
        "Squint lengthens the aperture by 1/cos [S-3], and the turning line of sight then turns velocity errors of "
        "all axes into phase [S-8].",
    ),
    (
        lambda design: _rounded(design),
        "Neither fix interval is a whole multiple of the other. Post-processed figures take the nearest whole number "
        "of fixes, with the noise scaled to the same density.",
    ),
    (
        lambda design: design.coast.before_aperture > 0,
        "Post-processed position, velocity and tilt are those at mid-aperture, after any outage before it. "
        "Real-time values assume fixes throughout.",
    ),
    (
        lambda design: not _fix_after(design),
        "No fix falls in the time after the aperture, so post-processed figures rest on the fixes before and in "
        "it. They assume that a constant sensor bias is absorbed, which is then not so.",
    ),
    (
        lambda design: not _LOWEST < _ground(design) < _HIGHEST,
        "Altitude, slant range and grazing angle do not agree. The aircraft is the slant range times the sine of the "
        "grazing angle above the ground, and no ground on Earth is that far below this altitude. The verdict takes "
        "each as it is given.",
    ),
    (
        lambda design: design.radar.grazing_angle > math.radians(89.5),
        "At this grazing angle slant range barely determines ground range, so CE90 has no meaning.",
    ),
    (
        lambda design: design.imu.vibration_factor == 1,
        "A vibration factor of 1 assumes bench noise. In road tests, errors were 8 to 35 times larger.",
    ),
    (
        lambda design: design.imu.vibration_factor < 1,
        "A vibration factor below 1 assumes less noise than on the bench. In road tests, errors were 8 to 35 times "
        "larger than bench noise predicts.",
    ),
    (
        lambda design: design.imu.accelerometer_bias == 0 and design.imu.gyro_bias == 0,
        "Residual biases are set to zero: fully estimated before the last fix.",
    ),
    (
        lambda design: design.imu.accelerometer_bias > 0 or design.imu.gyro_bias > 0,
        "Residual biases count in full in the outage, and in real time in phase and image shift: as after a turn of "
        "60°. On a straight line the filter cancels that of the accelerometers by a tilt. Post-processed they cost "
        "that tilt alone, as the smoother absorbs them.",
    ),
    (
        lambda design: any(design[key] for key in VARYING_KEYS if not key.endswith("time")),
        "Biases that vary are states of the filter and in every figure [T-19], [T-21]. Tilt takes an instability in "
        "full [T-20], as fixes settle in a minute and tell tilt from bias after hours. Rate random walk counts in "
        "tilt and heading from the start of the leg, for as long as the outage [T-22].",
    ),
    (
        lambda design: any(design[key] for key in CONSTANT_KEYS),
        "Turn-on biases, misalignments, scale factor and g-sensitivity cost tilt and heading alone on a straight leg "
        "[T-22]; flights and runs have what turns make of them.",
    ),
    (
        lambda design: bool(design.gnss.correlated),
        "A slow GNSS error is on. Figures before and after a fix, the outage with Schuler and Coriolis terms, and "
        "the tilt at the aperture's start include it (augmented discrete filter); the curves by formula do not.",
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
            and design.imu.bandwidth is None
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
        lambda design: design.radar.autofocus_order > 1 and not design.autofocus.works,
        "Quadratic phase is quoted and checked before autofocus; detrended phase is what autofocus leaves. The "
        "polynomial is removed without noise, in any scene, however large it is. Choose a method under Autofocus for "
        "its limits (autofocus.method) [S-9], [S-10].",
    ),
    (
        lambda design: design.autofocus.works,
        "Quadratic, cubic and detrended phase are those after autofocus [S-9], with its error of estimation [S-10]. "
        "Place and CE90 stay as they are, as it never removes the line.",
    ),
    (
        lambda design: design.autofocus.works and design.radar.autofocus_order > 1,
        "Autofocus removes under Radar (radar.autofocus_order) has no effect: the section Autofocus takes its place.",
    ),
    (
        lambda design: design.autofocus.method != "none" and not design.autofocus.works,
        "Over the sea there are no points that stay, so the autofocus removes nothing.",
    ),
)


def _ground(design: Design) -> float:
    """Height [m] of the imaged ground above the ellipsoid: what slant range and angle leave of the altitude."""
    slant, angle = design.radar.slant_range, design.radar.grazing_angle
    return design.flight.altitude - slant * math.sin(angle) - (slant * math.cos(angle)) ** 2 / (2 * MEAN_RADIUS)


def _fix_after(design: Design) -> bool:
    gnss = design.gnss
    often = gnss.interval if gnss.velocity_noise is None else min(gnss.interval, gnss.velocity_interval or math.inf)
    return design.processing.leg_after >= often


def _rounded(design: Design) -> bool:
    """True if position and velocity fixes come at intervals of which neither divides the other, to a thousandth."""
    gnss = design.gnss
    if gnss.velocity_noise is None or gnss.velocity_interval is None:
        return False
    ratio = max(gnss.interval, gnss.velocity_interval) / min(gnss.interval, gnss.velocity_interval)
    return bool(abs(ratio - round(ratio)) > 1e-3 * ratio)
