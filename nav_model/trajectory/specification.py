"""What a covariance along a flight is of: the simulator's study, the aperture, and limits.

Immutable and in SI, as `SimulationSpec`, which holds the instruments, the filter, the flight and its outages.
"""

from dataclasses import dataclass, field

from nav_model.base.errors import InputError
from nav_model.budget.contributors import NONE, Parts
from nav_model.simulation.specification import SimulationSpec


@dataclass(frozen=True)
class Aperture:
    """The aperture at which a design looks, wherever on the flight it lies.

    duration [s], wavelength [m], grazing angle [rad], squint [rad], slant_range [m]. autofocus_order: highest order
    of phase removed. scene_height_error [m], 1 sigma. The radar looks to the right.
    """

    duration: float
    wavelength: float
    grazing_angle: float
    slant_range: float
    squint: float = 0.0
    autofocus_order: int = 1
    scene_height_error: float = 0.0


@dataclass(frozen=True)
class Limits:
    """What one sigma of an image figure may be at most, by name of the figure, in the processing that is judged."""

    processing: str = "real time"
    most: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class Line:
    """A part of the flight on which images are taken; start and stop [s]. most: limits that hold for it in place of
    the flight's, as in `Limits`."""

    name: str
    start: float
    stop: float
    most: tuple[tuple[str, float], ...] = ()

    def __post_init__(self) -> None:
        if not 0.0 <= self.start < self.stop:
            raise InputError("line", f"{self.name}: {self.start:g} s to {self.stop:g} s is no stretch of time")


@dataclass(frozen=True)
class CovarianceSpec:
    """One covariance along a flight. `study`: its runs and seed mean nothing here. Without lines the whole flight is
    one; without an aperture there are no image figures. contributors: of the user's own, by the figure they enter."""

    study: SimulationSpec
    aperture: Aperture | None = None
    lines: tuple[Line, ...] = ()
    limits: Limits = Limits()
    contributors: Parts = field(default_factory=lambda: NONE)
