"""What the charts and tables of the suborbital study take: the run, the curves in force, what is looked at."""

from __future__ import annotations

from dataclasses import dataclass

from app.charts.description import Array, Span
from nav_model.suborbital.star_camera import StarFrame
from nav_model.suborbital.study import Study
from nav_model.suborbital.survey import Survey

CHANNELS = ("north", "east", "height")
SHOWN_SOURCES = (
    "accelerometer bias",
    "accelerometer instability",
    "gyro bias",
    "gyro instability",
    "initial position and velocity",
    "initial attitude",
    "all",
)
TIME = "time since lift-off [s]"


@dataclass(frozen=True)
class Shown:
    """What is on the page: the last run, the study at the sliders' positions, and what the person looks at."""

    survey: Survey
    study: Study
    case: str = "gyro total"
    channel: int = 2
    aided_sources: bool = False
    star_index: int = 50

    @property
    def exact(self) -> bool:
        """Whether the curves are those of the last run, not moved."""
        return self.study is self.survey.study

    @property
    def how(self) -> str:
        """Which answer the curves are."""
        step = self.study.flight.step_s
        run = f"Integrated INS [B-3] with sensor errors [B-1], RK4 at {step:g} s; with tracker [B-7]"
        return run if self.exact else f"{run}; then moved by the linear sensitivity matrix [B-4]"

    @property
    def star_frame(self) -> StarFrame:
        """The star image looked at."""
        return self.survey.star_frames[self.star_index]


def every_of(study: Study) -> int:
    return round(study.inputs.output_interval_s / study.flight.step_s)


def boost(study: Study) -> tuple[Span, ...]:
    burnout = study.flight.burnout_s
    return (Span("boost", "boost", 0.0, burnout if burnout is not None else 0.0),)


def km(values: Array) -> Array:
    return values / 1000.0


def called(case: str) -> str:
    return "everything" if case == "all" else case
