"""The figures of real time: those of the image here, those of the filter and of an outage in `filter_figures`.

Each member of `RealTime` that has the name of a figure (`nav_model.design.figures`) is its formula: one sigma in SI,
without contributors. Any input may be an array; all broadcast together, and complex numbers pass through, so that a
complex step differentiates every figure but those of the impulse response exactly.
"""

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import TypeVar

import numpy as np

from nav_model.analytic.turning import LEFT_OF_ORDER, Bend, Turn, free_bend, turn_of
from nav_model.aperture import phase
from nav_model.aperture.autofocus import KINDS, Residual
from nav_model.aperture.geometry import line_of_sight_weights
from nav_model.base.arrays import Array
from nav_model.budget.fast import levels
from nav_model.budget.filter_figures import FilterFigures
from nav_model.budget.inputs import RECTIFICATION, Inputs
from nav_model.budget.response import measures
from nav_model.budget.varying import VARYING, Columns
from nav_model.processing.fast_motion import Fast
from nav_model.processing.geolocation import (
    NINETY,
    AxisError,
    Shifts,
    circular_error,
    free_line,
    ground_covariance,
    shifts,
)
from nav_model.processing.smoother import SmoothedError

Pairs = Columns | SmoothedError
Pair = TypeVar("Pair", Bend, AxisError)


class RealTime(FilterFigures):
    """Figures of one design, or of arrays of designs, in real time."""

    # The phase over the aperture: variances along the line of sight of mid-aperture, by source; then of the image,
    # along the line of sight as it turns.

    @cached_property
    def to_phase(self) -> Array:
        """As of the inputs; the workbook puts a cell in its place. [T-13]"""
        return self.x.to_phase

    def phase_by_source(self, after: int | Residual) -> Mapping[str, phase.PhaseVariances]:
        """Line-of-sight variances over the aperture, source by source, after a polynomial of an order or what an
        autofocus leaves. [S-5], [S-9]"""
        x, start = self.x, self.at_last_fix.horizontal
        arguments = x.g, x.aperture, x.before_aperture, x.grazing_angle, after
        by_source = phase.phase_budget(start.p33, x.sigma_a, x.sigma_w, x.bias_a, x.bias_w, *arguments)
        fast = {name: of_fast(effect, after) for name, effect in x.fast.items()}
        if x.rectified is not None:
            of_bias = phase.phase_budget(0.0, 0.0, 0.0, x.rectified, 0.0, *arguments)
            fast[RECTIFICATION] = of_bias["accelerometer bias"]
        if self.varying is not None:
            columns = self.varying.over_aperture
            fast[VARYING] = residual_of(lambda name: line_of_sight(columns[name], x.grazing_angle), after)
        return {**by_source, **fast} if fast else by_source

    @cached_property
    def phases(self) -> Mapping[str, phase.PhaseVariances]:
        """Variances of phase after the design's autofocus."""
        return self.phase_by_source(self.x.autofocus_order if self.x.residual is None else self.x.residual)

    @cached_property
    def phases_before(self) -> Mapping[str, phase.PhaseVariances]:
        """Variances of phase before an autofocus with limits of its own; without one, as `phases`."""
        return self.phases if self.x.residual is None else self.phase_by_source(self.x.autofocus_order)

    @cached_property
    def _before(self) -> phase.PhaseVariances:
        return phase.total(self.phases_before)

    def sight_variance(self, column: str) -> Array:
        """Variance [m²] along the line of sight of mid-aperture: of "quadratic", "cubic", or of what polynomials
        leave, "left_1" to "left_3"."""
        order = int(column.removeprefix("left_")) if column.startswith("left_") else self.x.autofocus_order
        whole = self._before if order == self.x.autofocus_order else phase.total(self.phase_by_source(order))
        return getattr(whole, column if column in whole._fields else "detrended")  # type: ignore[no-any-return]

    def sight_residual(self, kind: str) -> Array:
        """Variance [m²] along the line of sight of mid-aperture that an autofocus leaves of the "quadratic", the
        "cubic" or the mean square, "detrended"."""
        return getattr(phase.total(self.phases), kind)  # type: ignore[no-any-return]

    @cached_property
    def turn(self) -> Turn:
        """Turn of the line of sight over the aperture. [S-8]"""
        x = self.x
        return turn_of(x.grazing_angle, x.squint, x.speed / x.slant_range, x.aperture)

    @cached_property
    def quadratic_bend(self) -> tuple[Bend, Bend]:
        """Covariances of the turn's functionals, of a horizontal axis and the vertical: for the quadratic. [S-8]"""
        return self._bend("quadratic")

    @cached_property
    def cubic_bend(self) -> tuple[Bend, Bend]:
        """Covariances of the turn with the cubic, of a horizontal axis and of the vertical."""
        return self._bend("cubic")

    def _bend(self, kind: str) -> tuple[Bend, Bend]:
        x, start = self.x, self.at_last_fix
        inside = x.g, x.before_aperture, x.aperture
        closed = (
            free_bend(kind, start.horizontal, x.sigma_a, x.sigma_w, x.bias, x.bias_w, *inside),
            free_bend(kind, start.vertical, x.sigma_a, 0.0, x.bias, 0.0, *inside),
        )
        return closed if self.varying is None else summed(closed, bends_of(self.varying.over_aperture, kind))

    def bends(self, kind: str) -> tuple[Bend, Bend]:
        """Covariances of the turn with the "quadratic" or the "cubic"."""
        return self.quadratic_bend if kind == "quadratic" else self.cubic_bend

    def _along_track(self, kind: str) -> Array:
        """Variance [m²] of the quadratic or the cubic of errors along the track alone: their velocity. [S-2]"""
        x = self.x
        turn = x.speed * np.cos(x.squint) ** 2 * x.aperture / (2 * x.slant_range)
        variance: Array = turn**2 * self.bends(kind)[0].turned
        return variance

    @property
    def phase_before_autofocus(self) -> Array:
        return self.to_phase * self.path_before_autofocus

    @property
    def path_before_autofocus(self) -> Array:
        return np.sqrt(self.sight_variance("quadratic") + self.turn.bent(*self.quadratic_bend))

    @property
    def autofocus_estimation(self) -> Array:
        return np.asarray(0.0) if self.x.estimation is None else self.x.estimation

    def _focused(self, kind: str) -> Array | None:
        """Phase [rad] of the image after the design's autofocus: "quadratic", "cubic" or "detrended"; None without
        one. [S-9], [S-10]"""
        x, k = self.x, KINDS.index(kind)
        if x.residual is None or x.estimation is None or x.estimated is None:
            return None
        bend = float(x.residual.quadratic[k]) * self.turn.bent(*self.quadratic_bend)
        bend = bend + float(x.residual.cubic[k]) * self.turn.bent(*self.cubic_bend)
        variance = self.to_phase**2 * (self.sight_residual(kind) + bend)
        focused: Array = np.sqrt(variance + float(x.estimated[k]) * x.estimation**2)
        return focused

    @property
    def quadratic_phase(self) -> Array:
        focused = self._focused("quadratic")
        return self.phase_before_autofocus if focused is None else focused

    @property
    def cubic_phase(self) -> Array:
        if (focused := self._focused("cubic")) is not None:
            return focused
        return self.to_phase * np.sqrt(self.sight_variance("cubic") + self.turn.bent(*self.cubic_bend))

    @property
    def detrended_phase(self) -> Array:
        focused = self._focused("detrended")
        return self.detrended(self.x.autofocus_order) if focused is None else focused

    def detrended(self, order: int) -> Array:
        """Phase [rad] that is left after autofocus of an order: of the orders beyond the next, which the turn hardly
        changes, and the next one with the turn. [S-8]"""
        variance = self.sight_variance(f"left_{order}")
        if order in LEFT_OF_ORDER:
            kind, factor = LEFT_OF_ORDER[order]
            variance = variance + factor * self.turn.bent(*self.bends(kind))
        return self.to_phase * np.sqrt(variance)

    detrended_phase_1 = property(lambda self: self.detrended(1))
    detrended_phase_2 = property(lambda self: self.detrended(2))
    detrended_phase_3 = property(lambda self: self.detrended(3))

    @property
    def line_of_sight_quadratic_phase(self) -> Array:
        return self._along_sight("quadratic", "quadratic")

    @property
    def line_of_sight_cubic_phase(self) -> Array:
        return self._along_sight("cubic", "cubic")

    @property
    def line_of_sight_detrended_phase(self) -> Array:
        return self._along_sight("detrended", f"left_{self.x.autofocus_order}")

    def _along_sight(self, kind: str, column: str) -> Array:
        """Phase [rad] along the line of sight of mid-aperture: what the design's autofocus leaves, or a column."""
        variance = self.sight_variance(column) if self.x.residual is None else self.sight_residual(kind)
        return self.to_phase * np.sqrt(variance)

    def sight_detrended(self, order: int) -> Array:
        """Phase [rad] along the line of sight of mid-aperture that is left after autofocus of an order."""
        return self.to_phase * np.sqrt(self.sight_variance(f"left_{order}"))

    @property
    def along_track_quadratic_phase(self) -> Array:
        return self.to_phase * np.sqrt(self._track_residual("quadratic", "quadratic"))

    @property
    def along_track_cubic_phase(self) -> Array:
        return self.to_phase * np.sqrt(self._track_residual("cubic", "cubic"))

    @property
    def along_track_detrended_phase(self) -> Array:
        kind, factor = LEFT_OF_ORDER.get(self.x.autofocus_order, ("cubic", 0.0))
        return self.to_phase * np.sqrt(self._track_residual("detrended", kind, factor))

    def _track_residual(self, measure: str, kind: str, factor: float = 1.0) -> Array:
        """Variance [m²] of errors along the track alone: what the design's autofocus leaves in a measure, or a part
        of the "quadratic" or the "cubic"."""
        residual, k = self.x.residual, KINDS.index(measure)
        if residual is None:
            return factor * self._along_track(kind)
        quadratic, cubic = float(residual.quadratic[k]), float(residual.cubic[k])
        variance: Array = quadratic * self._along_track("quadratic") + cubic * self._along_track("cubic")
        return variance

    # The place of the image.

    @property
    def lines(self) -> tuple[AxisError, AxisError]:
        """Line in the position error over the aperture, horizontal and vertical. [P-7]"""
        x, start = self.x, self.at_last_fix
        inside = x.before_aperture, x.aperture
        closed = (
            free_line(start.horizontal, x.sigma_a, x.sigma_w, x.bias, x.bias_w, x.g, *inside),
            free_line(start.vertical, x.sigma_a, 0.0, x.bias, 0.0, x.g, *inside),
        )
        return closed if self.varying is None else summed(closed, lines_of(self.varying.over_aperture))

    @cached_property
    def shift(self) -> Shifts:
        """Variances of the image's shift. [P-7]"""
        x = self.x
        return with_range_errors(x, shifts(*self.lines, x.grazing_angle, x.slant_range, x.speed, x.squint))

    @cached_property
    def ground(self) -> tuple[Array, Array, Array]:
        """Variances of the image's place in azimuth and ground range, and their covariance, m². [P-7]"""
        x = self.x
        return ground_covariance(self.shift, x.grazing_angle, x.scene_height_error, x.squint)

    @property
    def azimuth_shift(self) -> Array:
        return np.sqrt(self.shift.azimuth)

    @property
    def range_shift(self) -> Array:
        return np.sqrt(self.shift.range)

    @property
    def ce90(self) -> Array:
        return circular_error(*self.ground, share=0.9)

    @property
    def cep(self) -> Array:
        return circular_error(*self.ground, share=0.5)

    @property
    def le90(self) -> Array:
        return NINETY * np.sqrt(self.shift.height + self.x.scene_height_error**2)

    # What vibration, unsensed motion and oscillator scatter.

    @cached_property
    def _levels(self) -> dict[str, Array]:
        x = self.x
        return levels(x.fast.values(), x.to_phase, x.aperture, x.window, x.scattered_by_estimation)

    paired_echo = property(lambda self: self._levels["paired_echo"])
    islr = property(lambda self: self._levels["islr"])

    # The azimuth impulse response with the quadratic phase at one sigma, contributors included.

    @cached_property
    def _response(self) -> dict[str, Array]:
        return measures(self.x, self.sigma("quadratic_phase"))

    response_width = property(lambda self: self._response["response_width"])
    pslr = property(lambda self: self._response["pslr"])
    response_islr = property(lambda self: self._response["response_islr"])
    peak_loss = property(lambda self: self._response["peak_loss"])


def line_of_sight(column: Array | tuple[Array, Array], grazing_angle: Array) -> Array:
    """Variance along the line of sight from those of a horizontal axis and the vertical. [S-1]"""
    horizontal, vertical = line_of_sight_weights(grazing_angle)
    variance: Array = horizontal * column[0] + vertical * column[1]
    return variance


def residual_of(column: Callable[[str], Array], after: int | Residual) -> phase.PhaseVariances:
    """Variances after a polynomial of an order, or what an autofocus leaves, of columns of an aperture by name."""
    if not isinstance(after, Residual):
        return phase.PhaseVariances(*(column(name) for name in ("quadratic", "cubic", f"left_{after}")))
    measures = zip(after.quadratic, after.cubic, after.beyond, strict=True)
    return phase.PhaseVariances(
        *(q * column("quadratic") + c * column("cubic") + b * column("left_3") for q, c, b in measures)
    )


def of_fast(effect: Fast, after: int | Residual) -> phase.PhaseVariances:
    """Variances of vibration, unsensed motion or oscillator: faster than a block, they stay but for a polynomial."""
    if not isinstance(after, Residual):
        return residual_of(lambda name: getattr(effect, name), after)
    cubic = effect.cubic if after.order == 2 else 0 * effect.cubic
    return phase.PhaseVariances(0 * effect.quadratic, cubic, getattr(effect, f"left_{after.order}"))


def summed(one: tuple[Pair, Pair], other: tuple[Pair, Pair]) -> tuple[Pair, Pair]:
    """Covariances of both axes, element by element."""
    first, second = (type(a)(*(x + y for x, y in zip(a, b, strict=True))) for a, b in zip(one, other, strict=True))
    return first, second


def bends_of(columns: Pairs, kind: str) -> tuple[Bend, Bend]:
    """Covariances of the turn with the "quadratic" or the "cubic", of both axes, from columns of an aperture."""
    prefix = "" if kind == "quadratic" else "cubic_"
    of_axis = [columns[prefix + name] for name in Bend._fields]
    return Bend(*(column[0] for column in of_axis)), Bend(*(column[1] for column in of_axis))


def lines_of(columns: Pairs) -> tuple[AxisError, AxisError]:
    """Lines in the position errors of both axes, from columns of an aperture."""
    mean, slope, both = (columns[name] for name in ("mean", "slope", "mean_slope"))
    return AxisError(mean[0], slope[0], both[0]), AxisError(mean[1], slope[1], both[1])


def with_range_errors(x: Inputs, shift: Shifts) -> Shifts:
    """The image's shift with what adds along the line of sight: vibration, unsensed motion, oscillator. [P-7]"""
    if x.fast:
        shift = shift._replace(
            range=shift.range + sum(effect.mean for effect in x.fast.values()),
            azimuth=shift.azimuth + azimuth_lever(x) ** 2 * fast_slope(x),
        )
    return shift


def azimuth_lever(x: Inputs) -> Array:
    """Azimuth shift of a metre a second along the line of sight, s."""
    return np.asarray(x.slant_range / (x.speed * np.cos(x.squint)))


def fast_slope(x: Inputs) -> Array:
    """Variance of the slope over the aperture from vibration, unsensed motion and oscillator, m²/s²."""
    return np.asarray(sum(effect.slope for effect in x.fast.values()) * 4 / x.aperture**2)
