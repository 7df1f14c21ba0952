"""The budget along a flown track, as the figures of a line take it, and a mean square with its band."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from nav_model.budget.inputs import Inputs
from nav_model.design import Design
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.flown.relation import Relation
from nav_model.flown.spread import Error
from nav_model.flown.track import Stretch, Track
from nav_model.trajectory.covariance import Followed
from nav_model.trajectory.lines import along
from nav_model.trajectory.passes import DIFFERENCE

FloatArray = NDArray[np.float64]
_CONFIDENCE = 0.95
LEAST_FREEDOM = 5.0
"""Degrees of freedom from which a band gives a verdict."""


@dataclass(frozen=True, eq=False)
class Budgeted:
    """The budget along a flown track: the covariance in parts, the adjoint of later fixes, the relation, and whether
    the solution is post-processed."""

    design: Design
    track: Track
    followed: Followed
    adjoint: FloatArray
    relation: Relation
    post_processed: bool

    @property
    def x(self) -> Inputs:
        """Inputs of the design."""
        return self.track.spec.inputs

    @property
    def processing(self) -> str:
        """The processing whose budget the solution has."""
        return POST_PROCESSED if self.post_processed else REAL_TIME

    @property
    def error(self) -> Error:
        """The error that the difference shows."""
        if self.relation == "smoothed":
            return "difference"
        return "smoothed" if self.post_processed else "output"

    @property
    def outputs_s(self) -> FloatArray:
        """Times of the results in the flight [s]."""
        return self.followed.model.time_s[self.followed.model.outputs]

    def states(self, processing: str) -> FloatArray:
        """Variances of position, velocity and roll, pitch, yaw after each fix (outputs, 9)."""
        part = self.followed.figures[processing]
        return np.hstack([part.position, part.velocity, part.attitude]) ** 2

    @property
    def seen(self) -> str:
        """Name among `Followed.states` of the variances that the difference shows."""
        return DIFFERENCE if self.relation == "smoothed" else self.processing

    def limits_on(self, stretch: Stretch) -> dict[str, float]:
        """Limits on one sigma on a stretch, by figure: those of its line in place of the flight's."""
        spec = self.track.spec
        return dict(spec.most) | {
            key: most for line in spec.lines if line.name == stretch.name for key, most in line.most
        }

    def on(self, stretch: Stretch, *, image: bool) -> NDArray[np.bool_]:
        """Mask of the results that count for a stretch, (outputs)."""
        start, stop = self.track.clock.in_flight(np.array([stretch.start, stretch.stop])).tolist()
        return along(start, stop, self.track.spec, self.outputs_s, image=image)


@dataclass(frozen=True)
class Square:
    """A mean square as a difference shows it, what is added to it for that of the solution's error (`beyond`), what
    the figure has beside navigation (`others`), the budget of navigation, all at one sigma; degrees of freedom, how
    many apertures, and why it is refused."""

    seen: float
    beyond: float
    others: float
    budget: float
    freedom: float
    apertures: int = 0
    refused: str = ""


def band(degrees: float) -> tuple[float, float]:
    """Factors on a mean square that make the ends of its band, by chi-square."""
    if degrees < 0.5:
        return 0.0, math.inf
    half = 0.5 * (1.0 - _CONFIDENCE)
    return degrees / float(chi2.ppf(1.0 - half, degrees)), degrees / float(chi2.ppf(half, degrees))
