"""The second engine: full flights of the simulator, as input of the strategies like the fast engine's runs.

Each run is flown three times on the same instrument noise: with fixes throughout, also in the leg after the aperture;
with fixes up to the start of the aperture, which gives the free INS; and, for strategy 3, with fixes up to the coast.
Errors are taken along the track, across it and down. The smoothers are those of the simulator's own filter of nine
states.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError
from nav_model.base.units import format_bound
from nav_model.design import Design
from nav_model.design.parts import quantity
from nav_model.sar.axis_model import AxisModel
from nav_model.sar.fast_engine import weight_of
from nav_model.sar.strategies import NavigationHistories, StrategyErrors, Tuning, apply_strategies
from nav_model.simulation.design_study import beside_noise, settling, specification
from nav_model.simulation.specification import HIGHEST_RATE, Aids, SimulationSpec

if TYPE_CHECKING:
    from nav_model.sar.flown_smoother import FlownSmoother
    from nav_model.simulation.single_run import RunRecord

_JUST_BEFORE = 1e-9  # s
_MOST_SAMPLES = 2_000_000  # of the instrument in one flight: a minute of a processor, and what a worker holds


class ApertureFlight(NamedTuple):
    """The flights: with fixes throughout, without from the aperture's start, and without from the coast's.

    ``start`` [s] of the aperture, at a fix; ``first``: which fix of the flight that is, counted from 0.
    """

    aided: SimulationSpec
    free: SimulationSpec
    coasted: SimulationSpec | None
    start: float
    first: int


def flight_of(design: Design, aperture_time: float, coast_time: float) -> ApertureFlight:
    """The flight of a design: straight and level, until its filter has settled, then the coast, then the aperture and
    the leg after it, as far as that affects the aperture.

    The coast is rounded to whole fix intervals.

    Raises
    ------
    InputError
        Naming the key of the design that makes a flight too long or cannot be flown.
    """
    interval, rate = design.gnss.interval, design.imu.rate
    before = settling(design)
    count = math.ceil((before + coast_time) / interval)
    of_aperture = count * interval + aperture_time + 2 / rate
    # Fixes beyond the time in which the filter settles say nothing about the aperture.
    length = of_aperture + min(design.processing.leg_after, before)
    if length * rate > _MOST_SAMPLES:
        most = min((_MOST_SAMPLES - 2) / (length - 2 / rate), HIGHEST_RATE)
        raise InputError(
            "imu.rate",
            f"{rate:g} Hz over {length:.4g} s, in which the filter settles ({before:.4g} s) and the leg after the "
            f"aperture follows ({length - of_aperture:.4g} s), are more than the simulator flies for a strategy; "
            f"give at most {format_bound(most, 'Hz', 'frequency', low=False)}, or use the error model",
        )
    start = round(count * interval * rate) / rate
    others = {key: quantity(key).default for key in beside_noise(design)}  # no model of the strategies has these
    plain = design.replace({**others, "filter.states": 9, "filter.initial_yaw": design.filter.initial_yaw})
    aided = replace(
        specification(plain, trajectory="straight", runs=1, duration=length, every=1 / rate),
        record_from=start, aiding=Aids(), radar_time_offset=0.0,  # neither model of the strategies has them
    )  # fmt: skip
    coast = round(coast_time / interval) * interval
    free = replace(aided, record_from=start, duration=of_aperture, outages=((start, of_aperture),))
    coasted = replace(free, outages=((start - coast, of_aperture),)) if coast > 0 else None
    return ApertureFlight(aided, free, coasted, start, count - 1)


def fly_axes(
    flight: ApertureFlight,
    models: tuple[AxisModel, AxisModel, AxisModel],
    aperture_time: float,
    rate: float,
    seed: int,
    first_run: int,
    runs: int,
    tuning: Tuning,
) -> list[StrategyErrors]:
    """Every strategy on each axis (along, across, down) of runs first_run .. first_run + runs - 1.

    The result does not depend on which process flies them.

    Parameters
    ----------
    flight : ApertureFlight
        The simulator's flights.
    models : tuple of AxisModel
        Of the axes; they give 5w its weight.
    aperture_time, rate : float
        Seconds, and samples per second of the histories.
    seed, first_run, runs : int
        Of the simulator's runs.
    tuning : Tuning
        Gains of the strategies 6 and 7.

    Raises
    ------
    ArithmeticError
        Where the filter's covariance stops being positive definite.
    """
    flown = histories(flight, aperture_time, rate, seed, first_run, runs)
    fixes = len(flown[0].fix_time)
    return [
        apply_strategies(axis, weight_of(model, aperture_time, fixes), tuning)
        for axis, model in zip(flown, models, strict=True)
    ]


def histories(
    flight: ApertureFlight, aperture_time: float, rate: float, seed: int, first_run: int, runs: int
) -> list[NavigationHistories]:
    """Error histories (runs, n) of the three axes over the aperture, n = T rate + 1.

    Parameters
    ----------
    flight, aperture_time, rate, seed, first_run, runs
        As `fly_axes`.
    """
    from nav_model.simulation.schedule import plan
    from nav_model.simulation.single_run import POSTERIOR, PRIOR, fly

    spec = flight.aided
    schedule = plan(spec)
    recorded, all_fixes = schedule.outputs.time_s[1:], schedule.fixes.time_s
    end = int(np.searchsorted(all_fixes, flight.start + aperture_time + 0.5 / spec.imu.rate))
    within = slice(flight.first, end)
    at = 1 + np.rint((all_fixes[flight.first :] - recorded[0]) * spec.imu.rate).astype(int)
    time = np.linspace(0.0, aperture_time, round(aperture_time * rate) + 1)
    heading = spec.trajectory.heading
    turn = np.array(
        [[math.cos(heading), math.sin(heading), 0], [-math.sin(heading), math.cos(heading), 0], [0, 0, 1]]
    )
    # The record has roll, pitch and yaw; the filter's covariance is of small angles.
    own_angles = np.linalg.inv(schedule.error_map[at])

    def sampled(values: Array, instants: Array) -> Array:
        """(2, outputs, 3), before and after, north, east, down -> (3, n), the aircraft's axes."""
        # Samples just before a fix and at it, so that nothing is interpolated across the filter's jump.
        both = np.column_stack([instants - _JUST_BEFORE, instants]).ravel()
        level = np.swapaxes(values[:, 1:] @ turn.T, 0, 1).reshape(-1, 3)
        return np.stack([np.interp(flight.start + time, both, column) for column in level.T])

    def flown(flight_spec: SimulationSpec) -> tuple[list[RunRecord], Array, Array]:
        """The runs of a flight, and their position and velocity errors (3, runs, n)."""
        instants = plan(flight_spec).outputs.time_s[1:]
        records = [fly(replace(flight_spec, seed=seed), run) for run in range(first_run, first_run + runs)]
        position, velocity = (
            np.stack([sampled(record.error[..., part], instants) for record in records], axis=1)
            for part in (slice(0, 3), slice(3, 6))
        )
        return records, position, velocity

    def at_fixes(phase: int) -> Array:
        """Errors (k, runs, 9) in the filter's own states, of the flight with fixes."""
        states = np.stack([record.error[phase, at] for record in records], axis=1)
        states[..., 6:9] = np.einsum("kij,krj->kri", own_angles, states[..., 6:9])
        return states

    records, position, velocity = flown(spec)
    _, free, free_speed = flown(flight.free)
    coasted = free if flight.coasted is None else flown(flight.coasted)[1]
    prior, posterior = at_fixes(PRIOR), at_fixes(POSTERIOR)
    fixes = tuple(all_fixes)
    smoother = _smoother(spec, fixes, flight.first, end)
    known, moments = end - flight.first, flight.start + time
    added = smoother.until(known).correction(moments, prior[:known], posterior[:known])
    in_leg = smoother.correction(moments, prior, posterior)
    errors = np.stack([record.fix_error[within] @ turn.T for record in records])
    jump = (posterior - prior)[:known, :, :3] @ turn.T
    jump[0] = 0.0  # the aperture starts just after its first fix
    return [
        NavigationHistories(
            time=time,
            fix_time=all_fixes[within] - flight.start,
            ins_position=free[axis],
            ins_velocity=free_speed[axis],
            coasted_position=coasted[axis],
            filter_position=position[axis],
            filter_velocity=velocity[axis],
            filter_correction=jump[:, :, axis].T,
            gnss_error=errors[:, :, axis],
            smoothed_position=position[axis] + (added @ turn.T)[:, :, axis],
            leg_position=position[axis] + (in_leg @ turn.T)[:, :, axis],
        )
        for axis in range(3)
    ]


@lru_cache(maxsize=2)
def _smoother(spec: SimulationSpec, fix_times: tuple[float, ...], first: int, end: int) -> FlownSmoother:
    from nav_model.sar.flown_smoother import flown_smoother

    fixes = np.array(fix_times)
    return flown_smoother(spec, fixes, first, min(end, len(fixes) - 1))
