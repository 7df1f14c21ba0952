"""Parameter types of a design: inputs with unit, bounds, help and a name for links.

One declaration serves the file reader, the link, the command line and the widgets. Values are SI.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from types import MappingProxyType
from typing import Any, TypeVar, cast

import param

from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.errors import InputError, not_a_choice, quoted
from nav_model.base.units import (
    Parsed,
    exact_bound,
    format_bound,
    format_quantity,
    join_quantity,
    parse_exact,
    shortest_decimal,
    with_point,
)

_T = TypeVar("_T")

BASE_LINE = "gnss.baseline"
"""Key of the distance from the base station."""
ON_BASE_LINE = (
    "gnss.position_noise", "gnss.vertical_position_noise", "gnss.correlated_noise", "gnss.vertical_correlated_noise",
)  # fmt: skip
"""Inputs that may grow with it: "1 cm + 1 ppm"."""
_NO_ERRORS = ("requirements", "flight", "coast", "radar", "motion", "oscillator")
"""Sections whose inputs are no errors of a 1σ."""
_COMPASS = {"latitude": "NS", "longitude": "EW"}


@dataclass(frozen=True)
class Alternative:
    """A second key for the same input, its reciprocal up to a constant.

    A GNSS interval may be given as a rate, a frequency as a wavelength: ``value = constant / alternative``.
    """

    key: str
    dimension: str
    unit: str
    constant: float


def in_sentence(label: object) -> str:
    """A label within a sentence: "position noise", but "IMU bandwidth"."""
    text = str(label)
    return text if text[:2].isupper() else f"{text[:1].lower()}{text[1:]}"


class Declared:
    """Base of the declaration of every input, whatever kind of value it takes.

    Attributes
    ----------
    key : str
        Dotted key, as in a design file.
    since : str
        Version that brought the input, if designs had been saved by then: at its default it leaves their hash as it
        was.
    """

    __slots__ = ()

    name: str | None
    owner: Any
    since: str

    @property
    def key(self) -> str:
        """Dotted key, as in a design file."""
        section = getattr(self.owner, "section", "")
        return f"{section}.{self.name}" if section else str(self.name)


class BaseQuantity(Declared, param.Number[_T]):
    """A number with a dimension; see `Quantity`."""

    __slots__ = [
        "alternative", "datasheet", "dimension", "in_ratio", "instead", "needs", "short", "since", "slider", "source",
        "typical", "unit", "unless", "variable", "when_empty",
    ]  # fmt: skip

    dimension: str
    unit: str
    short: str
    datasheet: str
    typical: str
    alternative: Alternative | None
    slider: bool
    when_empty: str
    instead: str
    in_ratio: tuple[str, ...]
    source: str
    needs: tuple[str, ...]
    unless: str
    variable: bool

    def __init__(
        self,
        default: float | None = None,
        *,
        dimension: str,
        unit: str,
        short: str,
        bounds: tuple[float, float],
        inclusive_bounds: tuple[bool, bool] = (True, True),
        softbounds: tuple[float, float] | None = None,
        datasheet: str = "",
        typical: str = "",
        alternative: Alternative | None = None,
        slider: bool = False,
        when_empty: str = "none",
        instead: str = "",
        in_ratio: tuple[str, ...] = (),
        source: str = "",
        needs: tuple[str, ...] = (),
        unless: str = "",
        variable: bool = True,
        since: str = "",
        **params: Any,
    ) -> None:
        self.dimension = dimension
        self.unit = unit
        self.short = short
        self.datasheet = datasheet
        self.typical = typical
        self.alternative = alternative
        self.slider = slider
        self.when_empty, self.instead, self.in_ratio = when_empty, instead, in_ratio
        self.source = source
        self.needs, self.unless = needs, unless
        self.variable = variable
        self.since = since
        low, high = (exact_bound(bound, unit, dimension) if dimension else bound for bound in bounds)
        super().__init__(  # type: ignore[misc]  # param's overloads name the two concrete cases only
            default=default,
            bounds=(low, high),
            inclusive_bounds=inclusive_bounds,
            softbounds=softbounds or bounds,
            constant=True,
            **params,
        )

    def __get__(self, obj: Any, objtype: type[Any] | None = None) -> _T:
        """Return the value without Param's check for functions of time, which no input is."""
        value: _T = param.Parameter.__get__(self, obj, objtype)
        return value

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest allowed value, SI."""
        low, high = cast("tuple[float, float]", self.bounds)
        return float(low), float(high)

    def used_in(self, part: param.Parameterized) -> bool:
        """True if the section of a design uses this input: it is given, and so is one that it needs."""

        def given(name: str) -> bool:
            return getattr(part, name) not in (None, False, ())

        needed = any(map(given, self.needs)) or not self.needs
        replaced = bool(self.unless) and given(self.unless)
        return needed and not replaced and getattr(part, str(self.name)) is not None

    def _validate(self, val: Any) -> None:
        if val is None and self.allow_None:
            return
        if isinstance(val, bool) or not isinstance(val, int | float):
            raise InputError(self.key, f"{quoted(val)} is not a number. {self.allowed()}", val)
        low, high = self.limits
        include_low, include_high = self.inclusive_bounds
        inside = (val >= low if include_low else val > low) and (val <= high if include_high else val < high)
        if not inside:  # NaN lands here too
            raise InputError(self.key, f"{self.show(float(val))} is not allowed. {self.allowed()}", val)

    def show(self, value: float, digits: int | None = 6) -> str:
        """Value in SI as text in this input's usual unit; without `digits` the shortest text that reads back."""
        if not math.isfinite(value):
            return f"{value}"
        if not self.dimension:
            return f"{value:.{digits}g}" if digits else repr(value).removesuffix(".0")
        return format_quantity(value, self.unit, self.dimension, digits=digits)

    def allowed(self, unit: str = "", reciprocal: bool = False) -> str:
        """The bounds as a sentence, in `unit` or the usual one; if `reciprocal`, those of the alternative."""
        low, high = self.limits
        include_low, include_high = self.inclusive_bounds
        dimension, subject, usual = self.dimension, in_sentence(self.label), self.unit
        if reciprocal and self.alternative:
            other = self.alternative
            dimension, subject, usual = other.dimension, other.key, other.unit
            include_low, include_high = include_high, include_low
            low, high = other.constant / high, other.constant / low
        at_low, at_high = (
            format_bound(bound, unit or usual, dimension, low=bound == low) if dimension else self.show(bound, None)
            for bound in (low, high)
        )
        below = "at least" if include_low else "more than"
        above = "at most" if include_high else "less than"
        return f"The {subject} must be {below} {at_low} and {above} {at_high}."

    def _asked(self, reciprocal: bool = False) -> str:
        """A sentence, with an example, that asks for a value where there is none."""
        low, high = cast("tuple[float, float]", self.softbounds)
        typical = self.default or (math.sqrt(low * high) if low > 0 else 0.0)
        if reciprocal and self.alternative:
            other = self.alternative
            example = format_quantity(other.constant / (typical or high), other.unit, other.dimension, digits=2)
            return f"Enter the {other.key}, for example {example}."
        example = self.show(typical, 6 if self.default else 1) if typical else DIMENSIONS[self.dimension].examples[0]
        return f"Enter the {in_sentence(self.label)}, for example {example}."

    def read(self, text: Any, key: str | None = None, baseline: float | None = None) -> Parsed:
        """A value written in a file, a link or a box -> SI and the unit to show it in.

        Parameters
        ----------
        text : object
            What was given.
        key : str, optional
            The name the value was given under, which may be the alternative's.
        baseline : float, optional
            Distance from the base station [m], for noise that grows with it.

        Raises
        ------
        InputError
            Naming the key, what was given and what is allowed.
        """
        where = self.key
        alternative = self.alternative
        reciprocal = alternative is not None and key == alternative.key
        if reciprocal:
            where = f"{where.rpartition('.')[0]}.{key}"
        if isinstance(text, str) and not text.strip():
            raise InputError(where, self._asked(reciprocal), text)
        if not self.dimension:
            return Parsed(self._plain(text, where), "")
        dimension = alternative.dimension if reciprocal and alternative else self.dimension
        if not isinstance(text, str):
            example = DIMENSIONS[dimension].examples[0]
            raise InputError(where, f'{quoted(text)} is not text in quotes. Write for example "{example}".', text)
        try:
            advice = "" if in_sentence(self.label) == dimension else self._asked(reciprocal)
            if baseline is None and where in ON_BASE_LINE:
                baseline = math.nan  # it is asked for
            letters = _COMPASS.get(str(self.label).lower(), "")
            exact, unit = parse_exact(text, dimension, advice, baseline=baseline, letters=letters)
            words = unit.partition(" ")[2] if DIMENSIONS[dimension].scale(unit).how else ""
            if words and where.partition(".")[0] in _NO_ERRORS:
                reason = f"{quoted(text)} states an accuracy, but the {in_sentence(self.label)} is not a 1σ"
                raise InputError(where, f"{reason}. Write {unit.partition(' ')[0]} alone.", text)
            if "vertical" in where and re.search(r"CEP|DRMS|HRMS|CE\d|R\d", words):
                raise InputError(where, f"{quoted(text)} is of a circle. Write for example LE90 or 95 %.", text)
        except InputError as error:
            raise InputError(where, error.reason, text) from error
        try:
            value = float(Fraction(alternative.constant) / exact if reciprocal and alternative else exact)
            self._validate(value)
        except (InputError, OverflowError, ZeroDivisionError) as error:
            problem = f"{quoted(text.strip())} is not allowed. {self.allowed(unit, reciprocal)}"
            raise InputError(where, problem, text) from error
        return Parsed(value, f"{alternative.key}:{unit}" if reciprocal and alternative else unit)

    def _plain(self, text: Any, where: str) -> float:
        number = text
        if isinstance(text, str):
            try:
                number = float(with_point(text.strip()))
            except ValueError:
                number = None
        if isinstance(number, bool) or not isinstance(number, int | float):
            raise InputError(where, f"{quoted(text)} is not a number. {self.allowed()}", text)
        number = math.inf if abs(number) >= 1e300 else float(number)  # no float holds a huge integer
        self._validate(number)
        return number

    def write(self, value: float, written: str, baseline: float | None = None) -> tuple[str, str | float]:
        """Key and value for a file or link, reading back to exactly the same float.

        `written` is the unit remembered from reading (``"wavelength:cm"`` for an alternative).
        """
        if not self.dimension:
            return str(self.name), value
        if self.alternative and ":" in written:
            return self.alternative.key, self._write_alternative(value, written.partition(":")[2])
        return str(self.name), format_quantity(value, written or self.unit, self.dimension, baseline=baseline or 0.0)

    def conversion(self, value: float, written: str, baseline: float | None = None) -> str:
        """Words for a value [SI] written as "0.2 m CEP": "0.2 m CEP = 0.170 m, 1σ per axis".

        Empty where it is a number of a usual unit.
        """
        if not written or ":" in written or written in DIMENSIONS[self.dimension].units:
            return ""
        text = format_quantity(value, written, self.dimension, 12, baseline=baseline or 0.0)
        usual = format_quantity(value, self.plain_unit(written), self.dimension, 3, zeros=True)
        return f"{text} = {usual}{DIMENSIONS[self.dimension].scale(written).how}"

    def plain_unit(self, written: str) -> str:
        """The usual unit in which a value that is written so is shown elsewhere."""
        if not written or written == self.unit:
            return self.unit
        unit = written.partition(" ")[0]
        return unit if unit in DIMENSIONS[self.dimension].units else self.unit

    def _write_alternative(self, value: float, unit: str) -> str:
        assert self.alternative is not None
        constant = Fraction(self.alternative.constant)
        factor = DIMENSIONS[self.alternative.dimension].scale(unit).size

        def reads_back(decimal: Fraction) -> bool:
            return decimal > 0 and float(constant / (decimal * factor)) == value

        return join_quantity(shortest_decimal(constant / Fraction(value) / factor, reads_back), unit)


class Quantity(BaseQuantity[float]):
    """A required input with a dimension.

    Parameters
    ----------
    default, bounds, softbounds : float
        SI. `softbounds` is the range a slider spans.
    dimension : str
        Key of `nav_model.base.units.DIMENSIONS`; empty for a plain number.
    unit : str
        Usual display unit.
    short : str
        Name in links.
    datasheet, typical : str
        Where to find the value on a data sheet; usual values by grade.
    alternative : Alternative, optional
        A second key for the same input.
    slider : bool
        Whether the page has a slider for it.
    source : str
        Name that a budget gives to the error of which this is the size; empty where it is not one.
    needs : tuple of str
        Inputs of the same section, of which one must be given or on; otherwise this one is not used.
    unless : str
        Input of the same section in whose place this one is used; not where that is given.
    variable : bool
        Whether a figure of the budget depends on it as a number: it can be ranked, mapped and swept.
    since : str
        As `Declared`.
    """


class OptionalQuantity(BaseQuantity[float | None]):
    """An input that may be left out (``None``); otherwise as `Quantity`.

    Parameters
    ----------
    when_empty : str
        What that means, as the page says it.
    instead : str
        Input of the same section whose value then holds.
    in_ratio : pair of str
        Inputs of the same section by whose ratio that value is then multiplied: first over second.
    """

    def __init__(self, **params: Any) -> None:
        super().__init__(allow_None=True, **params)


class Choice(Declared, param.Selector[Any]):
    """One of a few options.

    Parameters
    ----------
    options : mapping
        Option, as a file has it -> what a person reads.
    short : str
        Name in links.
    since : str
        As `Declared`.
    """

    __slots__ = ["options", "short", "since"]

    options: Mapping[Any, str]
    short: str

    def __init__(
        self, default: Any, *, options: Mapping[Any, str], short: str, since: str = "", **params: Any
    ) -> None:
        self.options, self.short, self.since = options, short, since
        super().__init__(default=default, objects=list(options), constant=True, **params)

    def _validate(self, val: Any) -> None:
        if not any(val == option and type(val) is type(option) for option in self.options):
            raise InputError(self.key, not_a_choice(val, map(_spelled, self.options)), val)

    def read(self, text: Any) -> Any:
        """The option `text` names.

        Raises
        ------
        InputError
            Listing the options.
        """
        for option in self.options:
            if text == option and type(text) is type(option):
                return option
            if isinstance(text, str) and not isinstance(option, str) and text.strip().lower() == _spelled(option):
                return option
        raise InputError(self.key, not_a_choice(text, map(_spelled, self.options)), text)


SWITCH: Mapping[Any, str] = MappingProxyType({False: "no", True: "yes"})
"""Options of an input that is on or off."""


def _spelled(option: Any) -> str:
    return str(option).lower() if isinstance(option, bool) else str(option)
