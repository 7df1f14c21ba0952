"""The real-time closed forms of one design as formulas of its inputs, for a spreadsheet.

The formulas are those of `nav_model.budget`, traced (`nav_model.base.traced`): none is written a second time.
Where there is none, the budget's value is taken: the sampled filter with velocity fixes, a slow GNSS error, what
vibration, unsensed motion and oscillator do over the aperture, and levels in decibels.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from app.document.wording import MOMENTS
from nav_model.analytic import coast as growth
from nav_model.analytic import steady_state as steady
from nav_model.analytic.discrete import Sawtooth
from nav_model.analytic.refined_coast import longest_rule
from nav_model.aperture import geometry, phase
from nav_model.base.traced import Traced, Workings
from nav_model.budget.contributors import NONE, Part, entering, parts_of, random_and_systematic
from nav_model.budget.fast import LEVELS
from nav_model.budget.figures import (
    FIGURES,
    IMAGING,
    PLACING,
    SETTLED,
    along_track_phase,
    begun,
    figures,
    free_growth,
    free_shifts,
    in_outage,
    outage,
    phase_sources,
    placing,
    sampled,
    settled,
    sigmas,
)
from nav_model.budget.inputs import VARIABLES, Inputs, inputs_of
from nav_model.budget.provenance import steady_marks
from nav_model.budget.verdict import limit_on, outage_mark
from nav_model.design import Design
from nav_model.design.contributors import BY_ORDER, COASTING, IN_OUTAGE, RESPONSE, label_of
from nav_model.design.parts import declaration_of
from nav_model.processing.geolocation import circular_error, ground_covariance

_WITHOUT_FORMULA: tuple[str, ...] = (
    "motion.", "oscillator.", "gnss.correlated_noise", "gnss.correlation_time", "processing.leg_after",
)  # fmt: skip
"""How the keys of inputs begin that no formula follows."""
_SI = {"length": "m", "speed": "m/s", "angle": "rad", "level": "", "loss": "dB"}
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
    sums : mapping of str to str
        Name of the cell of each figure of the budget, 1σ -> the dimension of its limit.
    sources : mapping of str to PhaseVariances
        Source of phase -> the symbols of its variances [m²].
    contributors : mapping of str to list of Part
        Those of each figure that has any, their size in a cell; the root of what is random is in the cell named
        root_FIGURE.
    """

    def __init__(self, design: Design) -> None:
        self.design, self.plain = design, replace(inputs_of(design), post_processed=False)
        self.workings = Workings(first=4)  # under title and heads
        self.followed: set[str] = set()
        self.sums: dict[str, str] = {}
        self.sources: dict[str, phase.PhaseVariances] = {}
        self.contributors: dict[str, list[Part]] = {}
        rule = zip(RULE, longest_rule(), strict=True)  # the one that integrates the outage, in cells
        self.rule: Any = tuple(Traced(name, part, self.workings) for name, part in rule)
        self.x = self._inputs()
        self.own = parts_of(design, self.x.wavelength)
        saw = self._settled()
        self._outage(saw)
        self._image(saw["start"])
        self._place(saw["start"])
        self._checked()
        self._limits(saw)

    def _cell(self, key: str) -> Any:
        value: Any = self.design[key]
        self.followed.add(key)
        return Traced(symbol_of(key), np.nan if value is None else np.float64(value), self.workings)

    def _or(self, key: str, otherwise: Traced) -> Any:
        """The input, or what is used where its cell is empty."""
        own, value = self._cell(key), self.design[key]
        used = otherwise.value if value is None else own.value
        return Traced(f'IF({own.text}="",{otherwise.text},{own.text})', used, self.workings)

    def _inputs(self) -> Inputs:
        """What `inputs_of` makes of cells in the place of numbers."""
        name, design = self.workings.name, self.design
        self.workings.head("Inputs as the formulas use them")
        without, instead = _WITHOUT_FORMULA, {"gnss.vertical_position_noise": "gnss.position_noise"}
        if self.plain.velocity is None:
            without = (*without, "gnss.velocity", "gnss.vertical_velocity")
        else:
            instead["gnss.vertical_velocity_noise"] = "gnss.velocity_noise"
            instead["gnss.velocity_interval"] = "gnss.interval"
        cells: dict[str, Any] = {key: self._cell(key) for key in VARIABLES if not key.startswith(without)}
        cells |= {key: self._or(key, cells[other]) for key, other in instead.items()}
        fixed = {key: declaration_of(key).default for key in design if key.startswith(_WITHOUT_FORMULA[:2])}
        still = design.replace(fixed)
        resolved = inputs_of(still, cells | {"radar.aperture_time": None}).aperture
        inside = name("aperture_by_resolution", resolved, "aperture time from the resolution", "s", "[S-3]")
        x = inputs_of(still, cells | {"radar.aperture_time": self._or("radar.aperture_time", inside)})
        named: list[tuple[str, ...]] = [
            ("sigma_a", "accelerometer noise in flight", "m/s/√s"),
            ("sigma_w", "gyro noise in flight", "rad/√s"),
            ("wavelength", "wavelength", "m", "[T-13]"),
            ("fix_vertical", "noise of a fix, vertical", "m"),
            ("aperture", "aperture time in force", "s"),
        ]
        if x.velocity is not None:
            named += [("velocity_vertical", "vertical velocity", "m/s"), ("velocity_interval", "interval", "s")]
        changes: dict[str, Any] = {symbol: name(symbol, getattr(x, symbol), *said) for symbol, *said in named}
        if (bias := self.plain.rectified) is not None:
            changes["rectified"] = name("rectified", bias, "bias caused by vibration", "m/s²", "[P-12]")
        mark, parts = "[P-8]", ("quadratic", "cubic", "left_1", "left_2", "left_3", "mean", "slope")
        changes["fast"] = {}
        for number, (source, own) in enumerate(self.plain.fast.items(), 1):
            cells = {
                part: name(f"source_{number}_{part}", getattr(own, part), f"{source}, {part}", "m²", mark, taken=True)
                for part in parts
            }
            changes["fast"][source] = replace(own, **cells)
        return replace(x, post_processed=False, **changes)

    def _sum(self, symbol: str, of: Any, label: str, dimension: str, mark: str, *, taken: bool = False) -> None:
        self.workings.name(symbol, of, label, _SI.get(dimension, dimension), mark, taken=taken)
        self.sums[symbol] = dimension

    def _figure(self, figure: str, of: Any, dimension: str, mark: str, *, taken: bool = False, key: str = "") -> None:
        """A figure that a requirement limits, with the contributors that enter it in cells of their own.

        `key` is what its cells are called after where `figure` is a name of the user's own.
        """
        key = key or figure
        if parts := entering(self.own, figure, post_processed=False):
            unit, found = _SI[dimension], []
            for part in parts:
                symbol = f"contributor_{len(self.contributors.get(figure, ())) + 1}_{key}"
                size = self.workings.name(symbol, part.size, f"{part.name}, 1σ in {label_of(figure)}", unit)
                found.append(replace(part, size=size))
                self.contributors.setdefault(figure, []).append(found[-1])
            root, systematic = random_and_systematic(of, found)
            of = self.workings.name(f"root_{key}", root, f"{label_of(figure)}, random", unit, mark, taken=taken)
            of, taken = of + systematic, False
        self._sum(f"real_time_{key}", of, label_of(figure), dimension, mark, taken=taken)

    def _channels(self, saw: Sawtooth, prefix: str, marks: tuple[str, str], *, taken: bool = False) -> Sawtooth:
        """Both channels' covariances, every element in a cell."""

        def named(channel: Any, label: str, mark: str) -> Any:
            cells = {}
            for field, element in channel._asdict().items():
                place = field[1:]
                said = f"{label} covariance {place}", _CHANNEL[place], mark
                cells[field] = self.workings.name(f"{prefix}_{field}", element, *said, taken=taken)
            return channel._replace(**cells)

        return Sawtooth(named(saw.horizontal, "horizontal", marks[0]), named(saw.vertical, "vertical", marks[1]))

    def _variances(self, symbol: str, of: Mapping[str, Any], label: str, mark: str) -> Iterator[Any]:
        """Variances by part, each in a cell."""
        for part, variance in of.items():
            yield self.workings.name(symbol.format(part), variance, f"{label}, {part}", "m²", mark)

    def _settled(self) -> dict[str, Sawtooth]:
        x, marks = self.x, steady_marks(self.design)
        closed_form = self.plain.slow is None and self.plain.velocity is None
        head = self.workings.head
        head("Steady state, average between fixes [T-3], [T-4], [P-6]")
        saw = {"closed": self._channels(settled(x), "closed", marks)}
        head("Just before a fix and just after it [T-8]")
        both = sampled(x if closed_form else self.plain)
        for state in ("prior", "posterior"):
            saw[state] = self._channels(getattr(both, state), state, ("[T-8]",) * 2, taken=not closed_form)
        start, closed = begun(self.plain), settled(self.plain)
        if np.allclose(np.hstack(start), np.hstack(closed), rtol=1e-12, atol=0):
            saw["start"] = saw["closed"]
        else:
            head("At the last fix before the aperture: no less than just after a fix, and with a slow GNSS error")
            saw["start"] = self._channels(start, "start", marks, taken=True)
        head("Steady state, 1σ")
        for state, when in MOMENTS.items():
            for figure, sigma in sigmas(saw["start" if state == "closed" else state], x).items():
                mark = "[T-8]" if state != "closed" else marks["vertical" in figure]
                label = f"{label_of(figure)}, {when}"
                self._sum(f"{state}_{figure}", sigma, label, limit_on(figure).dimension, mark)
        kappa = steady.gyro_dominance(x.sigma_a, x.sigma_w, x.s, x.g)
        self._sum("gyro_dominance", kappa, "Gyro dominance", "", "[T-6]")
        level, upright = saw["closed"]
        products = (
            steady.lambda_dt(level.p11, x.s, x.interval),
            steady.lambda_dt(upright.v11, x.s_vertical, x.interval),
        )
        self._sum("lambda_dt", np.maximum(*products), "Filter bandwidth times fix interval", "", "[T-8]")
        asymptotes = steady.gyro_dominated(x.sigma_w, x.s, x.g)
        kinds = {"position": "length", "velocity": "speed", "tilt": "angle"}
        for (part, dimension), variance in zip(kinds.items(), asymptotes, strict=True):
            self._sum(f"asymptote_{part}", np.sqrt(variance), f"{part.capitalize()}, gyro alone", dimension, "[T-7]")
        return saw

    def _outage(self, saw: Mapping[str, Sawtooth]) -> None:
        x = self.x
        self.workings.head("At the end of the outage")
        t = x.duration
        free = free_growth(x, saw["closed"], t)
        perfect = growth.perfect_start(x.sigma_a, x.sigma_w, x.g, t)
        tilted = growth.initial_tilt(saw["closed"].horizontal.p33, x.g, t)
        for label, variance, dimension, mark in (
            ("Horizontal position, polynomial", free["position_horizontal"], "length", "[T-9]"),
            ("Vertical position, polynomial", free["position_vertical"], "length", "[T-10]"),
            ("Horizontal velocity, polynomial", free["coast_horizontal_velocity"], "speed", "[T-9]"),
            ("Vertical velocity, polynomial", free["coast_vertical_velocity"], "speed", "[T-10]"),
            ("Tilt, polynomial", free["coast_tilt"], "angle", "[T-9]"),
            ("Yaw growth", free["coast_heading"], "angle", "[T-5]"),
            ("Horizontal position, perfect start", perfect[0], "length", "[T-11]"),
            ("Vertical position, perfect start", perfect[1], "length", "[T-11]"),
            ("Horizontal position from initial tilt", tilted, "length", "[T-12]"),
        ):
            symbol = "end_" + label.lower().replace(", ", "_").replace(" ", "_")
            self._sum(symbol, np.sqrt(variance), f"{label}, at the end of the outage", dimension, mark)
        for figure, variance in zip(COASTING, outage(x, saw["posterior"], t, self.rule), strict=True):
            self._figure(figure, np.sqrt(variance), "length", "[T-17]")

    def _limits(self, saw: Mapping[str, Sawtooth]) -> None:
        """What limits of the user's own limit, where that is no figure of before."""
        if self.design.limits:
            self.workings.head("Limited by requirements of your own")
        for number, limit in enumerate(self.design.limits, 1):
            if limit.on in (*FIGURES, *PLACING) and not in_outage(limit):
                continue
            of: Any = np.float64(0.0)
            time: Any = self.x.duration
            if limit.at is not None:
                time = Traced(repr(limit.at), np.float64(limit.at), self.workings)
            if limit.on in COASTING:
                of = np.sqrt(outage(self.x, saw["posterior"], time, self.rule)[COASTING.index(limit.on)])
            elif limit.on in IN_OUTAGE:
                of = np.sqrt(free_growth(self.x, saw["closed"], time)[limit.on])
            elif limit.on in BY_ORDER:
                other = replace(self.x, autofocus_order=BY_ORDER[limit.on])
                left = phase.total(phase_sources(other, saw["start"].horizontal))
                of = self.workings.cell("to_phase") * np.sqrt(left.detrended)
            elif limit.on in RESPONSE:
                others = {name: parts for name, parts in self.plain.own.items() if name != limit.name}
                of = figures(replace(self.plain, own=others), (limit.name,))[limit.name]
            taken, mark = limit.on in RESPONSE, outage_mark(limit.on)
            self._figure(limit.name, of, limit.dimension, mark, taken=taken, key=own_key(number))

    def _image(self, start: Sawtooth) -> None:
        x = self.x
        self.workings.head("Phase over the aperture, by source: variances along the line of sight [S-5], [S-6]")
        to_phase = self.workings.name("to_phase", x.to_phase, "phase of a metre", "rad/m", "[T-13]")
        for number, (source, made) in enumerate(phase_sources(x, start.horizontal).items(), 1):
            cells = self._variances(f"{{}}_{number}", made._asdict(), source, "[S-5], [S-6]")
            self.sources[source] = phase.PhaseVariances(*cells)
        whole = phase.total(self.sources)
        along = along_track_phase(x, start.horizontal)
        marks = ("[S-5]", "[S-2]", "[S-6]", "[T-15], [S-6]")
        values = (*(to_phase * np.sqrt(part) for part in whole),)
        for figure, value, mark in zip(IMAGING, (values[0], along, *values[1:]), marks, strict=True):
            self._figure(figure, value, "angle", mark)
        cell = geometry.cell_length(x.wavelength, x.slant_range, x.speed, x.aperture, x.squint)
        self._sum("cell_length", cell, "Azimuth cell", "length", "[S-3]")
        self._sum("aperture_length", x.aperture * x.speed, "Length of the aperture", "length", "[S-3]")
        for figure, value in figures(replace(self.plain, own=NONE), LEVELS).items():
            mark = {"paired_echo": "[P-9]", "islr": "[P-11]"}[figure]
            self._figure(figure, value, "level", mark, taken=bool(self.plain.fast))

    def _place(self, start: Sawtooth) -> None:
        x = self.x
        self.workings.head("Where the image lies [P-7]")
        shifts = free_shifts(x, start)
        moved = type(shifts)(*self._variances("shift_{}", shifts._asdict(), "variance of the shift", "[P-7]"))
        ground = ground_covariance(moved, x.grazing_angle, x.scene_height_error, x.squint)
        parts = dict(zip(("azimuth", "across", "both"), ground, strict=True))
        one, other, both = self._variances("ground_{}", parts, "on the ground", "[P-7]")
        placed = placing(x, moved, [figure for figure in PLACING if figure not in ("ce90", "cep")])
        placed |= {"ce90": circular_error(one, other, both), "cep": circular_error(one, other, both, share=0.5)}
        for figure in PLACING:
            self._figure(figure, placed[figure], "length", "[P-7]")

    def _checked(self) -> None:
        """Figures of the steady state at the point of the fix cycle that the design's limits hold for."""
        self.workings.head("Steady state that is checked")
        marks = steady_marks(self.design) if self.plain.steady_state == "closed" else ("[T-8]", "[T-8]")
        for figure in SETTLED:
            states = {state: self.workings.cell(f"{state}_{figure}") for state in MOMENTS}
            prior, closed, posterior = states.values()
            choice = f'IF({CHOICE}="prior",{prior.text},IF({CHOICE}="closed",{closed.text},{posterior.text}))'
            taken = any(state.taken for state in states.values())
            of = Traced(choice, states[self.plain.steady_state].value, self.workings, taken)
            self._figure(figure, of, limit_on(figure).dimension, marks["vertical" in figure])


def own_key(number: int) -> str:
    """What the cells of a limit of the user's own are called after."""
    return f"own_limit_{number}"


CHOICE = symbol_of("requirements.steady_state")
"""Name of the cell that chooses the point of the fix cycle."""

RULE = ("rule_nodes", "rule_weights")
"""Names of the two columns that integrate the outage."""
