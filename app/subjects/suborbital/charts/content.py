"""The input of the charts and tables of the suborbital study: the run, the current curves, and the chosen view."""

from dataclasses import dataclass
from functools import cached_property

from app.charts.kinds import Array, Span
from app.document.numbers import show_in
from nav_model.suborbital.channels import closed_form_errors
from nav_model.suborbital.settings import Settings
from nav_model.suborbital.star_camera import StarFrame
from nav_model.suborbital.study import Gap, Study, matrix_gap
from nav_model.suborbital.survey import Survey

CHANNELS = ("north", "east", "height")
TRACK_CHANNELS = ("down-range", "cross-range", "height")
SHOWN_SOURCES = {
    "accelerometer total": "accelerometers",
    "gyro total": "gyros",
    "initial position and velocity": "initial position and velocity",
    "initial attitude": "initial attitude",
    "all": "everything",
}
"""Cases of the chart by source, each with its style, which is its label too but for the sum."""
SUM = "sum of signed errors"
"""Label of the case "all": every error source with its sign, without white noise."""
TIME = "time since lift-off [s]"


@dataclass(frozen=True)
class Content:
    """The content of the page: the last run, the study at the sliders' positions, and the chosen view.

    settings: of the study, which its survey was run at unless the curves were moved;
    along_track: down-range and cross-range in place of north and east.
    """

    survey: Survey
    study: Study
    settings: Settings
    case: str = "gyro total"
    channel: int = 2
    aided_sources: bool = False
    along_track: bool = False
    star_index: int = 50

    @property
    def exact(self) -> bool:
        """True if the curves are those of the last run, not moved."""
        return self.study is self.survey.study

    @property
    def how(self) -> str:
        """Kind of answer that the curves are."""
        every = show_in(self.study.flight.step_s, "s", "time", given=True)
        run = f"Integrated INS [B-3] with sensor errors [B-1], RK4 at {every}; with tracker [B-7]"
        return run if self.exact else f"{run}; then moved by the linear sensitivity matrix [B-4]"

    def position_m(self, aided: bool, case: str, channel: int) -> Array:
        """An error history in the axes looked at, m."""
        study = self.study
        errors, k = study.aided if aided else study.pure, study.case(case)
        if self.along_track and channel < 2:
            return (errors.down_range_m, errors.cross_range_m)[channel][k]
        return errors.position_m[k, :, channel]

    def axis(self, channel: int) -> str:
        """Name of a channel in the axes looked at."""
        return (TRACK_CHANNELS if self.along_track else CHANNELS)[channel]

    @cached_property
    def closed_form_m(self) -> Array:
        """The closed forms [B-6] of the case looked at, (m, 3), m."""
        study = self.study
        parameters = study.parameters[study.case(self.case)]
        return closed_form_errors(study.flight, parameters, study.inputs.errors, study.every)[0]

    @cached_property
    def matrix_gap(self) -> Gap:
        """Error of the plain product S p at the inputs of the last exact run."""
        return matrix_gap(self.survey.study)

    @property
    def star_frame(self) -> StarFrame:
        """The star image looked at."""
        return self.survey.star_frames[self.star_index]


def boost(study: Study) -> tuple[Span, ...]:
    return (Span("boost", "boost", 0.0, study.flight.burnout_s or 0.0),)


def km(values: Array) -> Array:
    return values / 1000.0


def called(case: str) -> str:
    return SUM if case == "all" else case
