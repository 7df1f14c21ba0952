"""Inputs of a study beyond those of the closed forms: sensor errors, receiver and filter.

A design holds what the closed forms take. The simulator flies more; each such input is declared here once,
with unit, bounds and help, and the command line and the page are derived from it. All default to nothing.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

from nav_model.base.constants import DEGREE, DEGREE_PER_HOUR, MILLI_G
from nav_model.base.errors import InputError
from nav_model.design.declaration import BaseQuantity, OptionalQuantity, Quantity
from nav_model.design.parts import Part
from nav_model.simulation.specification import FilterModel, InitialSigma, SimulationSpec, TriadModel

_TRIAD, _FILTER, _INITIAL = TriadModel(), FilterModel(), InitialSigma()


def _input(
    default: float | None, dimension: str, unit: str, bounds: tuple[float, float], label: str, doc: str
) -> Any:
    """An input of a study; a default of None: may be left out."""
    kind: Any = OptionalQuantity if default is None else Quantity
    return kind(default=default, dimension=dimension, unit=unit, short="", bounds=bounds, label=label, doc=doc)


def _nothing(dimension: str, unit: str, highest: float, label: str, doc: str) -> Any:
    """An input that is zero unless given."""
    return _input(0.0, dimension, unit, (0.0, highest), label, doc)


def _correlation_time() -> Any:
    doc = "Time constant of the bias instability, a first-order Gauss-Markov process."
    return _input(_TRIAD.correlation_time, "time", "s", (1e-3, 1e9), "Correlation time", doc)


_TURN_ON = (
    "Constant through a flight, 1σ per axis, drawn for each run. The filter estimates it, unlike the residual bias."
)


class Gyro(Part):
    """Gyroscope errors in addition to the white noise and the residual bias of the design."""

    section = "gyro"
    title = "Gyros"

    turn_on_bias = _nothing("angular rate", "°/h", 1e5 * DEGREE_PER_HOUR, "Turn-on bias", _TURN_ON)
    bias_instability = _nothing(
        "angular rate",
        "°/h",
        1e5 * DEGREE_PER_HOUR,
        "Bias instability",
        "Gauss-Markov bias, 1σ per axis, in its steady state.",
    )
    correlation_time = _correlation_time()
    rate_random_walk = _nothing(
        "rate random walk",
        "°/h/√h",
        1e5 * DEGREE_PER_HOUR / 60,
        "Rate random walk",
        "Density of the white noise that drives the bias.",
    )
    scale_factor = _nothing("ratio", "ppm", 0.1, "Scale factor error", "1σ per axis, drawn for each run.")
    misalignment = _nothing("angle", "mrad", 0.1, "Misalignment", "1σ of each of six angles, drawn for each run.")
    quantization = _nothing("angle", "arcsec", 0.1, "Quantization", "Size of one count of the integrated angle.")


class Accelerometer(Part):
    """Accelerometer errors in addition to the white noise and the residual bias of the design."""

    section = "accelerometer"
    title = "Accelerometers"

    turn_on_bias = _nothing("acceleration", "mg", 1000 * MILLI_G, "Turn-on bias", _TURN_ON)
    bias_instability = _nothing(
        "acceleration",
        "mg",
        1000 * MILLI_G,
        "Bias instability",
        "Gauss-Markov bias, 1σ per axis, in its steady state.",
    )
    correlation_time = _correlation_time()
    rate_random_walk = _nothing(
        "acceleration random walk", "µg/√h", 10 * MILLI_G, "Acceleration random walk",
        "Density of the white noise that drives the bias.",
    )  # fmt: skip
    scale_factor = _nothing("ratio", "ppm", 0.1, "Scale factor error", "1σ per axis, drawn for each run.")
    misalignment = _nothing("angle", "mrad", 0.1, "Misalignment", "1σ of each of six angles, drawn for each run.")
    quantization = _nothing("speed", "mm/s", 10.0, "Quantization", "Size of one count of the integrated velocity.")


def _arm(label: str) -> Any:
    doc = "Antenna position relative to the IMU, body axes; known to the filter."
    return _input(0.0, "length", "m", (-200.0, 200.0), f"Antenna {label}", doc)


class Receiver(Part):
    """The receiver's inputs in addition to its position fixes."""

    section = "receiver"
    title = "Receiver"

    velocity_noise = _input(
        None, "speed", "cm/s", (1e-5, 1e3), "Velocity noise", "1σ per axis and fix. Leave empty to use position only."
    )
    lever_forward = _arm("forward")
    lever_right = _arm("to the right")
    lever_down = _arm("below")


def _scale(label: str, doc: str) -> Any:
    return _input(1.0, "", "", (1e-3, 1e3), label, doc)


class Filter(Part):
    """The filter's tuning, as factors on the standard deviations it is told: 1 is matched."""

    section = "filter"
    title = "Filter"

    process_noise_scale = _scale(
        "Process noise factor", "Factor on the process noise that the filter assumes; 0.71 halves the variance."
    )
    gnss_noise_scale = _scale("Fix noise factor", "Factor on the fix noise that the filter assumes.")
    propagation_rate = _input(
        _FILTER.propagation_rate, "frequency", "Hz", (0.5, 1e4), "Propagation rate",
        "Covariance steps per second, between fixes.",
    )  # fmt: skip
    initial_yaw = _input(
        _INITIAL.yaw, "angle", "°", (1e-6 * DEGREE, 20 * DEGREE), "Initial yaw error",
        "1σ at the start; drawn for each run and used as the initial covariance of the filter.",
    )  # fmt: skip


STUDY_PARTS: Final[tuple[type[Part], ...]] = (Gyro, Accelerometer, Receiver, Filter)
STUDY_KEYS: Final[Mapping[str, BaseQuantity[Any]]] = {
    f"{part.section}.{name}": declaration
    for part in STUDY_PARTS
    for name, declaration in part.inputs().items()
    if isinstance(declaration, BaseQuantity)
}
"""Dotted key -> declaration, in the order they are shown."""

SECTIONS: Final = tuple(part.section for part in STUDY_PARTS)


@dataclass(frozen=True)
class SimulationInputs:
    """The inputs given, as (key, value in SI) in the order of `STUDY_KEYS`; hashable and picklable.

    Raises InputError for an unknown key or a value out of bounds.
    """

    given: tuple[tuple[str, float], ...] = ()

    def __post_init__(self) -> None:
        for key, value in self.given:
            _declared(key)._validate(value)

    def __getitem__(self, key: str) -> float | None:
        """Value in SI under a dotted key."""
        value: float | None = dict(self.given).get(key, _declared(key).default)
        return value

    def _section(self, section: str) -> Iterator[tuple[str, float]]:
        for key, value in self.given:
            prefix, _, name = key.partition(".")
            if prefix == section:
                yield name, value

    def triad(self, section: str, random_walk: float, residual_bias: float) -> TriadModel:
        """The triad "gyro" or "accelerometer" with the design's noise and bias and what is added to them."""
        return TriadModel(random_walk=random_walk, residual_bias=residual_bias, **dict(self._section(section)))

    def lever_arm(self) -> tuple[float, float, float]:
        """Antenna from the IMU, forward, right, down [m]."""
        forward, right, down = (self[f"receiver.lever_{way}"] or 0.0 for way in ("forward", "right", "down"))
        return forward, right, down

    def filter(self, states: int) -> FilterModel:
        """The filter of so many states with this tuning."""
        tuning = {name: value for name, value in self._section("filter") if name != "initial_yaw"}
        return FilterModel(states=states, **tuning)


NOTHING_ADDED: Final = SimulationInputs()


def read_study_inputs(texts: Mapping[str, str]) -> SimulationInputs:
    """Values written with units, by dotted key; an empty text is not given.

    Raises
    ------
    InputError
        Naming the key, what was given and what is allowed.
    """
    values = {key: _declared(key).read(text).value for key, text in texts.items() if text.strip()}
    return SimulationInputs(tuple((key, values[key]) for key in STUDY_KEYS if key in values))


def split_changes(changes: Iterable[str]) -> tuple[list[str], dict[str, str]]:
    """KEY=VALUE changes sorted into the design's own and those of the study."""
    of_design: list[str] = []
    of_study: dict[str, str] = {}
    for change in changes:
        key, equals, text = change.partition("=")
        if equals and key.strip().partition(".")[0] in SECTIONS:
            of_study[key.strip()] = text.strip()
        else:
            of_design.append(change)
    return of_design, of_study


def _declared(key: str) -> BaseQuantity[Any]:
    if key not in STUDY_KEYS:
        raise InputError(key, f"unknown key; a study takes {', '.join(STUDY_KEYS)}")
    return STUDY_KEYS[key]


def added(spec: SimulationSpec, velocity: float | None = None) -> dict[str, float]:
    """Values of `STUDY_KEYS` in a specification other than their defaults, by key, in SI.

    velocity: noise of the design's own velocity fixes [m/s], which are not an addition.
    """
    values: dict[str, float | None] = {}
    for section, triad in (("gyro", spec.imu.gyro), ("accelerometer", spec.imu.accelerometer)):
        for name in (key.partition(".")[2] for key in STUDY_KEYS if key.startswith(section + ".")):
            values[f"{section}.{name}"] = getattr(triad, name)
        if not triad.bias_instability:
            del values[f"{section}.correlation_time"]  # of nothing
    values["receiver.velocity_noise"] = None if spec.gnss.velocity_noise == velocity else spec.gnss.velocity_noise
    for way, length in zip(("forward", "right", "down"), spec.gnss.lever_arm, strict=True):
        values[f"receiver.lever_{way}"] = length
    for name in ("process_noise_scale", "gnss_noise_scale", "propagation_rate"):
        values[f"filter.{name}"] = getattr(spec.filter, name)
    values["filter.initial_yaw"] = spec.initial.yaw
    return {
        key: value
        for key, value in values.items()
        if value is not None and (value != STUDY_KEYS[key].default or key.endswith("correlation_time"))
    }
