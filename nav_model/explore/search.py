"""Sensors that meet the requirements: every inertial unit with every receiver class."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError
from nav_model.budget.inputs import VARIABLES, inputs_of
from nav_model.budget.refusals import imaged_inputs
from nav_model.budget.smoothed import model_of
from nav_model.budget.verdict import required
from nav_model.design import Design, Value
from nav_model.design.catalogue import OFFERED, Entry
from nav_model.design.figures import FIGURES
from nav_model.design.presets import filled, sheet_filled, values_of
from nav_model.explore.margins import limits, ratios, value_of, worst
from nav_model.explore.rank import SENSORS, log_derivatives, stated

OWN_IMU, OWN_GNSS = "your IMU", "your receiver"
"""Names of the unit and the receiver that are the design's own."""
Biases = Literal["design", "zero", "in-run", "sheet"]
"""Residual biases that every unit is judged with: the design's, zero, or the in-run biases of its own sheet; or, with
the design's, all errors that its sheet prints."""
MOST_PAIRS = 5000
"""Pairs of a unit and a receiver, or none, that are ranked at a time: with slow errors seven seconds and 60 MB."""
_AT_ONCE = 250  # pairs in one pass: a slow error takes 0.2 MB for each
_NEEDED = ("velocity_random_walk", "angle_random_walk")
_BIASES = ("accelerometer_bias", "gyro_bias")


@dataclass(frozen=True)
class Candidate:
    """One inertial unit with one receiver under the design's radar.

    ``margin`` is that of the tightest requirement, ``margins`` of each; ``dominant`` is the error source with the
    largest share of the tightest figure's variance, which is its logarithmic sensitivity [T-18]. ``changes`` are
    the inputs (SI) that adopting it sets, ``written`` their units. ``doubts`` names values that the source does not
    confirm. ``price``, ``mass`` [kg] and ``power`` [W] are sums over the offers, None where one does not say it.
    """

    imu: str
    gnss: str
    closes: bool
    margin: float
    tightest: str
    dominant: str
    share: float
    margins: Mapping[str, float]
    changes: Mapping[str, Value]
    written: Mapping[str, str]
    doubts: tuple[str, ...]
    price: float | None
    currency: str
    mass: float | None
    power: float | None

    @property
    def pair(self) -> str:
        """Name of the unit and the receiver together."""
        return f"{self.imu} with {self.gnss}"


def search(
    design: Design, imus: Mapping[str, Entry], receivers: Mapping[str, Entry], biases: Biases = "design"
) -> tuple[Candidate, ...]:
    """Every unit with every receiver class and with the design's own receiver, the widest margin first.

    Where there are offers, the cheapest that passes is first, then what passes without a price, then what does not.
    Units whose sheet lacks a value cannot be judged: `left_out` names them. The design's vibration factor holds for
    every unit, because no data sheet prints it.

    Parameters
    ----------
    design : Design
        Its receiver, flight, radar and requirements.
    imus, receivers : mapping
        Name -> entry of a catalogue.
    biases : str, optional
        Residual biases of the units: the design's, zero, or those of each data sheet; or, with the design's, all that
        each sheet prints, as for a design that takes whole sheets.

    Raises
    ------
    InputError
        If the design gives no requirement or is one that `analyse` refuses, no unit can be judged, there are more
        than `MOST_PAIRS`, or prices are in several currencies.
    """
    imaged_inputs(design)
    check_pairs(len(imus), len(receivers))
    currency = one_currency((*imus.values(), *receivers.values()))
    names = list(limits(design))
    if not names:
        raise InputError("requirements", "none is given; give at least one limit to compare sensors with")
    known = [entry for entry in imus.values() if not _lacks(entry, biases)]
    if not known:
        raise InputError("imu catalogue", "no unit gives both random walks; add one that does")
    pairs = [_Pair(design, imu, receiver, biases) for imu in known for receiver in (None, *receivers.values())]
    rows: list[Candidate] = []
    for slow in (False, True):  # a slow error is a choice, no number: those with and without it are judged apart
        alike = [pair for pair in pairs if pair.changes.get("gnss.correlated", design.gnss.correlated) == slow]
        base = design.replace({"gnss.correlated": slow})
        for start in range(0, len(alike), _AT_ONCE):
            rows += _ranked(base, names, alike[start : start + _AT_ONCE], currency)
    return tuple(sorted(rows, key=_rank))


def own_candidate(design: Design) -> Candidate:
    """The design with its own unit and receiver, computed as every candidate is.

    Raises InputError if the design gives no requirement, or is one that `analyse` refuses.
    """
    imaged_inputs(design)
    names = list(limits(design))
    if not names:
        raise InputError("requirements", "none is given; give at least one limit to compare sensors with")
    return _ranked(design, names, [_Pair(design, None, None, "design")], "")[0]


class _Pair:
    """A unit and a receiver, or the design's own (None), and what they change in the design."""

    def __init__(self, design: Design, imu: Entry | None, receiver: Entry | None, biases: Biases) -> None:
        self.imu, self.gnss = imu.name if imu else OWN_IMU, receiver.name if receiver else OWN_GNSS
        self.parts = [part for part in (imu, receiver) if part is not None]
        self.changes: dict[str, Value] = {} if imu else {f"imu.{name}": design[f"imu.{name}"] for name in _NEEDED}
        self.written: dict[str, str] = {}
        items = [*(imu.in_run.items() if imu and biases == "in-run" else ())]
        self.changes |= {f"imu.{name}": 0.0 for name in _BIASES if biases == "zero"}
        if imu and (biases == "sheet" or design.imu.sheet):
            values, units = sheet_filled(imu)
            self.changes |= {"imu.sheet": True, **values}
            self.written |= units
            items += [(key, item) for key, item in imu.sheet.items() if item.status != "assumed"]
        self.changes |= {f"imu.{name}": item.value for name, item in items if "." not in name}
        self.written |= {f"imu.{name}": item.unit for name, item in items if "." not in name}
        for part in self.parts:
            changes, written = filled(part, design.baseline)
            self.changes |= changes
            self.written |= written
            items += values_of(part, design.baseline).items()
        self.doubts = tuple(
            f"{name.replace('_', ' ').replace('.', ' ')} ({item.status})"
            for name, item in items
            if not item.confirmed and name != "correlated"  # its size says it
        )


def _ranked(design: Design, names: list[str], pairs: Sequence[_Pair], currency: str) -> list[Candidate]:
    """Pairs that all have, or have not, a slow error, as the design says."""
    keys = sorted({key for pair in pairs for key in pair.changes} & set(VARIABLES))
    columns = {key: np.array([_filled(design, pair.changes, key) for pair in pairs], float) for key in keys}
    by_limit = {name: np.broadcast_to(ratio, len(pairs)) for name, ratio in ratios(design, columns).items()}
    whole = worst(by_limit)
    tightest = np.argmax(np.stack([by_limit[name] for name in names]), axis=0)
    sources, shares = _dominant(design, names, columns, tightest)
    return [
        Candidate(
            imu=pair.imu,
            gnss=pair.gnss,
            closes=bool(whole[i] <= 1),
            margin=float(1 - whole[i]),
            tightest=names[tightest[i]],
            dominant=sources[i],
            share=float(shares[i]),
            margins={name: float(1 - by_limit[name][i]) for name in names},
            changes=pair.changes,
            written=pair.written,
            doubts=pair.doubts,
            currency=currency,
            **{key: _offered(pair.parts, key) for key in OFFERED},
        )
        for i, pair in enumerate(pairs)
    ]


def check_pairs(units: int, receivers: int) -> None:
    """Refuse more pairs than are ranked at a time; the design's own receiver counts as one more.

    Raises
    ------
    InputError
        With the numbers.
    """
    if (pairs := units * (1 + receivers)) > MOST_PAIRS:
        counted = f"{units} units with each of {receivers} receivers and the design's own are {pairs} pairs"
        raise InputError("offers", f"{counted}, at most {MOST_PAIRS} are ranked at a time; give fewer of them")


def _rank(row: Candidate) -> tuple[bool, float, float]:
    """Price counts among those that pass; the others are in the order of their margins."""
    return not row.closes, (math.inf if row.price is None else row.price) if row.closes else 0.0, -row.margin


def one_currency(entries: Iterable[Entry]) -> str:
    """The one currency of all prices; empty without prices.

    Raises
    ------
    InputError
        If there are several.
    """
    priced = {entry.name: entry.offer["price"].unit for entry in entries if "price" in entry.offer}
    first = next(iter(priced.values()), "")
    for name, currency in priced.items():
        if currency != first:
            raise InputError(
                f"{name}.price", f"is in {currency}, others are in {first}; give every price in one currency"
            )
    return first


def _offered(parts: Sequence[Entry], key: str) -> float | None:
    """Price, mass or power of the parts together; None where one does not say it."""
    values = [part.offer[key].value for part in parts if key in part.offer]
    return sum(values) if parts and len(values) == len(parts) else None


def left_out(imus: Mapping[str, Entry], biases: Biases = "design") -> dict[str, str]:
    """Units that cannot be judged -> what their sheet lacks."""
    return {entry.name: lacks for entry in imus.values() if (lacks := _lacks(entry, biases))}


def _lacks(entry: Entry, biases: Biases) -> str:
    missing = [name for name in _NEEDED if name not in entry.values]
    if biases == "in-run":
        missing += [f"in-run {name}" for name in _BIASES if name not in entry.in_run]
    return " and ".join(name.replace("_", " ") for name in missing)


def _filled(design: Design, change: Mapping[str, Value], key: str) -> float:
    """A candidate's value of an input: its own, else the design's."""
    return float(value_of({**dict(design.items()), **change}, key))  # type: ignore[arg-type]


def _dominant(
    design: Design, names: list[str], columns: Mapping[str, Array], tightest: Array
) -> tuple[list[str], Array]:
    """For each candidate the source with the largest share of the tightest figure, and the share.

    A measure of the impulse response has the shares of the quadratic phase.
    """
    limited = required(design)
    followed = {name: FIGURES[limited[name].on].follows for name in names if limited[name].on in FIGURES}
    names = [followed.get(name) or name for name in names]
    keys = [key for key in SENSORS if key in stated(design) or key in columns]
    slopes = log_derivatives(design, keys, names, columns)
    by_source: dict[str, Array] = {}
    for i, key in enumerate(keys):
        share = np.stack([slopes[name][i] for name in names])[tightest, np.arange(len(tightest))]
        by_source[SENSORS[key]] = by_source.get(SENSORS[key], np.zeros(share.shape)) + share
    for source, shares in _contributed(design, names, columns, len(tightest)).items():
        by_source[source] = shares[tightest, np.arange(len(tightest))]
    table = np.stack(list(by_source.values()))
    best = np.argmax(table, axis=0)
    sources = list(by_source)
    return [sources[k] for k in best], np.max(table, axis=0)


def _contributed(design: Design, names: list[str], columns: Mapping[str, Array], count: int) -> dict[str, Array]:
    """Contributor of the user's own -> its share of each figure of each candidate, zero where it does not enter."""
    x = inputs_of(design, columns)
    model, limited = model_of(x), required(design)
    shares: dict[str, Array] = {}
    for name in names if x.contributors else ():
        on, at = (limited[name].on, limited[name].at) if name in limited else (name, None)
        for source, share in model.composed(on, at).shares.items():
            shares.setdefault(source, np.zeros((len(names), count)))[np.array(names) == name] = share
    return shares
