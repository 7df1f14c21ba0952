"""Display choices: the spread and the units in which figures are shown. Verdicts do not depend on them.

A figure is a standard deviation of one axis. A horizontal position has two equal axes: a percentage is a radius,
by the Rayleigh distribution, and CEP is the radius that holds half. Other figures have no CEP: they stay at 1σ.
"""

import math
from dataclasses import dataclass, field, replace
from typing import Self

from app.charts.kinds import BarChart, Chart
from app.document.numbers import number, show
from nav_model.base.errors import InputError
from nav_model.design import Design

REQUIRED = "as required"
"""The spread of a design's requirements: what decides is shown as it is decided."""
SPREADS: dict[str, tuple[str, float, float]] = {
    "1σ": ("1s", 1.0, 1.0),
    "2σ": ("2s", 2.0, 2.0),
    "95 %": ("95", 1.959963984540054, math.sqrt(-2 * math.log(0.05))),
    "CEP": ("cep", 1.0, math.sqrt(-2 * math.log(0.5))),
}
"""Name -> its word in links, and the factor over one sigma of one axis and of a horizontal pair."""
SHEET, SI = "data sheet", "SI"
UNITS = (SHEET, SI)
_SI_UNITS = {"length": "m", "speed": "m/s", "angle": "rad", "time": "s", "loss": "dB"}


@dataclass(frozen=True)
class Display:
    """Display of figures: `REQUIRED` or one of `SPREADS`, and one of `UNITS`.

    `of` makes a multiple of sigma of `REQUIRED`, with ``required`` set: limits are then as they are given.

    Examples
    --------
    >>> Display("95 %").show(1.0, "length", pair=True)
    '2.45 m'
    >>> Display(units="SI").show(0.02, "length")
    '0.02 m'
    """

    spread: str = REQUIRED
    units: str = SHEET
    required: bool = field(default=False, compare=False)

    def of(self, *designs: Design) -> Self:
        """This choice for some designs; 1σ where their confidences are not one."""
        if self.spread != REQUIRED:
            return self
        confidence, *others = {design.requirements.confidence for design in designs}
        return replace(self, spread="1σ" if others else f"{confidence:g}σ", required=not others)

    def factor(self, *, pair: bool = False) -> float:
        """Factor on one sigma; ``pair`` for a horizontal position or velocity."""
        if self.required:
            return float(self.spread.removesuffix("σ"))
        _, single, pair_of_axes = SPREADS[self.spread]
        return pair_of_axes if pair else single

    def named(self, *, pair: bool = False) -> str:
        """The spread shown, such as "2σ" or "CEP"."""
        return self.spread if pair or self.spread != "CEP" else "1σ"

    def show(self, sigma: float, dimension: str, *, pair: bool = False, like: float | None = None) -> str:
        """A standard deviation [SI] as it is shown; ``like``: in the unit of this one."""
        factor = self.factor(pair=pair)
        return self.plain(factor * sigma, dimension, like=None if like is None else factor * like)

    def plain(self, value: float, dimension: str, *, like: float | None = None) -> str:
        """Text of a value that is no standard deviation, such as a width [SI]."""
        return self.in_si(value, dimension) if self.units == SI else show(value, dimension, like=like)

    @staticmethod
    def in_si(value: float, dimension: str, *, given: bool = False) -> str:
        """A value [SI] with its SI unit; ``given`` as `number` takes it."""
        return f"{number(value, given=given)} {_SI_UNITS[dimension]}"

    def timeline(self, chart: Chart) -> Chart:
        """A chart of standard deviations over time as it is shown; limits are scaled with their curves, so that
        crossings stay."""
        if self == ONE_SIGMA:
            return chart
        in_radians = self.units == SI and chart.y_label.endswith("[°]")

        def of(label: str) -> float:
            pair = "horizontal" in label or "horizontal" in chart.y_label
            return (math.radians(1) if in_radians else 1.0) * self.factor(pair=pair)

        spreads = dict.fromkeys(self.named(pair="horizontal" in line.label + chart.y_label) for line in chart.lines)
        label = chart.y_label.replace("1σ", " and ".join(spreads))
        low, high = chart.y_range or (math.nan, math.nan)
        factors = [of(line.label) for line in chart.lines]
        return replace(
            chart,
            lines=tuple(replace(line, y=line.y * of(line.label)) for line in chart.lines),
            bands=tuple(
                replace(band, low=band.low * of(band.label), high=band.high * of(band.label)) for band in chart.bands
            ),
            limits=tuple(
                replace(
                    limit,
                    level=limit.level * of(limit.key),
                    label=limit.label.replace("1σ", self.named(pair="horizontal" in limit.key)),
                )
                for limit in chart.limits
            ),
            y_label=label.replace("[°]", "[rad]") if in_radians else label,
            y_range=(low * min(factors), high * max(factors)) if chart.y_range else None,
        )

    def bars(self, chart: BarChart) -> BarChart:
        """Phases by source as they are shown; limits scaled with them."""
        if self == ONE_SIGMA:
            return chart
        k, label = self.factor(), chart.x_label.replace("1σ", self.named())
        angle = k
        if self.units == SI:
            angle, label = math.radians(k), label.replace("[°]", "[rad]")
        return replace(
            chart,
            x_label=label,
            bars=tuple(
                replace(
                    bar,
                    first=angle * bar.first,
                    second=angle * bar.second,
                    first_mm=k * bar.first_mm,
                    second_mm=k * bar.second_mm,
                )
                for bar in chart.bars
            ),
            first_limit=angle * chart.first_limit,
            second_limit=angle * chart.second_limit,
        )

    @property
    def scaled(self) -> str:
        """Words of a caption about limits."""
        return "" if self.required or self == ONE_SIGMA else ", limits scaled"

    @property
    def in_words(self) -> str:
        """The choice in words, such as "95 %, SI units"."""
        return f"{self.spread}, {'SI units' if self.units == SI else 'units as on data sheets'}"

    @property
    def word(self) -> str:
        """The choice in links and in the browser's memory; empty for the default."""
        spread = "" if self.spread == REQUIRED else SPREADS[self.spread][0]
        return spread + (".si" if self.units == SI else "")


ONE_SIGMA = Display("1σ")
AS_REQUIRED = Display()


def display_of(word: str) -> Display:
    """The display of a word such as "95.si".

    Raises
    ------
    InputError
        If there is none.
    """
    spread, _, units = word.partition(".")
    named = {"": REQUIRED} | {short: name for name, (short, _, _) in SPREADS.items()}
    if spread not in named or units not in {"", "si"}:
        raise InputError("show", f"{word[:20]!r} is not a display choice. Try 1s, 2s, 95 or cep, with .si for SI.")
    return Display(named[spread], SI if units else SHEET)
