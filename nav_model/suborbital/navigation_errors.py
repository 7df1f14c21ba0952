"""Errors of an INS against the true flight.

The convention of star_tracker.md's printed final errors: the difference of the inertial position vectors, resolved in
north, east, up at the true position.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from nav_model.base.arrays import Array
from nav_model.earth.rotation import vector_from_matrix
from nav_model.earth.sphere import local_axes
from nav_model.suborbital.flight import TrueFlight
from nav_model.suborbital.mechanisation import InsRun


@dataclass(frozen=True)
class NavigationErrors:
    """Estimate minus truth of c cases at m instants, resolved at the true position.

    position_m: north, east, up (c, m, 3); velocity_m_s: inertial velocity error in north, east, up (c, m,
    3); down_range_m, cross_range_m (c, m), cross-range positive to the right of the track;
    attitude_inertial_rad: rotation vector of C_est C_true^T on inertial axes (c, m, 3);
    attitude_navigation_rad: the same of the body to north-east-down attitude, on those axes (c, m, 3),
    which contains the error of the estimated position.
    """

    time_s: Array
    position_m: Array = field(repr=False)
    velocity_m_s: Array = field(repr=False)
    down_range_m: Array = field(repr=False)
    cross_range_m: Array = field(repr=False)
    attitude_inertial_rad: Array = field(repr=False)
    attitude_navigation_rad: Array = field(repr=False)
    source: str

    histories: ClassVar[tuple[str, ...]] = (
        "position_m", "velocity_m_s", "down_range_m", "cross_range_m", "attitude_inertial_rad",
        "attitude_navigation_rad",
    )  # fmt: skip
    """Names of the arrays with a row per case."""

    def cases(self, which: slice) -> NavigationErrors:
        """The errors of the cases at these places alone."""
        return replace(self, **{name: getattr(self, name)[which] for name in self.histories})


def along_track(position_m: Array, track_rad: Array) -> tuple[Array, Array]:
    """Down-range and cross-range (c, m) of errors north, east, up (c, m, 3) on a track (m,)."""
    north, east, c, s = position_m[..., 0], position_m[..., 1], np.cos(track_rad), np.sin(track_rad)
    return north * c + east * s, -north * s + east * c


def navigation_errors(flight: TrueFlight, run: InsRun) -> NavigationErrors:
    """Errors of a run against the true flight; the position error is the one star_tracker.md prints."""
    truth = flight.position_i[run.index]
    turn = local_axes(truth)
    up = np.array([1.0, 1.0, -1.0])
    position = np.einsum("mji,cmj->cmi", turn, run.position_i - truth) * up
    velocity = np.einsum("mji,cmj->cmi", turn, run.velocity_i - flight.velocity_i[run.index]) * up
    down_range, cross_range = along_track(position, flight.track_rad[run.index])
    true_attitude = flight.attitude_bi[run.index]
    transposed = np.swapaxes(true_attitude, -1, -2)
    est_nav = np.swapaxes(local_axes(run.position_i), -1, -2) @ run.attitude_bi
    return NavigationErrors(
        time_s=run.time_s,
        position_m=position,
        velocity_m_s=velocity,
        down_range_m=down_range,
        cross_range_m=cross_range,
        attitude_inertial_rad=vector_from_matrix(run.attitude_bi @ transposed),
        attitude_navigation_rad=vector_from_matrix(est_nav @ transposed @ turn),
        source=run.source,
    )
