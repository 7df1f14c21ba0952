"""Sensors that meet the requirements: every inertial unit with every receiver class."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError
from nav_model.budget.inputs import inputs_of
from nav_model.budget.refusals import imaged_inputs
from nav_model.budget.smoothed import model_of
from nav_model.budget.verdict import required
from nav_model.design import Design, Value
from nav_model.design.catalogue import OFFERED, Entry
from nav_model.design.figures import FIGURES
from nav_model.explore.levers import Biases, Lever, imu_lever, lacks, one_currency, receiver_lever
from nav_model.explore.margins import Columns, alike, needed_limits, ratios, worst
from nav_model.explore.rank import SENSORS, log_derivatives, stated

OWN_IMU, OWN_GNSS = "your IMU", "your receiver"
"""Names of the unit and the receiver that are the design's own."""
MOST_PAIRS = 5000
"""Pairs of a unit and a receiver, or none, that are ranked at a time: with slow errors seven seconds and 60 MB."""


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

    Examples
    --------
    >>> from nav_model import catalogue, read_design, search
    >>> design = read_design("examples/mems_x_band.toml")
    >>> rows = search(design, catalogue("imu"), {})
    >>> [row.imu for row in rows if row.closes]
    ['LN-100', 'Sagem Primus 200']
    """
    imaged_inputs(design)
    check_pairs(len(imus), len(receivers))
    one_currency((*imus.values(), *receivers.values()))
    units = [imu_lever(design, entry, biases=biases) for entry in imus.values() if not lacks(entry, biases)]
    if not units:
        raise InputError("imu catalogue", "no unit gives both random walks; add one that does")
    classes = [(), *((receiver_lever(design, entry),) for entry in receivers.values())]
    return tuple(sorted(_ranked(design, [(unit, *chosen) for unit in units for chosen in classes]), key=_rank))


def own_candidate(design: Design) -> Candidate:
    """The design with its own unit and receiver, computed as every candidate is.

    Raises InputError if the design gives no requirement, or is one that `analyse` refuses.
    """
    imaged_inputs(design)
    return _ranked(design, [()])[0]


def _ranked(design: Design, pairs: Sequence[tuple[Lever, ...]]) -> list[Candidate]:
    """Candidates of a unit and a receiver each, the design's own where there is none."""
    names = list(needed_limits(design, "compare sensors with"))
    as_it_is: dict[str, Value] = {
        "imu.angle_random_walk": design.imu.angle_random_walk
    }  # a column, also where nothing changes
    trials = [as_it_is | {key: value for lever in pair for key, value in lever.changes.items()} for pair in pairs]
    rows: dict[int, Candidate] = {}
    for members, base, columns in alike(design, trials):
        shape = (len(members),)
        by_limit = {name: np.broadcast_to(ratio, shape) for name, ratio in ratios(base, columns).items()}
        tightest = np.argmax(np.stack([by_limit[name] for name in names]), axis=0)
        sources, shares = _dominant(base, names, columns, tightest)
        for i, n in enumerate(members):
            of_group = {lever.group: lever for lever in pairs[n]}
            margins = {name: float(1 - by_limit[name][i]) for name in names}
            rows[n] = Candidate(
                imu=of_group["imu"].name if "imu" in of_group else OWN_IMU,
                gnss=of_group["receiver"].name if "receiver" in of_group else OWN_GNSS,
                closes=bool(worst(by_limit)[i] <= 1),
                margin=float(1 - worst(by_limit)[i]),
                tightest=names[tightest[i]],
                dominant=sources[i],
                share=float(shares[i]),
                margins=margins,
                changes=trials[n],
                written={key: unit for lever in pairs[n] for key, unit in lever.written.items()},
                doubts=tuple(doubt for lever in pairs[n] for doubt in lever.doubts),
                currency=next((lever.currency for lever in pairs[n] if lever.currency), ""),
                **{key: _offered(pairs[n], key) for key in OFFERED},
            )
    return [rows[n] for n in range(len(pairs))]


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


def _offered(parts: Sequence[Lever], key: str) -> float | None:
    """Price, mass or power of the parts together; None where one does not say it."""
    values = [part.offer[key] for part in parts if key in part.offer]
    return sum(values) if parts and len(values) == len(parts) else None


def left_out(imus: Mapping[str, Entry], biases: Biases = "design") -> dict[str, str]:
    """Units that cannot be judged -> what their sheet lacks."""
    return {entry.name: missing for entry in imus.values() if (missing := lacks(entry, biases))}


def _dominant(design: Design, names: list[str], columns: Columns, tightest: Array) -> tuple[list[str], Array]:
    """For each candidate the source with the largest share of the tightest figure, and the share.

    A measure of the impulse response has the shares of the quadratic phase.
    """
    limited = required(design)
    followed = {name: FIGURES[limited[name].on].follows for name in names if limited[name].on in FIGURES}
    names = [followed.get(name) or name for name in names]
    given = stated(design)
    keys = [key for key in SENSORS if (key in given if key not in columns else columns[key] is not None)]
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


def _contributed(design: Design, names: list[str], columns: Columns, count: int) -> dict[str, Array]:
    """Contributor of the user's own -> its share of each figure of each candidate, zero where it does not enter."""
    x = inputs_of(design, columns)
    model, limited = model_of(x), required(design)
    shares: dict[str, Array] = {}
    for name in names if x.contributors else ():
        on, at = (limited[name].on, limited[name].at) if name in limited else (name, None)
        for source, share in model.composed(on, at).shares.items():
            shares.setdefault(source, np.zeros((len(names), count)))[np.array(names) == name] = share
    return shares
