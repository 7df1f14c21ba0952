"""A design as input of the strategies: for the ensemble of runs and for the closed forms."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from nav_model.aperture.window import Window
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.budget import smoothed as post_processed
from nav_model.budget.fast import not_flown
from nav_model.budget.inputs import CONSTANT_KEYS, VARYING_KEYS, Inputs, inputs_of
from nav_model.budget.real_time import RealTime, of_fast
from nav_model.budget.verdict import lowest_limit
from nav_model.design import Design
from nav_model.design.declaration import in_sentence
from nav_model.design.parts import quantity
from nav_model.design.processing import POST_PROCESSED
from nav_model.sar.advice import candidates, strategy_in_use
from nav_model.sar.axis_model import AxisModel
from nav_model.sar.flown_engine import ApertureFlight, flight_of
from nav_model.sar.focusing import Focusing
from nav_model.sar.line_of_sight import ApertureGeometry
from nav_model.sar.strategies import NAMES
from nav_model.sar.winners import Conditions, SmoothedVariances

Engine = Literal["fast", "simulator"]
"""The per-axis error model, and full flights of the simulator."""

_RATE_HZ = 100.0
_LEAST_SAMPLES, _MOST_SAMPLES = 256, 4096
_MOST_FIXES = 5000


@dataclass(frozen=True)
class DesignCase:
    """Case that the ensemble simulates: SI; vibration factor applied; ``rate`` [Hz] of the histories.

    ``focusing``: the autofocus, where the design has one with limits of its own. ``flight``: what the simulator
    flies; None for the fast engine.
    """

    models: tuple[AxisModel, AxisModel, AxisModel]
    geometry: ApertureGeometry
    aperture_time: float
    coast_time: float
    wavelength: float
    window: Window
    autofocus_order: int
    rate: float
    focusing: Focusing | None = None
    flight: ApertureFlight | None = None

    @property
    def engine(self) -> Engine:
        """The engine that runs it."""
        return "fast" if self.flight is None else "simulator"


def design_case(budget: Budget, engine: Engine = "fast") -> DesignCase:
    """The ensemble's inputs for a design.

    Raises
    ------
    InputError
        For a line of sight straight down or behind the horizon of the flight line, and for more fixes in the
        aperture or in the coast before it than are simulated (5000 each), and as `flight_of` for the simulator.
    """
    design, sar = budget.design, budget.sar
    radar, coast = design.radar, design.coast.before_aperture
    interval = design.gnss.interval
    for key, span in (("coast.before_aperture", coast), ("gnss.interval", sar.aperture_time)):
        if span / interval > _MOST_FIXES:
            excess = f"{span:.4g} s hold {span / interval:.4g} fixes"
            raise InputError(key, f"{excess}; strategies are simulated with at most {_MOST_FIXES}")
    if radar.grazing_angle >= math.radians(89.9):
        raise InputError("radar.grazing_angle", "Enter less than 89.9°: straight down gives no image.")
    try:
        geometry = ApertureGeometry(radar.slant_range, design.flight.speed, radar.grazing_angle, radar.squint_angle)
    except ValueError as error:
        raise InputError("radar.squint_angle", str(error)) from error
    needed = max(sar.aperture_time * _RATE_HZ, 8 * sar.aperture_time / interval)
    samples = min(max(math.ceil(needed), _LEAST_SAMPLES), _MOST_SAMPLES)
    x = inputs_of(design)
    velocities = x.velocity_of_fix or (0.0, 0.0)
    slow_level, slow_upright = (0.0, 0.0) if x.slow is None else (x.slow.horizontal, x.slow.vertical)
    level, down = (
        AxisModel(
            accelerometer_noise=float(x.sigma_a),
            gyro_noise=float(x.sigma_w),
            gnss_sigma=float(noise),
            fix_interval=interval,
            gravity=design.flight.gravity,
            accelerometer_bias=float(x.bias),
            gyro_bias=float(x.bias_w),
            horizontal=horizontal,
            slow_sigma=float(np.asarray(slow)),
            slow_time=design.gnss.correlation_time,
            velocity_sigma=float(velocity),
            leg_after=design.processing.leg_after,
        )
        for noise, velocity, slow, horizontal in (
            (x.fix, velocities[0], slow_level, True),
            (x.fix_vertical, velocities[1], slow_upright, False),
        )
    )
    return DesignCase(
        models=(level, level, down),
        geometry=geometry,
        aperture_time=sar.aperture_time,
        coast_time=coast,
        wavelength=sar.wavelength,
        window=sar.window,  # type: ignore[arg-type]
        autofocus_order=sar.autofocus_order,
        rate=samples / sar.aperture_time,
        focusing=_focusing(design, x),
        flight=flight_of(design, sar.aperture_time, coast) if engine == "simulator" else None,
    )


def conditions(
    budget: Budget, changes: Mapping[str, np.ndarray] | None = None, *, smoothed: bool = True
) -> Conditions:
    """The closed forms' inputs for a design, or for a grid about it.

    The state at the last fix is the one from which the budget starts the aperture, so that the INS after the outage
    and the whole-leg smoother have the budget's own figures.

    Parameters
    ----------
    budget : Budget
    changes : mapping, optional
        Dotted key -> values in SI instead of the design's, as `inputs_of` takes them; they broadcast together.
    smoothed : bool
        Whether the whole-leg smoother is wanted, too; on a grid it takes longer than all the others.
    """
    x = inputs_of(budget.design, changes)
    model, focusing = RealTime(x), _focusing(budget.design, x)
    after = x.autofocus_order if x.residual is None else x.residual
    largest = math.inf if focusing is None else focusing.largest
    start = model.at_last_fix
    return Conditions(
        aperture_time=x.aperture,
        gnss_sigma=x.fix,
        fix_interval=x.interval,
        accelerometer_noise=x.sigma_a,
        gyro_noise=x.sigma_w,
        start=start.horizontal,
        start_vertical=start.vertical,
        coast_time=x.before_aperture,
        gravity=x.g,
        accelerometer_bias=x.bias,
        gyro_bias=x.bias_w,
        grazing_angle=x.grazing_angle,
        vertical_gnss_sigma=x.fix_vertical,
        turn_rate=x.speed / x.slant_range,
        autofocus_order=x.autofocus_order,
        squint_angle=x.squint,
        slow=x.slow,
        slow_with_tilt=0.0 if x.slow is None else model.cycle.slow_with_tilt,
        smoothed=_smoothed(x, largest) if smoothed else None,
        post_processed=x.processing == POST_PROCESSED,
        contributors=x.contributors,
        to_phase=x.to_phase,
        fast=(
            sum(made.quadratic for made in x.fast.values()),
            sum(of_fast(made, after).detrended for made in x.fast.values()),
        ),
        residual=x.residual,
        estimation=0.0 if focusing is None else focusing.estimation,
        largest=largest,
    )


def _focusing(design: Design, x: Inputs) -> Focusing | None:
    """The design's autofocus with limits of its own, None without one."""
    used = design.autofocus
    if x.estimation is None or x.estimated is None:
        return None
    bins, amplitude = used.points
    bins = bins if used.range_bins is None else used.range_bins
    amplitude = amplitude if used.signal_to_clutter is None else used.signal_to_clutter
    to_phase = float(x.to_phase)
    limits = {"phase_before_autofocus": to_phase, "path_before_autofocus": 1.0}
    given = [
        limit.at_one_sigma / scale
        for name, scale in limits.items()
        if (limit := lowest_limit(design, name)) is not None
    ]
    estimation = float(x.estimation) * math.sqrt(float(x.estimated[2])) / to_phase
    return Focusing(used, float(bins), float(amplitude) ** 2, estimation, min(given))


def _smoothed(x: Inputs, largest: float) -> SmoothedVariances:
    """The whole-leg smoother's variances [m²] as the budget has them; where one sigma of the quadratic is beyond the
    largest [m] that an autofocus removes, before it. [P-5], [S-8]"""
    model = post_processed.Smoothed(x)
    quadratic = model.path_before_autofocus
    phase = np.where(quadratic > largest, model.detrended(1), model.detrended_phase)
    return SmoothedVariances(np.square(quadratic), np.square(phase / x.to_phase))


def judged(design: Design) -> str:
    """Key of the strategy whose figures the requirements are checked against, the budget's."""
    return strategy_in_use(**_options(design))


def able(design: Design) -> tuple[str, ...]:
    """Keys of the strategies that the design can use, the simplest first."""
    return candidates(**_options(design))


def _options(design: Design) -> dict[str, bool]:
    return {"post_processed": design.processing.mode == POST_PROCESSED, "outage": design.coast.before_aperture > 0}


def study_cautions(budget: Budget) -> tuple[str, ...]:
    """Cautions about the strategies for this design."""
    design, processing = budget.design, budget.design.processing
    cautions = []
    if design.gnss.velocity_noise is not None:
        cautions.append(
            "Velocity fixes are in the filter and in both smoothers, one with each position fix at noise of the same "
            "density. Both quadratic fits use the position fixes alone. The map varies the position noise alone."
        )
    if design.gnss.correlated:
        cautions.append(
            "The slow GNSS error is on: the filter estimates it [T-8], and both quadratic fits follow it. The map "
            "varies the white part of the position noise only."
        )
    if design.radar.squint_angle:
        cautions.append(
            "Squint lengthens the aperture by 1/cos [S-3], and the turning line of sight turns velocity errors of "
            "all axes into phase [S-8]. Cells and widths are measured across the line of sight."
        )
    cautions += not_flown(design)
    if design.autofocus.works:
        cautions.append(
            "Strategies are judged after the design's autofocus: its residual and its error of estimation [S-9], "
            "[S-10], and nothing removed where its limits are not met. Histories, responses and pictures of the "
            f"typical run are those of a {design.autofocus.method} at work on points in clutter."
        )
    beside = [key for key in (*VARYING_KEYS, *CONSTANT_KEYS) if design[key] and not key.endswith("correlation_time")]
    if beside:
        names = sorted({in_sentence(quantity(key).label) for key in beside})
        cautions.append(
            "The strategies' errors are those of noise, residual biases and the slow GNSS error. What the sheet "
            f"prints beside them ({', '.join(names)}) counts in the formulas [S-8] of {NAMES['2']} and {NAMES['9']} "
            "alone."
        )
    if design.contributors:
        cautions.append(
            "The design's contributors are in the detrended and the quadratic phase of formulas and runs. Parts of "
            "the error, histories, responses and images are of navigation errors alone."
        )
    if design.coast.before_aperture > 0:
        cautions.append(
            f"Only {NAMES['3']} flies {design.coast.before_aperture:.4g} s without fixes before the aperture; all "
            f"others have fixes throughout. Without fixes {NAMES['3']} is the only option in real time. The formula "
            f"of {NAMES['9']} counts the outage, its runs do not."
        )
    else:
        cautions.append(f"No outage before the aperture is set, so {NAMES['3']} equals {NAMES['2']}.")
    cautions.append(
        f"{NAMES['6']} and {NAMES['7']} are reconstructions: the literature names the schemes, not the gains. Gains "
        "are optimised for this design on separate seeds."
    )
    cautions.append(
        f"{NAMES['8']} uses fixes up to the aperture's end, so it bounds what real-time and in-aperture methods can "
        f"do. {NAMES['9']} needs post-processing: it also uses {processing.leg_after:.4g} s of fixes after the "
        "aperture, and estimates constant biases. "
        + (
            "The design is post-processed, so it can be the best."
            if processing.mode == POST_PROCESSED
            else "The design is processed in real time, so it is shown for reference."
        )
    )
    cautions.append(
        f"The formula of {NAMES['5']} assumes continuous fixes. With few fixes in the aperture its inertial part is "
        "low: by up to 6 % with a fix at both ends, by more if the aperture ends well after its last fix [T-16]."
    )
    return tuple(cautions)


def flight_cautions(budget: Budget) -> tuple[str, ...]:
    """Effects that are in the simulator's flights but not in the per-axis error model and the closed forms."""
    design = budget.design
    interval, coast = design.gnss.interval, design.coast.before_aperture
    cautions = [
        "The simulator flies straight and level over a rotating Earth with WGS 84 gravity, Schuler and Coriolis "
        "terms, coupled axes, sampled sensors, and a filter of nine states that settles before the aperture."
    ]
    if design.imu.accelerometer_bias or design.imu.gyro_bias:
        cautions.append(
            "Its residual biases act while no fix comes: on the free INS, not on strategies that take fixes in the "
            "aperture. In the error model they act on those too."
        )
    if design.gnss.correlated:
        cautions.append(
            "Its fixes carry the slow error, which its filter of nine states does not estimate; the error model's "
            "filter does. Expect strategies that use the filter to be worse here."
        )
    flown = round(coast / interval) * interval
    if abs(flown - coast) > 1e-6:
        cautions.append(f"The outage is rounded to whole fix intervals: {flown:.4g} s instead of {coast:.4g} s.")
    return tuple(cautions)
