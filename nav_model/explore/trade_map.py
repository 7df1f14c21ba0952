"""A map of any figure over any two inputs: thousands of designs in one evaluation."""

import math
from dataclasses import dataclass

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError, not_a_choice
from nav_model.budget.figures import figures
from nav_model.budget.inputs import VARIABLES, inputs_of
from nav_model.budget.refusals import imaged_inputs
from nav_model.budget.verdict import decisive
from nav_model.design import Design, Value
from nav_model.design.catalogue import Entry, catalogue
from nav_model.design.figures import OF_BUDGET
from nav_model.design.parts import quantity
from nav_model.explore.margins import ALL, needed_limits, ratios, usual_range, value_of, worst

SIZE = 64
"""Points along a side."""

RESULTS = (ALL, *OF_BUDGET)
"""Results that a map can show: a figure at the confidence asked for, or the largest value over limit."""


@dataclass(frozen=True)
class MapPoint:
    """A catalogue unit on a map, judged with everything its sheet states, not by the map's colour under it.

    ``value`` is the result with the unit in place of the design's; ``met`` is None when the result has no limit.
    """

    name: str
    x: float
    y: float
    value: float
    met: bool | None


@dataclass(frozen=True)
class TradeMap:
    """A result over two inputs, SI.

    ``z`` has shape (len(y), len(x)): the figure times the confidence, or the largest value over limit; NaN where
    no such design is allowed. ``limit`` is what ``z`` must not exceed, NaN when the design does not say.
    """

    x_key: str
    y_key: str
    result: str
    x: Array
    y: Array
    z: Array
    limit: float
    points: tuple[MapPoint, ...]


def is_log(key: str) -> bool:
    """True if an input's axis is logarithmic: angles and altitude are not."""
    declaration = quantity(key)
    return declaration.dimension != "angle" and declaration.limits[0] >= 0


def axis(design: Design, key: str, count: int) -> Array:
    """The values of one axis: the input's usual range, widened to hold the design with room around it.

    Raises
    ------
    InputError
        If no figure depends on the input as a number.
    """
    if key not in VARIABLES:
        raise InputError(key, f"cannot be an axis; allowed are {', '.join(VARIABLES)}")
    declaration = quantity(key)
    low, high = usual_range(key)
    here = _here(design, key)
    if not is_log(key):
        return np.linspace(min(low, here), max(high, here), count)
    least, most = declaration.limits
    if here > 0:
        low, high = min(low, here / 2), max(high, 2 * here)
    return np.geomspace(max(low, least), min(high, most), count)


def trade_map(design: Design, x_key: str, y_key: str, result: str = ALL, size: int | None = None) -> TradeMap:
    """A result over a grid of two inputs, the others held.

    Parameters
    ----------
    design : Design
    x_key, y_key : str
        Two different inputs of `nav_model.budget.inputs.VARIABLES`.
    result : str
        One of `RESULTS`.
    size : int, optional
        Points along a side; by default `SIZE`.

    Raises
    ------
    InputError
        For inputs or a result that cannot be mapped, `ALL` without any requirement, or a design that `analyse`
        refuses.

    Examples
    --------
    >>> from nav_model import read_design, trade_map
    >>> design = read_design("examples/mems_x_band.toml")
    >>> trade = trade_map(design, "imu.angle_random_walk", "gnss.position_noise", size=8)
    >>> trade.z.shape  # value over limit, at most 1 where a design closes
    (8, 8)
    """
    imaged_inputs(design)
    if x_key == y_key:
        raise InputError(y_key, "is on both axes; choose two different inputs")
    if result not in RESULTS:
        raise InputError("result", not_a_choice(result, RESULTS), result)
    if result == ALL:
        needed_limits(design, "map, or map a single figure")
    count = size or SIZE
    x, y = axis(design, x_key, count), axis(design, y_key, count)
    z = np.broadcast_to(_value(design, {x_key: x[None, :], y_key: y[:, None]}, result), (count, count))
    allowed = 1.0 if result == ALL else decisive(design, result)[1]
    limit = math.nan if allowed is None else allowed
    return TradeMap(x_key, y_key, result, x, y, z, limit, _points(design, x_key, y_key, result, limit))


def _value(design: Design, changes: dict[str, Array], result: str) -> Array:
    if result == ALL:
        return worst(ratios(design, changes))
    return decisive(design, result)[0] * figures(inputs_of(design, changes), (result,))[result]


def _here(design: Design, key: str) -> float:
    """The design's value of an input, also where it follows from another: the aperture time from the resolution.

    Raises
    ------
    InputError
        If the design has none.
    """
    if key == "radar.aperture_time":
        return float(inputs_of(design).aperture)
    value = value_of(design, key)
    if value is None:
        raise InputError(key, "the design has none. Enter one to put it on an axis.")
    return float(value)  # type: ignore[arg-type]


def place(design: Design, trade: TradeMap) -> tuple[float, float]:
    """The place of the design on a map."""
    return _here(design, trade.x_key), _here(design, trade.y_key)


def _points(design: Design, x_key: str, y_key: str, result: str, limit: float) -> tuple[MapPoint, ...]:
    """The catalogue's units that state an input of the map; the other input is the design's."""
    axes = [key.removeprefix("imu.") for key in (x_key, y_key) if key.startswith("imu.")]
    known = [
        entry
        for entry in catalogue("imu").values()
        if axes and {"velocity_random_walk", "angle_random_walk", *axes} <= set(entry.values)
    ]
    if not known:
        return ()
    keys = {f"imu.{name}" for entry in known for name in entry.values} & set(VARIABLES)
    columns = {key: np.array([_entry_value(entry, key, design) for entry in known]) for key in keys}
    values = np.broadcast_to(_value(design, columns, result), len(known))
    return tuple(
        MapPoint(
            entry.name,
            _entry_value(entry, x_key, design),
            _entry_value(entry, y_key, design),
            float(value),
            None if np.isnan(limit) else bool(value <= limit),
        )
        for entry, value in zip(known, values, strict=True)
    )


def _entry_value(entry: Entry, key: str, design: Design) -> float:
    item = entry.values.get(key.removeprefix("imu.")) if key.startswith("imu.") else None
    return item.value if item else _here(design, key)


def changes_at(trade: TradeMap, x: float, y: float) -> dict[str, Value]:
    """Changes (SI) that put a design at a place of the map, held within the inputs' bounds."""
    changes: dict[str, Value] = {}
    for key, value in ((trade.x_key, x), (trade.y_key, y)):
        low, high = quantity(key).limits
        changes[key] = min(max(value, low), high)
    return changes
