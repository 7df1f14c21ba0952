"""The table that vendors of inertial systems print, of a design, and the sensor noise that such a table implies.

Rows are times since the last fix, columns horizontal and vertical position, velocity, roll and pitch, heading. All
are one sigma, per axis, of IMU and receiver alone. The closed forms are those of `nav_model.budget.real_time` and
`nav_model.budget.navigation`; the way back fits them by least squares in logarithms.
"""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError, quoted, under
from nav_model.base.units import parse_quantity
from nav_model.budget.inputs import inputs_of
from nav_model.budget.navigation import smoothed_outage
from nav_model.budget.real_time import RealTime
from nav_model.budget.refusals import imaged_inputs, refused
from nav_model.budget.smoothed import Smoothed
from nav_model.design import Design
from nav_model.design.parts import quantity
from nav_model.design.presets import preset_fill
from nav_model.design.processing import REAL_TIME
from nav_model.explore.solve import rounded_offer

OUTAGES = (0.0, 10.0, 60.0)
"""Seconds since the last fix that data sheets print."""


class VendorColumn(NamedTuple):
    """A column: its figure while fixes come in (none for heading), that of the outage, and the input whose
    declaration reads a value as data sheets write it."""

    label: str
    settled: str
    outage: str
    reads: str


def _both(figure: str) -> tuple[str, str]:
    return figure, f"coast_{figure}"


COLUMNS: Mapping[str, VendorColumn] = MappingProxyType(
    {
        "horizontal": VendorColumn("Horizontal position", *_both("horizontal_position"), "gnss.position_noise"),
        "vertical": VendorColumn("Vertical position", *_both("vertical_position"), "gnss.vertical_position_noise"),
        "velocity": VendorColumn("Horizontal velocity", *_both("horizontal_velocity"), "gnss.velocity_noise"),
        "roll and pitch": VendorColumn("Roll and pitch", *_both("tilt"), "requirements.tilt"),
        "heading": VendorColumn("Heading growth", "", "coast_heading", "requirements.tilt"),
    }
)
"""Name in a row -> the column."""


class VendorRow(NamedTuple):
    """A row: processing, seconds since the last fix, and by column one sigma in SI; None where nothing is known."""

    processing: str
    outage: float
    values: Mapping[str, float | None]


def vendor_table(design: Design) -> tuple[VendorRow, ...]:
    """The rows of `OUTAGES` in both processings, without contributors.

    In real time an outage is judged at its end. Post-processed it is bridged from both sides, and the largest error
    within it counts. Heading has only what it gains in real time: no fix of a straight leg shows it.

    Raises
    ------
    InputError
        If the design is one that `analyse` refuses.

    Examples
    --------
    >>> from nav_model import read_design, vendor_table
    >>> design = read_design("examples/mems_x_band.toml")
    >>> row = vendor_table(design)[0]
    >>> row.processing, row.outage, round(row.values["horizontal"], 3)  # s, m
    ('real time', 0.0, 0.404)
    """
    x = imaged_inputs(design)
    with refused(design):
        models: tuple[RealTime, ...] = (RealTime(x), Smoothed(x))
        return tuple(
            VendorRow(model.processing, outage, _row(model, outage)) for model in models for outage in OUTAGES
        )


def _row(model: RealTime, outage: float) -> dict[str, float | None]:
    if outage == 0:
        return {name: float(model.value(of.settled)) if of.settled else None for name, of in COLUMNS.items()}
    if model.processing == REAL_TIME:
        return {name: float(model.value(of.outage, outage)) for name, of in COLUMNS.items()}
    inside = np.linspace(0.0, outage, 61)[1:]
    bridged = smoothed_outage(replace(model.x, duration=np.asarray(outage)), inside)
    return {name: float(bridged[of.settled].max()) if of.settled else None for name, of in COLUMNS.items()}


def with_unit(design: Design, imu: str) -> Design:
    """The design with an IMU of the catalogue; residual biases and vibration factor stay, as no sheet prints them.

    Raises
    ------
    InputError
        If the catalogue has no such IMU, or one without both random walks.
    """
    values, written = preset_fill("imu", imu, sheet=design.imu.sheet)
    if missing := [str(quantity(key).label) for key in _UNKNOWNS[:2] if key not in values]:
        raise InputError("imu", f"{imu} has no {' and no '.join(missing).lower()} in the catalogue.", imu)
    return design.replace(values, written)


# The way back.


class Given(NamedTuple):
    """An entry of a row as typed: seconds since the last fix, column, value in SI, the text, and by what part of it
    the value may be off, as its digits say."""

    outage: float
    column: str
    value: float
    text: str
    rounding: float

    @property
    def label(self) -> str:
        """Name of the entry in a message."""
        return f"{self.column} {self.text} {f'after {self.outage:g} s' if self.outage else 'without an outage'}"


class Implied(NamedTuple):
    """An input that the rows imply, SI, and the factor that the digits leave open to both sides.

    Where that is not less than three, both are None, and at_most is the largest value with which some noise gives
    every entry to its digits; None where no entry bounds it, or none gives them all.
    """

    key: str
    value: float | None
    factor: float | None
    at_most: float | None = None


class Contradiction(NamedTuple):
    """An entry without which the others agree, and the value [SI] that they imply for it."""

    entry: Given
    implied: float

    @property
    def factor(self) -> float:
        """The value of the vendor over that which the other entries imply."""
        return self.entry.value / self.implied


@dataclass(frozen=True)
class Inversion:
    """Implications of the rows of a table.

    Attributes
    ----------
    entries : tuple of Given
    agree : bool
        Whether some noise gives every entry to its digits.
    implied : tuple of Implied
        The noise that comes closest.
    contradictions : tuple of Contradiction
        Empty where the rows agree. Otherwise every entry that contradicts the rest alone; if there is none, since
        several are wrong at once, the two that the noise misses most, each with what it gives.
    several : bool
        Whether it is those two.
    """

    entries: tuple[Given, ...]
    agree: bool
    implied: tuple[Implied, ...]
    contradictions: tuple[Contradiction, ...]
    several: bool

    @property
    def determined(self) -> bool:
        """True if the rows agree and give every input."""
        return self.agree and all(item.value is not None for item in self.implied)

    def changes(self, design: Design) -> tuple[dict[str, float], dict[str, str], dict[str, str]]:
        """Values, units and origins that `Design.replace` takes, of the inputs that have a value."""
        labels = "; ".join(entry.label for entry in self.entries)
        values, origins = {}, {}
        for item in self.implied:
            if item.value is None:
                continue
            values[item.key] = rounded_offer(design, item.key, item.value).value
            origin = f"implied by the vendor's table: {labels}"
            origins[item.key] = origin if len(origin) <= _ORIGIN else f"{origin[:_ORIGIN]}…"
        return values, {key: design.unit(key) for key in values}, origins


_UNKNOWNS = ("imu.angle_random_walk", "imu.velocity_random_walk", "imu.gyro_bias", "imu.accelerometer_bias")
_MOST_ROWS, _LONGEST, _ORIGIN = 10, 300, 180
_LEAST_ROUNDING, _MOST_ROUNDING = 0.01, 0.1
_STARTS, _FITS, _EVALUATIONS = 2048, 3, 40
_MOST_TRIED = 8  # entries that are left out in turn
_EXACT = 1e-4  # sum of squares, of roundings, from which no other start is tried
_STEP = 1e-20
_LOOSE = 3.0  # factor from which an input is not determined
_COARSE = 1e-6  # change of a logarithm at which the search for a largest value ends
_MISSED = 1e-3  # of a rounding, beyond which a search has left what the digits allow
_NAMES = {
    **dict.fromkeys(("roll/pitch", "roll / pitch", "roll & pitch", "roll", "pitch", "tilt"), "roll and pitch"),
    **dict.fromkeys(("true heading", "yaw"), "heading"),
    **{f"{axis} position": axis for axis in ("horizontal", "vertical")},
    "horizontal velocity": "velocity",
}
_WITHOUT_COLON = re.compile(r"^\s*((?:after\s+)?[\d.]+\s*(?:s|min)|no outage)\s+(?=[a-z])", re.I)
_PRINTED = re.compile(r"\s*(none|[\d.]+\s*(?:s|min))\s+real time\s+(.*?)\s*", re.I)
_VALUES = re.compile(r"–|[\d.]+(?:·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?\s?[^\d\s–]+")
_ENTRY = re.compile(r"\s*([a-z][a-z /&]*?)\s*[:=]?\s+(?=[±<≤~\d.])(.+?)\s*", re.I)


def read_row(text: str, baseline: float | None = None) -> tuple[Given, ...]:
    """A row such as "60 s: horizontal 0.10 m, vertical 0.07 m, velocity 0.015 m/s, roll and pitch 0.005°".

    The time may also be "no outage". Values are one sigma per axis, or say what they are: "0.10 m CEP", and
    "1 cm + 1 ppm" at the baseline [m]. A row may also be one as `vendor_table` is printed: "60 s real
    time 6.59 m …".

    Raises
    ------
    InputError
        Naming what is not understood.
    """
    if printed := _PRINTED.fullmatch(text):
        named = zip(COLUMNS, _VALUES.findall(printed[2]), strict=False)
        given_in = ", ".join(f"{name} {value}" for name, value in named if value != "–")
        text = f"{printed[1].lower().replace('none', 'no outage')}: {given_in}"
    time, colon, rest = _WITHOUT_COLON.sub(r"\1: ", text, count=1).partition(":")
    if not colon or len(text) > _LONGEST:
        example = 'Name each value: "60 s: horizontal 0.10 m, heading 0.010°".'
        raise InputError("row", f"{text[:80]!r} could not be read. {example}", text)
    settled = time.strip().lower() in {"no outage", "0"}
    try:
        outage = 0.0 if settled else parse_quantity(re.sub(r"(?i)\b(after|outage)\b", "", time).strip(), "time").value
    except InputError as error:
        reason = (
            f"{quoted(time.strip())} is not the time of an outage. Write 60 s or no outage, for rows in real time."
        )
        raise InputError("row", reason, text) from error
    _, longest = cast("tuple[float, float]", quantity("coast.duration").bounds)
    if not 0 <= outage <= longest:
        raise InputError("row", f"{time.strip()} is not allowed. Give from 0 s to {longest:g} s.", text)
    entries = []
    for part in re.split(r"[,;]\s*(?=[A-Za-z])", rest.strip()):
        match = _ENTRY.fullmatch(part)
        name = " ".join(match[1].lower().split()) if match else ""
        column = _NAMES.get(name, name)
        if match is None or column not in COLUMNS:
            reason = f"{part[:80]!r} is none of {', '.join(COLUMNS)} with a value. Leave other columns out."
            raise InputError("row", reason, text)
        with under("row"):
            value = quantity(COLUMNS[column].reads).read(match[2], baseline=baseline).value
        entries.append(Given(outage, column, value, match[2], _rounding(match[2])))
    return tuple(entries)


def _rounding(text: str) -> float:
    """Half of the last digit, as a part of the value, within bounds that a measurement has."""
    number = re.search(r"\d*[.,]?\d+", text)
    digits = number[0].replace(",", ".") if number else "1"
    half = 0.5 * 10.0 ** -len(digits.partition(".")[2])
    return min(max(half / (float(digits) or 1.0), _LEAST_ROUNDING), _MOST_ROUNDING)


def invert(design: Design, rows: Iterable[str]) -> Inversion:
    """Noise and residual biases of the IMU that rows in real time imply with the design's receiver and flight.

    A sheet's heading contains what it was before the outage, so its growth is fitted with an unknown start. The
    design's vibration factor multiplies the random walks that are implied, as it does in the table.

    Raises
    ------
    InputError
        If a row cannot be read, an entry is there twice, or the design is one that `analyse` refuses.

    Examples
    --------
    >>> from nav_model import invert, read_design
    >>> design = read_design("examples/mems_x_band.toml")
    >>> answer = invert(design, ["60 s: horizontal 3.0 m, heading 0.02°"])
    >>> answer.agree, answer.implied[0].key, answer.implied[0].value  # two numbers leave it open
    (True, 'imu.angle_random_walk', None)
    """
    imaged_inputs(design)
    texts = tuple(rows)
    entries = tuple(entry for text in texts[: _MOST_ROWS + 1] for entry in read_row(text, design.baseline))
    if not entries or len(texts) > _MOST_ROWS:
        raise InputError("row", f"Give from one to {_MOST_ROWS} rows.")
    if len({(entry.outage, entry.column) for entry in entries}) < len(entries):
        raise InputError("row", "The same entry is there twice. Keep the one that holds.")
    with refused(design):
        fit = _Fit(design, entries)
        everything = np.ones(len(entries), bool)
        point, cost = fit.best(everything)
        # Values that agree to their digits cost at most one each, so more is a proof that none do.
        agree = bool(cost <= len(entries))
        implied = []
        for place, (key, factor) in enumerate(zip(_UNKNOWNS, fit.factors(point), strict=True)):
            if factor < _LOOSE:
                implied.append(Implied(key, math.exp(point[place]), factor))
            else:
                implied.append(Implied(key, None, None, fit.at_most(place, point) if agree else None))
        contradictions = () if agree else fit.contradictions(point)
        several = not agree and not contradictions
        return Inversion(entries, agree, tuple(implied), fit.missed(point) if several else contradictions, several)


class _Fit:
    """Logarithms of the unknowns, and of the heading before an outage, against the entries."""

    def __init__(self, design: Design, entries: Sequence[Given]) -> None:
        self.design, self.entries = design, entries
        self.given = np.log([entry.value for entry in entries])
        self.places: dict[tuple[str, bool], list[int]] = {}
        for place, entry in enumerate(entries):
            self.places.setdefault((entry.column, not entry.outage), []).append(place)
        self.weights = 1 / np.array([entry.rounding for entry in entries])
        heading = [entry.value for entry in entries if entry.column == "heading"]
        ranges = [_span(key) for key in _UNKNOWNS]
        if heading:
            ranges.append((1e-4 * min(heading), 1.2 * min(heading)))
        self.low, self.high = np.log(np.array(ranges)).T
        # Even in logarithms, the same each time; the residuals of all serve every fit.
        self.starts = np.random.default_rng(1).uniform(self.low, self.high, (_STARTS, len(ranges)))
        with np.errstate(all="ignore"):
            misses = self.residuals(self.starts.T)
        self.misses = np.nan_to_num(misses, nan=1e3, posinf=1e3, neginf=-1e3)

    def model(self, point: Array) -> Array:
        """Values of the entries [SI], (entries, n), of unknowns (unknowns, n)."""
        unknowns = np.exp(point)
        model = RealTime(inputs_of(self.design, dict(zip(_UNKNOWNS, unknowns[:4], strict=True))))
        values = np.empty((len(self.entries), *unknowns.shape[1:]), unknowns.dtype)
        # All times of a column at once: the model costs as much for one.
        for (name, settled), places in self.places.items():
            column = COLUMNS[name]
            value: ArrayLike = 0.0
            if not settled:
                value = model.value(column.outage, np.array([[self.entries[place].outage] for place in places]))
            elif column.settled:
                value = model.value(column.settled)
            if name == "heading":
                value = np.sqrt(np.asarray(value) ** 2 + unknowns[4] ** 2)
            values[places] = value
        return values

    def residuals(self, point: Array) -> Array:
        """Logarithm of model over given, in roundings: (entries, n)."""
        return np.asarray((np.log(self.model(point)) - self.given[:, None]) * self.weights[:, None])

    def slopes(self, point: Array) -> tuple[Array, Array]:
        """Residuals (entries,) and their derivatives (entries, unknowns), by a complex step of each unknown."""
        stepped = self.residuals(point[:, None] + 1j * _STEP * np.eye(len(point)))
        return stepped[:, 0].real, stepped.imag / _STEP

    def best(self, counted: Array, *before: Array) -> tuple[Array, float]:
        """The unknowns that fit the entries counted best, and their sum of squares."""
        from scipy.optimize import least_squares

        order = np.argsort((self.misses[counted] ** 2).sum(axis=0))[: _FITS - len(before)]
        unknowns, cost = self.starts[order[0]], math.inf
        for start in (*before, *self.starts[order]):
            at = lru_cache(maxsize=2)(lambda point: self.slopes(np.frombuffer(point)))
            fit = least_squares(
                lambda point, at=at: at(point.tobytes())[0][counted],
                np.clip(start, self.low + 1e-9, self.high - 1e-9),
                jac=lambda point, at=at: at(point.tobytes())[1][counted],
                bounds=(self.low, self.high), max_nfev=_EVALUATIONS,
            )  # fmt: skip
            if 2 * fit.cost < cost:
                unknowns, cost = fit.x, 2 * fit.cost
            if cost < _EXACT or (before and cost <= counted.sum()):
                break
        return unknowns, cost

    def factors(self, point: Array) -> list[float]:
        """Factors that the digits leave open for each unknown: two sigmas of even errors within the roundings."""
        _, sizes, axes = np.linalg.svd(self.slopes(point)[1])
        sizes = np.pad(sizes, (0, len(axes) - len(sizes)))
        spread = np.sqrt((axes**2 / np.maximum(sizes, 1e-6)[:, None] ** 2).sum(axis=0) / 3)
        return [math.exp(value) if value < 20 else math.inf for value in 2 * spread[:4]]

    def at_most(self, place: int, point: Array) -> float | None:
        """The largest value of the unknown at `place` with which some others give every entry to its digits.

        None where that is the largest value tried, or the search ends at none. `point` is a fit of all entries, which
        all agree.
        """
        from scipy.optimize import Bounds, minimize

        # A fit may miss an entry by more than its rounding while their sum agrees; then all may be missed by that.
        allowed = max(1.0, float(np.abs(self.residuals(point[:, None])).max()))
        at = lru_cache(maxsize=2)(lambda point: self.slopes(np.frombuffer(point)))

        def room(unknowns: Array) -> Array:
            misses, _ = at(unknowns.tobytes())
            return np.concatenate([allowed - misses, allowed + misses])

        def slopes_of_room(unknowns: Array) -> Array:
            _, slopes = at(unknowns.tobytes())
            return np.concatenate([-slopes, slopes])

        upwards = np.where(np.arange(len(point)) == place, -1.0, 0.0)
        best = -math.inf
        for start in (point, *self.starts[np.argsort((self.misses**2).sum(axis=0))[:1]]):
            end = minimize(
                lambda unknowns: float(upwards @ unknowns), start, jac=lambda _: upwards, method="SLSQP",
                constraints={"type": "ineq", "fun": room, "jac": slopes_of_room},
                bounds=Bounds(self.low, self.high), options={"maxiter": _EVALUATIONS, "ftol": _COARSE},
            ).x  # fmt: skip
            if room(end).min() > -_MISSED:
                best = max(best, float(end[place]))
        return math.exp(best) if self.low[place] <= best < self.high[place] - _MISSED else None

    def contradictions(self, point: Array) -> tuple[Contradiction, ...]:
        """Each entry without which the others agree; of a long table among those that make the least sum of squares.

        Leaving an entry out takes its square over what the fit leaves free of it off the sum, in a linear model.
        """
        misses, slopes = self.slopes(point)
        free = 1 - (slopes * np.linalg.pinv(slopes).T).sum(axis=1)
        likeliest = np.argsort(-(misses**2) / np.maximum(free, 1e-6))[:_MOST_TRIED]
        contradictions = []
        for index in sorted(likeliest):
            others = np.arange(len(self.entries)) != index
            rest, cost = self.best(others, point)
            if cost <= others.sum():
                known = float(self.model(rest[:, None])[index, 0])
                contradictions.append(Contradiction(self.entries[index], known))
        return tuple(contradictions)

    def missed(self, point: Array) -> tuple[Contradiction, ...]:
        """The two entries that the noise misses most, to either side."""
        values, misses = self.model(point[:, None])[:, 0], self.residuals(point[:, None])[:, 0]
        pair = int(misses.argmin()), int(misses.argmax())
        return tuple(Contradiction(self.entries[i], float(values[i])) for i in pair)


def _span(key: str) -> tuple[float, float]:
    """Values that are tried: those of a slider and a hundred times more to each side."""
    low, high = cast("tuple[float, float]", quantity(key).softbounds)
    return low / 100, high * 100
