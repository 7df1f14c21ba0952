"""The smoothed error of one channel: by its spectrum where that holds, otherwise in state space."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.analytic.few import from_few
from nav_model.base.arrays import Array
from nav_model.processing.leg import COLUMNS, levels, smoothed_in_leg
from nav_model.processing.leg_fixes import fixes_in_legs
from nav_model.processing.spectrum import Channel, Leg, rates, smoothed

SPECTRUM, STATE_SPACE = "spectrum", "state space"

LONG = 6.0
"""Times 1/w0 of leg on each side: what is missing beyond is 0.1 % of the quadratic phase."""

_DENSE = 0.7  # w0 times the fix interval: sampled fixes act like the noise of their density to 0.02 %

_MANY = 4000  # designs in state space; a larger map is interpolated from a few of them
_NOTHING = 1e-300  # instead of zero under a logarithm
_PAIRS = {
    "with_curved": ("quadratic", "curved"), "mean_slope": ("mean", "slope"), "with_turned": ("quadratic", "turned"),
    "turned_curved": ("turned", "curved"), "cubic_with_turned": ("cubic", "cubic_turned"),
    "cubic_with_curved": ("cubic", "cubic_curved"), "cubic_turned_curved": ("cubic_turned", "cubic_curved"),
}  # fmt: skip
"""Covariances, and the variances that they belong to."""

_COUNTED = ("interval", "velocity_interval", "aperture", "before", "after", "gap")


def _values(channel: Channel) -> dict[str, Array]:
    """The inputs of a channel; the vertical one is a horizontal one without gyro noise."""
    whole = replace(channel, gyro=0 * channel.accelerometer) if channel.gyro is None else channel
    return {name: value for name, value in vars(whole).items() if value is not None}


def by_state_space(channel: Channel, leg: Leg) -> NDArray[np.bool_]:
    """Where the spectrum does not hold: a short leg, sparse fixes, or a time without them before the aperture."""
    fastest, slowest = rates(channel)
    interval = channel.interval.real
    if channel.velocity_interval is not None:
        interval = np.maximum(interval, channel.velocity_interval.real)
    side = np.minimum(leg.before.real, leg.after.real)
    where = (side * slowest < LONG) | (interval * fastest > _DENSE) | (leg.gap.real > 0)
    return np.asarray(where)


def smoothed_error(
    channels: Sequence[Channel], aperture: Array, leg: Leg, names: Collection[str]
) -> list[dict[str, Array]]:
    """The smoothed error over an aperture, each design by the method that holds for it. [P-3], [P-5]

    Parameters
    ----------
    channels : sequence of Channel
    aperture : array
        Seconds.
    leg : Leg
    names : collection of str
        Of `nav_model.processing.leg.COLUMNS`, where the units are told. ``tilt`` only of channels with a gyro.

    Returns
    -------
    list of dict
        For each channel: name -> variances, an array that broadcasts to the shape of all inputs together.

    Notes
    -----
    By spectrum every design is computed. In state space a map of thousands of designs is computed at a few of
    them, and in between by polynomials that `nav_model.analytic.few` compares with others: variances are within
    1e-4 of those of each design alone where compared, and covariances within 1e-4 of their variances' mean.
    """
    if not names:
        return [{} for _ in channels]
    found: list[dict[str, Array]] = []
    short: list[NDArray[np.bool_]] = []
    for channel in channels:
        there = [name for name in names if name != "tilt" or channel.gyro is not None]
        where = by_state_space(channel, leg)
        found.append({name: np.zeros(()) for name in there} if np.all(where) else smoothed(channel, aperture, there))
        short.append(where)
    if not any(map(np.any, short)):
        return found
    parts = [_part(channel, aperture, leg, where) for channel, where in zip(channels, short, strict=True)]
    # A channel that one axis alone changes, or none, has few designs beside one that both axes change.
    few = [n for n, part in enumerate(parts) if part.is_map]
    if sum(np.count_nonzero(parts[n].mask) for n in few) <= _MANY:
        few = []
    rest = [n for n, part in enumerate(parts) if n not in few and part.mask.any()]
    exact: dict[int, dict[str, Array]] = {}
    if few:
        exact |= zip(few, _from_few([parts[n] for n in few], [found[n] for n in few]), strict=True)
    if rest:
        exact |= zip(rest, _each([parts[n] for n in rest]), strict=True)
    for n, values in exact.items():
        columns, part = found[n], parts[n]
        whole = bool(np.all(part.mask))
        for name, base in columns.items():
            if whole:
                columns[name] = values[name].reshape(part.mask.shape)
                continue
            columns[name] = np.array(np.broadcast_to(base, part.mask.shape), np.result_type(base, values[name]))
            columns[name][part.mask] = values[name]
    return found


_Places = NDArray[np.int64]


class _Axis(NamedTuple):
    """Rows or columns of a map of which no two are alike.

    The length of a leg counts by its number of fixes alone. Along an axis that changes such a number, values jump,
    but for one leg with one kind of fixes: there they are smooth in the number.
    """

    first: _Places  # of the map, that stand for those alike
    alike: _Places  # of each of the map, which of these it is
    at: Array  # where these are, for values that are smooth
    jumps: bool


@dataclass(frozen=True)
class _Part:
    """Inputs of one channel, by name and then aperture and leg, and where they are smoothed in state space."""

    values: dict[str, Array]
    mask: NDArray[np.bool_]

    @property
    def is_map(self) -> bool:
        """Whether two axes change it, by plain numbers."""
        shape = self.mask.shape
        return len(shape) == 2 and min(shape) > 1 and not any(map(np.iscomplexobj, self.values.values()))

    def axis(self, n: int) -> _Axis:
        """The rows or the columns of a map."""
        size = self.mask.shape[n]
        counted = {name: self.values[name] for name in _COUNTED if name in self.values}
        along = {name for name, value in counted.items() if value.ndim >= 2 - n and value.shape[n - 2] > 1}
        beside = {"interval", "velocity_interval", "aperture", *({"gap"} if "before" in along else ())}
        alone = along <= {"before", "after"} and all(counted[name].size == 1 for name in beside & set(counted))
        if len(along) != 1 or not alone:
            return _Axis(np.arange(size), np.arange(size), np.arange(size, dtype=float), bool(along))
        (name,) = along
        one = {key: value.ravel() if key == name else value.ravel()[0] for key, value in counted.items()}
        nothing, *ends = np.zeros(()), *(one[key] for key in Leg._fields)
        channel = Channel(nothing, None, nothing, one["interval"], None, one.get("velocity_interval"))
        fixes = fixes_in_legs(channel, one["aperture"], Leg(*ends))[:, int(name == "after")]
        new = np.append(True, np.any(np.diff(fixes) != 0, axis=0))
        first, jumps = np.flatnonzero(new), bool(np.any(fixes[1:]))
        return _Axis(
            first, np.cumsum(new) - 1, first.astype(float) if jumps else np.log(fixes[0, first] + 3.0), jumps
        )

    def at(self, place: NDArray[np.bool_] | tuple[_Places, ...]) -> list[Array]:
        """The inputs at some places of the shape that they have together."""
        return [np.broadcast_to(value, self.mask.shape)[place] for value in self.values.values()]

    @property
    def level(self) -> _Places:
        *values, aperture, _, _, _ = self.values.values()
        found = levels(Channel(**dict(zip(self.values, values, strict=False))), aperture)
        return np.broadcast_to(found, self.mask.shape)


def _part(channel: Channel, aperture: Array, leg: Leg, where: NDArray[np.bool_]) -> _Part:
    values = _values(channel) | {"aperture": aperture, **leg._asdict()}
    return _Part(values, where & np.ones(np.broadcast_shapes(*(value.shape for value in values.values())), bool))


def _in_leg(names: Iterable[str], rows: Sequence[Array], level: _Places | None = None) -> dict[str, Array]:
    *values, aperture, before, after, gap = rows
    channel = Channel(**dict(zip(names, values, strict=False)))
    return smoothed_in_leg(channel, aperture, Leg(before, after, gap), level)


def _each(parts: Sequence[_Part]) -> list[dict[str, Array]]:
    """Every design in state space, of all channels in one go."""
    rows = [np.concatenate(values) for values in zip(*(part.at(part.mask) for part in parts), strict=True)]
    exact = _in_leg(parts[0].values, rows)
    ends = np.cumsum([0, *(np.count_nonzero(part.mask) for part in parts)]).tolist()
    return [{name: values[first:end] for name, values in exact.items()} for first, end in pairwise(ends)]


def _from_few(parts: Sequence[_Part], wanted: Sequence[Mapping[str, Array]]) -> list[dict[str, Array]]:
    """A map in state space from few of its designs: for every number of modes it is another smooth function."""
    names = [name for name in COLUMNS if any(name in columns for columns in wanted)]
    plain = sorted({one for name in names for one in _PAIRS.get(name, (name,))})
    paired = [name for name in names if name in _PAIRS]
    rows, columns = parts[0].axis(0), parts[0].axis(1)  # fixes come to all channels alike
    kinds = [
        (n, int(k), np.nonzero(part.mask & (part.level == k)))
        for n, part in enumerate(parts)
        for k in np.unique(part.level)
    ]
    places = [(rows.alike[i], columns.alike[j]) for _, _, (i, j) in kinds]

    def exact(kind: _Places, i: _Places, j: _Places) -> Array:
        # the kinds come one after the other
        pieces = [
            parts[n].at((rows.first[i[kind == m]], columns.first[j[kind == m]])) for m, (n, _, _) in enumerate(kinds)
        ]
        inputs = [np.concatenate(values) for values in zip(*pieces, strict=True)]
        found = _in_leg(parts[0].values, inputs, np.array([k for _, k, _ in kinds])[kind])
        variances = {name: np.maximum(found[name], _NOTHING) for name in plain}
        pairs = (found[name] / np.sqrt(variances[_PAIRS[name][0]] * variances[_PAIRS[name][1]]) for name in paired)
        return np.stack([*map(np.log, variances.values()), *pairs])

    wanted_at = []
    for place in places:
        wanted_at.append(np.zeros((len(rows.first), len(columns.first)), bool))
        wanted_at[-1][place] = True
    jumps = [(rows.jumps, columns.jumps)] * len(kinds)
    solved = from_few(wanted_at, jumps, len(plain) + len(paired), exact, (rows.at, columns.at))
    found = [{name: np.empty(part.mask.shape) for name in names} for part in parts]
    for (n, _, own), place, values in zip(kinds, places, solved, strict=True):
        here = values[:, *place]
        variances = dict(zip(plain, np.exp(here[: len(plain)]), strict=True))
        for name in names:
            if name not in _PAIRS:
                found[n][name][own] = variances[name]
        for name, ratio in zip(paired, here[len(plain) :], strict=True):
            one, other = _PAIRS[name]
            found[n][name][own] = ratio * np.sqrt(variances[one] * variances[other])
    return [
        {name: values[part.mask] for name, values in columns.items()}
        for columns, part in zip(found, parts, strict=True)
    ]
