"""The real-time closed forms of one design as formulas of its inputs, for a spreadsheet.

The formulas are those of `nav_model.budget`, traced (`nav_model.base.traced`): none is written a second time.
Where there is none, the budget's value is taken: the sampled filter with velocity fixes, a slow GNSS error, what
varying biases add, what vibration, unsensed motion and oscillator do over the aperture, and levels in decibels.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property, partial
from typing import Any, cast

import numpy as np

from app.document.wording import MOMENTS
from nav_model.analytic.discrete import Cycle, Sawtooth
from nav_model.analytic.refined_coast import longest_rule
from nav_model.analytic.turning import Bend, Turn
from nav_model.aperture import phase
from nav_model.base.traced import Traced, Workings
from nav_model.budget.contributors import Composed, Contribution, contributors_of
from nav_model.budget.inputs import VARIABLES, VARYING_KEYS, Inputs, inputs_of
from nav_model.budget.navigation import steady_marks
from nav_model.budget.real_time import RealTime
from nav_model.budget.shares import SEEN, SIZES
from nav_model.budget.smoothed import Smoothed
from nav_model.budget.varying import VaryingBiases
from nav_model.budget.verdict import Check
from nav_model.design import Design
from nav_model.design.figures import FIGURES, LEVELS, PARTS_OF_PHASES, REQUIRED, RESPONSE, STEADY, label_of, of_kind
from nav_model.design.parts import declaration_of
from nav_model.design.processing import POST_PROCESSED, REAL_TIME

_WITHOUT_FORMULA: tuple[str, ...] = (
    "motion.", "oscillator.", "gnss.correlated_noise", "gnss.vertical_correlated_noise", "gnss.correlation_time",
    "processing.leg_after", *VARYING_KEYS,
)  # fmt: skip
"""Starts of the keys of inputs that no formula follows."""
_STEP = 1e-6
"""Of a source's size, as a part of it: wide enough for rounding, and the share is right to as many digits."""
_WITH_SHARES = ("phase", "place", "steady", "outage")
"""Kinds of figures whose shares have a formula."""
_SI = {"length": "m", "speed": "m/s", "angle": "rad", "level": "", "loss": "dB"}
_MOMENT = MOMENTS | {"start": "at the last fix"}
_CHANNEL = {"11": "m²", "12": "m²/s", "13": "m rad", "22": "m²/s²", "23": "m/s rad", "33": "rad²"}


def symbol_of(key: str) -> str:
    """The name of an input's cell."""
    return key.replace(".", "_")


class Traces:
    """The workings of a design in real time, whatever its processing: made group by group.

    Attributes
    ----------
    workings : Workings
    followed : set of str
        Keys of the inputs that the formulas follow; each is a cell in SI under the name of `symbol_of`.
    sources : mapping of str to PhaseVariances
        Source of phase -> the symbols of its variances [m²].
    contributors : mapping of (processing, figure) to list of Part
        Those of each figure that has any, their size in a cell; the root of what is random is in the cell named
        root_FIGURE.
    responses : set of str
        Names of the cells of the impulse response, which no formula has and contributors change.
    """

    def __init__(self, design: Design) -> None:
        self.design, self.plain = design, RealTime(inputs_of(design))
        self.workings = Workings(first=4)  # under title and heads
        self.followed: set[str] = set()
        self.sources: dict[str, phase.PhaseVariances] = {}
        self.contributors: dict[tuple[str, str], list[Contribution]] = {}
        self.responses: set[str] = set()
        self._of_model: dict[tuple[str, str], Any] = {}  # the same figures without them
        rule = zip(RULE, longest_rule(), strict=True)  # the one that integrates the outage, in cells
        self.rule: Any = tuple(Traced(name, part, self.workings) for name, part in rule)
        self.x = self._inputs()
        self.counted_contributors = contributors_of(design, self.x.wavelength, self._counted())
        self.model = RealTime(self.x, self.rule)
        if self.plain.varying is not None:
            self.model.varying = VaryingBiases(self.plain.x, partial(self._constant, taken=True))
        self._settled()
        self._outage()
        self._image()
        self._place()
        self._checked()
        self._limits()
        self._post_processed()

    def _constant(self, value: float, *, taken: bool = False) -> Traced:
        return self.workings.traced(np.float64(value), taken=taken)

    def _counted(self) -> Mapping[str, Traced]:
        """Contributors with their allowances, as their cells have them."""
        counted = {}
        for number, entry in enumerate(self.design.contributors, 1):
            key = contributor_key(number)
            value = Traced(key, np.float64(entry.value), self.workings)
            counted[entry.name] = value * (1 + Traced(f"{key}_allowance", np.float64(entry.allowance), self.workings))
        return counted

    def _cell(self, key: str) -> Any:
        value: Any = self.design[key]
        self.followed.add(key)
        return Traced(symbol_of(key), np.nan if value is None else np.float64(value), self.workings)

    def _or(self, key: str, otherwise: Traced) -> Any:
        """The input, or what is used where its cell is empty."""
        cell, value = self._cell(key), self.design[key]
        used = otherwise.value if value is None else cell.value
        return Traced(f'IF({cell.text}="",{otherwise.text},{cell.text})', used, self.workings)

    def _inputs(self) -> Inputs:
        """Inputs as `inputs_of` makes them, of cells in the place of numbers."""
        name, design = self.workings.name, self.design
        self.workings.head("Inputs as the formulas use them")
        without, instead = _WITHOUT_FORMULA, {"gnss.vertical_position_noise": "gnss.position_noise"}
        if self.plain.x.velocity is None:
            without = (*without, "gnss.velocity", "gnss.vertical_velocity")
        else:
            instead["gnss.vertical_velocity_noise"] = "gnss.velocity_noise"
            instead["gnss.velocity_interval"] = "gnss.interval"
        without = (*without, *(key for key in VARIABLES if key.startswith("autofocus") and design[key] is None))
        cells: dict[str, Any] = {key: self._cell(key) for key in VARIABLES if not key.startswith(without)}
        cells |= {key: self._or(key, cells[other]) for key, other in instead.items()}
        defaults = (*_WITHOUT_FORMULA[:2], *VARYING_KEYS)
        fixed = {key: declaration_of(key).default for key in design if key.startswith(defaults)}
        still = design.replace(fixed)
        resolved = inputs_of(still, cells | {"radar.aperture_time": None}).aperture
        inside = name("aperture_by_resolution", resolved, "Aperture time from the resolution", "s", "[S-3]")
        x = inputs_of(still, cells | {"radar.aperture_time": self._or("radar.aperture_time", inside)})
        named: list[tuple[str, ...]] = [
            ("sigma_a", "Accelerometer noise in flight", "m/s/√s"),
            ("sigma_w", "Gyro noise in flight", "rad/√s"),
            ("wavelength", "Wavelength", "m", "[T-13]"),
            ("fix_vertical", "Vertical noise of a fix", "m"),
            ("aperture", "Aperture time", "s"),
        ]
        if x.velocity is not None:
            named += [
                ("velocity_vertical", "Vertical noise of a velocity fix", "m/s"),
                ("velocity_interval", "Interval of velocity fixes", "s"),
            ]
        changes: dict[str, Any] = {symbol: name(symbol, getattr(x, symbol), *words) for symbol, *words in named}
        if (bias := self.plain.x.rectified) is not None:
            changes["rectified"] = name("rectified", bias, "Bias caused by vibration", "m/s²", "[P-12]")
        mark, parts = "[P-8]", ("quadratic", "cubic", "left_1", "left_2", "left_3", "mean", "slope")
        changes["fast"] = {}
        for number, (source, fast) in enumerate(self.plain.x.fast.items(), 1):
            cells = {
                part: name(
                    f"source_{number}_{part}", getattr(fast, part), f"{source}, {part}", "m²", mark, taken=True
                )
                for part in parts
            }
            changes["fast"][source] = replace(fast, **cells)
        if self.plain.varying is not None:  # of these, formulas have what they make of tilt and heading
            for field in ("instability_w", "time_w", "walk_a", "walk_w"):
                changes[field] = self._constant(float(getattr(self.plain.x, field)), taken=True)
        return replace(x, **changes)

    def _figure(
        self, figure: str, of: Any, mark: str = "", *, taken: bool = False, key: str = "", limit: str = ""
    ) -> None:
        """A figure, with the contributors that enter it in cells of their own; or a contributor by itself.

        `key` is what its cells are called after, and `limit` its name, where a limit of the user's own asks for it.
        """
        key, label = key or figure, label_of(limit or figure)
        dimension = FIGURES[figure].dimension if figure in FIGURES else self._dimensions[figure]
        mark = mark or (FIGURES[figure].mark if figure in FIGURES else "")
        of = self.workings.traced(of, taken=taken)
        whole = self._with(REAL_TIME, figure, of, limit or figure, key, _SI[dimension], mark)
        self.workings.name(f"real_time_{key}", whole, label, _SI[dimension], mark)

    def _with(self, processing: str, on: str, of: Traced, name: str, key: str, unit: str, mark: str) -> Traced:
        """A figure with its contributors, the size of each in a cell, and the root of what is random."""
        self._of_model[processing, name] = of
        figure = self.counted_contributors.composed(on, processing, of)
        if not figure.parts:
            return of
        label, cell, prefix = label_of(name), self.workings.name, "" if processing == REAL_TIME else "smoothed_"
        self.contributors[processing, name] = sized = [
            replace(part, size=cell(f"{prefix}contributor_{n}_{key}", part.size, f"{part.name}, 1σ in {label}", unit))
            for n, part in enumerate(figure.parts, 1)
        ]
        figure = replace(figure, parts=tuple(sized))
        return cell(f"{prefix}root_{key}", figure.random, f"{label}, random", unit, mark) + figure.systematic

    def _channels(self, saw: Sawtooth, prefix: str, marks: tuple[str, str], *, taken: bool = False) -> Sawtooth:
        """Both channels' covariances, every element in a cell."""

        def named(channel: Any, label: str, mark: str) -> Any:
            cells = {}
            for field, element in channel._asdict().items():
                place = field[1:]
                words = f"{label} covariance {place}, {_MOMENT[prefix]}", _CHANNEL[place], mark
                cells[field] = self.workings.name(f"{prefix}_{field}", element, *words, taken=taken)
            return channel._replace(**cells)

        return Sawtooth(named(saw.horizontal, "Horizontal", marks[0]), named(saw.vertical, "Vertical", marks[1]))

    def _variances(self, symbol: str, of: Mapping[str, Any], label: str, mark: str) -> Iterator[Any]:
        """Variances by part, each in a cell."""
        for part, variance in of.items():
            yield self.workings.name(
                symbol.format(part), variance, f"{label[:1].upper()}{label[1:]}, {part}", "m²", mark
            )

    def _settled(self) -> None:
        """The filter, its covariances in cells that the model then goes on from."""
        marks, model, plain = steady_marks(self.design), self.model, self.plain
        closed_form = plain.x.slow is None and plain.x.velocity is None
        head = self.workings.head
        head("Steady state, average between fixes [T-3], [T-4], [P-6]")
        model.closed = self._channels(model.closed, "closed", marks)
        head("Just before a fix and just after it [T-8]")
        ends = (model if closed_form else plain).cycle
        model.cycle = Cycle(
            *(
                self._channels(getattr(ends, state), state, ("[T-8]",) * 2, taken=not closed_form)
                for state in ("prior", "posterior")
            )
        )
        if np.allclose(np.hstack(plain.at_last_fix), np.hstack(plain.closed), rtol=1e-12, atol=0):
            model.at_last_fix = model.closed
        else:
            head("At the last fix before the aperture: no less than just after a fix, and with a slow GNSS error")
            model.at_last_fix = self._channels(plain.at_last_fix, "start", marks, taken=True)
        head("Steady state, 1σ")
        for state, when in MOMENTS.items():
            then = model.at(model.moment(state))
            for name in STEADY:
                mark = "[T-8]" if state != "closed" else marks["vertical" in name]
                label = f"{label_of(name)}, {when}"
                self.workings.name(f"{state}_{name}", then.value(name), label, _SI[FIGURES[name].dimension], mark)

    def _outage(self) -> None:
        self.workings.head("At the end of the outage")
        for name in of_kind("outage"):
            self._figure(name, self.model.value(name))

    def _limits(self) -> None:
        """Write the values under limits of the user's own, where they are no figure of before."""
        self._dimensions = {contributor.name: contributor.dimension for contributor in self.design.contributors}
        if self.design.limits:
            self.workings.head("Limited by requirements of your own")
        for number, limit in enumerate(self.design.limits, 1):
            if f"real_time_{limit.on}" in self.workings.named and limit.at is None:
                continue
            of: Any = np.float64(0.0)
            if limit.at is not None:
                of = self.model.value(limit.on, cast("Any", self._constant(limit.at)))
            elif limit.on in FIGURES:
                of = (self.plain if limit.on in RESPONSE else self.model).value(limit.on)
            self._figure(limit.on, of, taken=limit.on in RESPONSE, key=limit_key(number), limit=limit.name)
            if limit.on in RESPONSE:
                self.responses |= {f"{prefix}_{limit_key(number)}" for prefix in ("real_time", "post_processed")}

    def _image(self) -> None:
        x, model = self.x, self.model
        self.workings.head("Phase over the aperture, by source: variances along the line of sight [S-5], [S-6]")
        model.to_phase = self.workings.name("to_phase", x.to_phase, "Phase of a metre", "rad/m", "[T-13]")
        for number, (source, variances) in enumerate(model.phases.items(), 1):
            cells = self._variances(f"{{}}_{number}", variances._asdict(), source, "[S-5], [S-6]")
            self.sources[source] = phase.PhaseVariances(*cells)
        model.phases = self.sources
        self.workings.head(
            "The turn of the line of sight: weights, and covariances of position and velocity errors [S-8]"
        )
        model.turn = Turn(*self._both("turn", "Turn", model.turn, ""))
        model.quadratic_bend = self._both("quadratic_bend", "Quadratic", model.quadratic_bend, "m²")
        model.cubic_bend = self._both("cubic_bend", "Cubic", model.cubic_bend, "m²")
        self.workings.head("Phase over the aperture, 1σ")
        for name in of_kind("phase"):
            if name in (*REQUIRED, *PARTS_OF_PHASES):
                self._figure(name, model.value(name))
        for name in LEVELS:
            self._figure(name, self.plain.value(name), taken=bool(x.fast) or x.estimation is not None)

    def _both(self, symbol: str, label: str, pair: tuple[Bend, Bend], unit: str) -> tuple[Bend, Bend]:
        """Covariances of a horizontal axis and of the vertical, or their weights, every element in a cell."""
        horizontal, vertical = (
            Bend(
                *(
                    self.workings.name(
                        f"{symbol}_{axis}_{part}", of, f"{label}, {part.replace('_', ' ')}, {axis}", unit, "[S-8]"
                    )
                    for part, of in bend._asdict().items()
                )
            )
            for axis, bend in zip(("horizontal", "vertical"), pair, strict=True)
        )
        return horizontal, vertical

    def _place(self) -> None:
        model = self.model
        self.workings.head("Where the image lies [P-7]")
        shift = model.shift
        model.shift = type(shift)(*self._variances("shift_{}", shift._asdict(), "Variance of the shift", "[P-7]"))
        parts = dict(zip(("azimuth", "across", "both"), model.ground, strict=True))
        first, second, product = self._variances("ground_{}", parts, "Variance on the ground", "[P-7]")
        model.ground = first, second, product
        for name in of_kind("place"):
            self._figure(name, model.value(name))

    def _checked(self) -> None:
        """Figures of the steady state at the point of the fix cycle that the design's limits hold for."""
        self.workings.head("Steady state that is checked")
        closed = self.plain.x.steady_state == "closed"
        for name in STEADY:
            states = {state: self.workings.cell(f"{state}_{name}") for state in MOMENTS}
            prior, average, posterior = states.values()
            choice = f'IF({CHOICE}="prior",{prior.text},IF({CHOICE}="closed",{average.text},{posterior.text}))'
            taken = any(state.taken for state in states.values())
            of = Traced(choice, states[self.plain.x.steady_state].value, self.workings, taken)
            mark = steady_marks(self.design)["vertical" in name] if closed else "[T-8]"
            self._figure(name, of, mark)

    def _post_processed(self) -> None:
        """Figures that a smoother changes: no formula has them, but what enters them beside the model follows."""
        self.workings.head("Post-processed: NavBudget's values, with the contributors")
        smoothed = Smoothed(self.plain.x)
        limits = {limit.name: (limit_key(number), limit.on) for number, limit in enumerate(self.design.limits, 1)}
        for name in (*REQUIRED, *limits):
            key, on = limits.get(name, (name, name))
            figure = FIGURES.get(on)
            if figure and not figure.smoothed_mark:  # the same as in real time
                continue
            of = self._constant(float(smoothed.value(on)) if figure else 0.0, taken=figure is not None)
            unit, mark = (
                _SI[figure.dimension if figure else self._dimensions[on]],
                figure.smoothed_mark if figure else "",
            )
            whole = self._with(POST_PROCESSED, on, of, name, key, unit, mark)
            self.workings.name(f"post_processed_{key}", whole, label_of(name), unit, mark)

    @cached_property
    def _stepped(self) -> Mapping[str, RealTime]:
        """Source -> the model with its size a step larger, the settled filter at the average of its cycle."""
        x, whole = self.x, self.model.at(self.model.at_last_fix)
        models = {"": whole}
        for source, fields in SIZES.items():
            sizes = {field: getattr(x, field) for field in fields if getattr(x, field) is not None}
            if x.slow is not None or whole.varying is not None or not sizes:
                continue
            model = RealTime(replace(x, **{field: size * (1 + _STEP) for field, size in sizes.items()}), self.rule)
            same = source not in SEEN  # the filter is
            if same:
                model.closed = whole.closed
            if same or x.velocity is not None:  # whose cycle has no formula
                model.cycle = whole.cycle
            model.at_last_fix = model.closed if whole.at_last_fix is whole.closed else whole.at_last_fix
            models[source] = model.at(model.at_last_fix)
        return models

    def _of_sources(self, check: Check, at: float | None) -> Mapping[str, Traced]:
        """Shares of the sources in a figure without contributors, by its change for a step of each; none of a figure
        that is zero. [T-18]"""
        time: Any = None if at is None else self._constant(at)
        values = {
            source: self.workings.traced(model.value(check.on, time)) for source, model in self._stepped.items()
        }
        whole = values.pop("")
        if not whole.value:
            return {}
        return {source: np.maximum((value / whole - 1) / _STEP, 0.0) for source, value in values.items()}

    def shares_of(self, check: Check, processing: str) -> Mapping[str, Traced]:
        """Source or contributor -> its share of the variance of what is checked, `taken` without a formula."""
        if check.on in FIGURES and not FIGURES[check.on].smoothed_mark:  # the same in both
            processing = REAL_TIME
        key = next(key for name in (check.name, check.on) if (key := (processing, name)) in self._of_model)
        parts = self.contributors.get(key, [])
        shares: Mapping[str, Traced] = {}
        at = next((limit.at for limit in self.design.limits if limit.name == check.name), None)
        if processing == REAL_TIME and check.on in FIGURES and FIGURES[check.on].kind in _WITH_SHARES:
            shares = self._of_sources(check, at)
        if not shares or any(share.taken for share in shares.values()):
            entering = {part.name for part in parts}
            rest = {source: share for source, share in check.shares.items() if source not in entering}
            whole = sum(rest.values())
            shares = {source: self._constant(share / whole, taken=True) for source, share in rest.items()}
        with np.errstate(invalid="ignore", divide="ignore"):  # all of it zero
            mixed = Composed(self._of_model[key], shares, tuple(parts)).shares
        self.workings.label_steps(f"Shares in {label_of(check.name)}, {processing}")
        return cast("Mapping[str, Traced]", mixed)


def contributor_key(number: int) -> str:
    """Start of the names of the cells of a contributor of the user's own."""
    return f"contributor_{number}"


def limit_key(number: int) -> str:
    """Start of the names of the cells of a limit of the user's own."""
    return f"own_limit_{number}"


CHOICE = symbol_of("requirements.steady_state")
"""Name of the cell that chooses the point of the fix cycle."""

RULE = ("rule_nodes", "rule_weights")
"""Names of the two columns that integrate the outage."""
