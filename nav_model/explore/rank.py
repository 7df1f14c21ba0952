"""Inputs to improve first: exact logarithmic sensitivities of a figure to every input.

The derivative is a complex step through the same closed forms that give the figure (`nav_model.budget.figures`): the
input is multiplied by 1 + i·10⁻²⁰ and the imaginary part read off. Nothing is subtracted, so the derivative is
exact to rounding. All inputs are stepped in one broadcast evaluation. Of a contributor of the user's own the
derivative is its share (`nav_model.budget.contributors`).

Source: Squire and Trapp, *Using complex variables to estimate derivatives of real functions*, SIAM Review
40(1), 1998. For noises it must agree with [T-18].
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError, not_a_choice
from nav_model.budget.figures import figures
from nav_model.budget.inputs import VARIABLES, Replacement, inputs_of
from nav_model.budget.refusals import imaged_inputs
from nav_model.budget.smoothed import model_of
from nav_model.design import Design
from nav_model.design.declaration import in_sentence
from nav_model.design.figures import FIGURES, OF_BUDGET
from nav_model.design.parts import quantity
from nav_model.explore.margins import Columns, least, usual_range

_STEP = 1e-20
RANKED = tuple(name for name in OF_BUDGET if FIGURES[name].kind != "response")
"""Figures that have a derivative: a measure of the impulse response is read off a curve."""
SENSORS: Mapping[str, str] = {key: source for key in VARIABLES if (source := quantity(key).source)}
"""Inputs that are error sources -> the name a budget gives the source."""


@dataclass(frozen=True)
class InputSensitivity:
    """Dependence of a figure on one input, or on a contributor of the user's own, whose name is the ``label``.

    ``slope`` is d ln(figure)/d ln(input). ``halved`` and ``doubled`` are the figure's exact relative change when
    the input is halved or doubled (-0.31: 31 % less), NaN where that can be neither bought nor flown.
    """

    key: str
    label: str
    slope: float
    halved: float
    doubled: float

    @property
    def coarser(self) -> bool:
        """True if the change that helps makes the image coarser."""
        return self.key == "radar.azimuth_resolution" or (self.key == "radar.aperture_time" and self.slope > 0)

    @property
    def bought(self) -> bool:
        """True if a part or an installation changes, not the geometry of flight and radar."""
        return self.key.partition(".")[0] not in ("flight", "radar")


def rank(design: Design, figure: str) -> tuple[InputSensitivity, ...]:
    """Sensitivities of a figure to every input and contributor it depends on, the strongest first.

    Inputs at zero have no logarithm and are left out: `silent` names them.

    Raises
    ------
    InputError
        If `figure` is not one of `RANKED`, or the design is one that `analyse` refuses.

    Examples
    --------
    >>> from nav_model import rank, read_design
    >>> design = read_design("examples/mems_x_band.toml")
    >>> [(item.key, round(item.slope, 2)) for item in rank(design, "detrended_phase")[:2]]
    [('radar.azimuth_resolution', -2.02), ('flight.speed', -1.82)]
    """
    imaged_inputs(design)
    if figure not in RANKED:
        raise InputError("result", not_a_choice(figure, RANKED), figure)
    keys = [key for key in stated(design) if design[key] != 0]
    slopes = log_derivatives(design, keys, (figure,))[figure]
    halved, doubled = (_scaled(design, keys, figure, factor) for factor in (0.5, 2.0))
    of_inputs = [
        InputSensitivity(key, str(quantity(key).label), float(slope), float(half), float(double))
        for key, slope, half, double in zip(keys, slopes, halved, doubled, strict=True)
        if slope != 0
    ]
    return tuple(sorted((*of_inputs, *_of_contributors(design, figure)), key=lambda item: -abs(item.slope)))


def _of_contributors(design: Design, figure: str) -> Iterator[InputSensitivity]:
    """Sensitivity to each contributor that enters the figure."""
    x = inputs_of(design)
    now = model_of(x).composed(figure)
    for part in now.parts:
        others = tuple(other for other in now.parts if other is not part)
        halved, doubled = (
            float(replace(now, parts=(*others, replace(part, size=factor * part.size))).sigma / now.sigma - 1)
            for factor in (0.5, 2.0)
        )
        slope = float(now.shares[part.name])
        yield InputSensitivity(f"contributors.{part.name}", part.name, slope, halved, doubled)


def silent(design: Design) -> tuple[str, ...]:
    """Inputs that are zero and therefore cannot be ranked."""
    return tuple(key for key in stated(design) if design[key] == 0)


def stated(design: Design) -> list[str]:
    """Numeric inputs that the design states and uses: optional ones, and those of optional sections, when given."""
    return [key for key in VARIABLES if design.uses(key) and getattr(design, key.partition(".")[0]).given()]


def log_derivatives(
    design: Design, keys: Sequence[str], names: Sequence[str], changes: Columns | None = None
) -> dict[str, Array]:
    """d ln(figure)/d ln(input), exact.

    Parameters
    ----------
    design : Design
    keys : sequence of str
        Inputs, dotted keys.
    names : sequence of str
        Figures.
    changes : mapping, optional
        Inputs replaced by arrays of one shape.

    Returns
    -------
    dict
        Figure -> array of shape (len(keys), ...) with the shape of the changes behind.
    """
    base: dict[str, Replacement] = dict(changes or {})
    shape = np.broadcast_shapes(*(np.shape(value) for value in base.values() if value is not None))
    identity = np.eye(len(keys)).reshape(len(keys), len(keys), *(1 for _ in shape))
    stepped = dict(base)
    for i, key in enumerate(keys):
        stepped[key] = base.get(key, design[key]) * (1 + 1j * _STEP * identity[i])
    values = figures(inputs_of(design, stepped), names)
    whole = (len(keys), *shape)
    return {name: np.broadcast_to(_slope(value), whole) for name, value in values.items()}


def _slope(value: Array) -> Array:
    """The derivative that a stepped figure carries; zero for a figure that is zero, which nothing moves."""
    zero = value.real == 0
    return np.where(zero, 0.0, value.imag / np.where(zero, 1.0, value.real * _STEP))


def _scaled(design: Design, keys: Sequence[str], figure: str, factor: float) -> Array:
    """Relative change of the figure with each input scaled alone; NaN where it is out of reach."""
    identity = np.eye(len(keys))
    changes = {key: np.asarray(design[key], float) * (1 + (factor - 1) * identity[i]) for i, key in enumerate(keys)}
    allowed = [_in_reach(design, key, factor) for key in keys]
    now = figures(inputs_of(design), (figure,))[figure]
    then = figures(inputs_of(design, changes), (figure,))[figure]
    return np.where(allowed, np.broadcast_to(then, len(keys)) / now - 1, np.nan)


def _in_reach(design: Design, key: str, factor: float) -> bool:
    """True if a scaled input can be bought or flown: an angle as explored, a scene no nearer than the ground."""
    declaration, now = quantity(key), float(design[key])  # type: ignore[arg-type]
    if declaration.dimension == "angle":
        low, high = usual_range(key)
        return low <= factor * now <= high
    if key == "radar.slant_range" and factor * now < design.flight.altitude - design.trajectory.ground:
        return False
    return least(key, now) <= factor * now <= declaration.limits[1]


def sentence(item: InputSensitivity, figure_label: str) -> str:
    """A sensitivity in words: what halving the input does, or doubling where that is what helps."""
    down = item.slope > 0
    verb, change = ("Halving", item.halved) if down else ("Doubling", item.doubled)
    contributor = item.key.startswith("contributors.")
    name = f'"{item.label}"' if contributor else in_sentence(item.label)
    name += ", which makes the image coarser," if item.coarser else ""
    subject = in_sentence(figure_label)
    if np.isnan(change):
        return f"{verb} {name} is not possible; 1 % of it changes {subject} by {abs(item.slope):.2g} %."
    if abs(change) < 5e-4:
        return f"{verb} {name} changes {subject} by less than 0.05 %."
    effect = "cuts" if change < 0 else "raises"
    return f"{verb} {name} {effect} {subject} by {100 * abs(change):.2g} %."
