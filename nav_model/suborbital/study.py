"""The whole study: every error source and class, pure INS and aided, with the matrices for the sliders."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from nav_model.earth.gravity import ZONALS
from nav_model.earth.rotation import FloatArray
from nav_model.suborbital.aiding import Aiding, camera_frames, frame_steps, frame_stride, perfect_frames
from nav_model.suborbital.channels import ChannelErrors, channel_errors, decoupled_response
from nav_model.suborbital.checks import require
from nav_model.suborbital.errors import CLASSES, SOURCES, ErrorSet, mask, parameter_vector
from nav_model.suborbital.flight import FlightParameters, TrueFlight, in_gravity, reference_flight
from nav_model.suborbital.mechanisation import AttitudeFrames, mechanise
from nav_model.suborbital.navigation_errors import NavigationErrors, navigation_errors
from nav_model.suborbital.sensitivity import (
    NoiseParts,
    NoiseSpread,
    Sensitivity,
    noise_parts,
    sensitivity,
)

GRAVITY_ROW = "gravity model"


@dataclass(frozen=True)
class SuborbitalInputs:
    """What a person can set. The default is the reference flight with GP-1 and a perfect camera.

    ins_gravity is what the INS believes; the true field is flight.gravity. output_interval_s must be a
    multiple of the flight's step.
    """

    flight: FlightParameters = field(default_factory=FlightParameters)
    errors: ErrorSet = field(default_factory=ErrorSet)
    aiding: Aiding = field(default_factory=Aiding)
    ins_gravity: str = "spherical"
    output_interval_s: float = 1.0

    def __post_init__(self) -> None:
        require(
            self.ins_gravity in ZONALS,
            f"ins_gravity = {self.ins_gravity!r}: must be one of {', '.join(ZONALS)}",
        )
        frame_stride(self.aiding, self.flight.step_s)


@dataclass(frozen=True)
class Study:
    """Result of `run_study`. Case k of `names` is row k of `parameters` and of every error array.

    kinds: "source", "class" or "gravity" per case; marks: the equation or run each number came from; pure
    and aided: error histories (cases first); channels: [B-5] for the same cases; *_noise: spread of the
    white noise.
    """

    inputs: SuborbitalInputs
    flight: TrueFlight = field(repr=False)
    names: tuple[str, ...]
    kinds: tuple[str, ...]
    marks: tuple[str, ...] = field(repr=False)
    parameters: FloatArray = field(repr=False)
    used: np.ndarray = field(repr=False)
    pure: NavigationErrors = field(repr=False)
    aided: NavigationErrors = field(repr=False)
    channels: ChannelErrors = field(repr=False)
    pure_sensitivity: Sensitivity = field(repr=False)
    aided_sensitivity: Sensitivity = field(repr=False)
    pure_noise: NoiseSpread = field(repr=False)
    aided_noise: NoiseSpread = field(repr=False)

    def case(self, name: str) -> int:
        """Index of a case; ValueError naming it when there is none."""
        require(name in self.names, f"case {name!r}: must be one of {', '.join(self.names)}")
        return self.names.index(name)


@dataclass(frozen=True)
class Parts:
    """What a study's decoupled channels and noise are linear in: other errors need no run.

    channel_response (61, m, 3): the channels [B-5] for a unit of each parameter.
    """

    channel_response: FloatArray = field(repr=False)
    pure_noise: NoiseParts = field(repr=False)
    aided_noise: NoiseParts = field(repr=False)


@dataclass(frozen=True)
class Row:
    """One line of the final-error table, m: (north, east, up), then down-range and cross-range."""

    name: str
    kind: str
    pure_m: tuple[float, float, float]
    aided_m: tuple[float, float, float]
    pure_down_range_m: float
    pure_cross_range_m: float
    aided_down_range_m: float
    aided_cross_range_m: float
    source: str

    @property
    def improvement_m(self) -> tuple[float, float, float]:
        """How much smaller the tracker made the size of the error, per channel (negative: larger)."""
        north, east, up = (abs(p) - abs(a) for p, a in zip(self.pure_m, self.aided_m, strict=True))
        return north, east, up


def _parameters(errors: ErrorSet, aiding: Aiding) -> tuple[tuple[str, ...], FloatArray]:
    p = parameter_vector(errors, aiding.misalignment_rad, aiding.latency_s)
    groups = {**SOURCES, **CLASSES}
    names = (*groups, GRAVITY_ROW)
    return names, np.stack([*(p * mask(group) for group in groups.values()), np.zeros_like(p)])


def run_study(
    inputs: SuborbitalInputs | None = None,
    *,
    flight: TrueFlight | None = None,
    measured: AttitudeFrames | None = None,
    progress: Callable[[float], None] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> Study:
    """Integrate every case, with and without star tracker.

    flight: a loaded trajectory, or inputs.flight where it has been flown already; measured: attitudes from star
    images (`star_camera.track_stars`), taken by the case "all" in place of perfect frames. The row "gravity model"
    is an INS without any other error whose gravity is not the true one; when both are the same it asks what
    a truth with J2 would cost, flying the reference flight again in that field (for a loaded trajectory it is
    then zero). Raises ValueError for bad input, Cancelled when `cancel()` turns true.
    """
    return study_in_parts(inputs, flight=flight, measured=measured, progress=progress, cancel=cancel)[0]


def study_in_parts(
    inputs: SuborbitalInputs | None = None,
    *,
    flight: TrueFlight | None = None,
    measured: AttitudeFrames | None = None,
    progress: Callable[[float], None] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> tuple[Study, Parts]:
    """`run_study`, and the parts of its study."""
    given = inputs or SuborbitalInputs()
    truth = flight or reference_flight(given.flight)
    ratio = given.output_interval_s / truth.step_s
    every = round(ratio)
    require(
        every >= 1 and abs(ratio - every) < 1e-6 and truth.steps % every == 0,
        f"output_interval_s = {given.output_interval_s!r}: must be a multiple of the step of "
        f"{truth.step_s!r} s and divide the flight",
    )
    names, parameters = _parameters(given.errors, given.aiding)
    worn = {
        "star tracker misalignment": camera_frames(truth, replace(given.aiding, latency_s=0.0)),
        "star tracker latency": camera_frames(truth, replace(given.aiding, misalignment_rad=(0.0, 0.0, 0.0))),
        "all": camera_frames(truth, given.aiding, measured),
    }
    # Every case has its frames at the instants of "all", so that the rows add up.
    used = worn["all"].used
    worn = {name: replace(frames, used=used) for name, frames in worn.items()}
    ideal = replace(perfect_frames(truth, given.aiding), used=used)
    mismatch, believed = truth, given.ins_gravity
    if truth.gravity == believed and not truth.from_file:
        mismatch = in_gravity(truth, "j2" if believed == "spherical" else "spherical")
    count = len(names)
    models = [believed if name in (GRAVITY_ROW, "all") else truth.gravity for name in names]
    run = mechanise(
        truth,
        np.concatenate([parameters, parameters]),
        given.errors,
        frames=[None] * count + [worn.get(name, ideal) for name in names],
        gravity=2 * models,
        every=every,
        progress=progress,
        cancel=cancel,
    )
    found = navigation_errors(truth, run)
    if mismatch is not truth:  # what the INS measures there, and so its run, is the same: the truth is another
        row = names.index(GRAVITY_ROW)
        rows = [row, count + row]
        other = navigation_errors(mismatch, run.cases(rows))
        for name in found.histories:
            getattr(found, name)[rows] = getattr(other, name)
    pure, aided = found.cases(slice(0, count)), found.cases(slice(count, None))
    parts = Parts(
        decoupled_response(truth, given.errors, every=every),
        noise_parts(truth, given.errors, None, None, every),
        noise_parts(truth, given.errors, used, worn["all"].covariance, every),
    )
    study = Study(
        inputs=given,
        flight=truth,
        names=names,
        kinds=tuple("class" if n in CLASSES else "gravity" if n == GRAVITY_ROW else "source" for n in names),
        marks=tuple(
            f"run: INS {believed} gravity [B-3] on a {mismatch.gravity} truth, RK4 {truth.step_s:g} s"
            if n == GRAVITY_ROW
            else f"run: INS [B-3] with errors [B-1], RK4 {truth.step_s:g} s; aided [B-7]"
            for n in names
        ),
        parameters=parameters,
        used=used,
        pure=pure,
        aided=aided,
        channels=channel_errors(truth, parameters, parts.channel_response, every),
        pure_sensitivity=sensitivity(truth, given.errors, every=every),
        aided_sensitivity=sensitivity(truth, given.errors, used, every),
        pure_noise=parts.pure_noise.spread(given.errors),
        aided_noise=parts.aided_noise.spread(given.errors),
    )
    return study, parts


def _triple(values: FloatArray) -> tuple[float, float, float]:
    return float(values[0]), float(values[1]), float(values[2])


def table(study: Study) -> tuple[Row, ...]:
    """Final errors of every case, one row each."""
    p, a = study.pure, study.aided
    return tuple(
        Row(
            name=name,
            kind=study.kinds[k],
            pure_m=_triple(p.position_m[k, -1]),
            aided_m=_triple(a.position_m[k, -1]),
            pure_down_range_m=float(p.down_range_m[k, -1]),
            pure_cross_range_m=float(p.cross_range_m[k, -1]),
            aided_down_range_m=float(a.down_range_m[k, -1]),
            aided_cross_range_m=float(a.cross_range_m[k, -1]),
            source=study.marks[k],
        )
        for k, name in enumerate(study.names)
    )


@dataclass(frozen=True)
class Renewal:
    """Sensitivity matrices of a study's flight for other periods or other frame instants; `used` marks those
    (n+1,)."""

    used: np.ndarray = field(repr=False)
    pure: Sensitivity = field(repr=False)
    aided: Sensitivity = field(repr=False)


def _periods(errors: ErrorSet) -> tuple[float, ...]:
    return tuple(
        period for s in (errors.accelerometers, errors.gyros) for period in (s.bias_period_s, s.matrix_period_s)
    )


def needs_renewal(study: Study, errors: ErrorSet, aiding: Aiding) -> bool:
    """Whether new inputs change the sensitivity matrix itself: other periods, or frames at other instants."""
    before = study.inputs
    return _periods(errors) != _periods(before.errors) or not np.array_equal(
        frame_steps(study.flight, aiding), frame_steps(study.flight, before.aiding)
    )


def renew(study: Study, errors: ErrorSet, aiding: Aiding) -> Renewal:
    """The study's sensitivity matrices for new inputs; only what changed is computed (tens of milliseconds)."""
    flight, every = study.flight, round(study.inputs.output_interval_s / study.flight.step_s)
    same_periods = _periods(errors) == _periods(study.inputs.errors)
    used, before = frame_steps(flight, aiding), frame_steps(flight, study.inputs.aiding)
    same_frames = np.array_equal(used, before)
    if same_frames:
        used = study.used
    return Renewal(
        used,
        study.pure_sensitivity if same_periods else sensitivity(flight, errors, every=every),
        study.aided_sensitivity if same_periods and same_frames else sensitivity(flight, errors, used, every),
    )


@dataclass(frozen=True)
class Slid:
    """Curves at slider positions: last exact run + S p - S_0 p_0. Arrays (cases, m, 3), north, east, up,
    m; parameters (cases, 61) and the matrices used."""

    names: tuple[str, ...]
    time_s: FloatArray
    pure_m: FloatArray = field(repr=False)
    aided_m: FloatArray = field(repr=False)
    parameters: FloatArray = field(repr=False)
    renewal: Renewal = field(repr=False)
    source: str = "last exact run, moved by the linear sensitivity matrix [B-4]"


def slide(study: Study, errors: ErrorSet, aiding: Aiding | None = None, renewal: Renewal | None = None) -> Slid:
    """Move every curve of a study to new sensor, initial and tracker errors without integrating it again.

    At the study's own inputs the answer is the exact one; away from them the gap is of second order, and
    `position_gap` shows it once the study has been run again. Changed periods or frames need other matrices
    (`needs_renewal`): renewal brings those computed elsewhere, else they are computed here. Another flight
    needs a new study. The gravity row does not move.
    """
    wanted = study.inputs.aiding if aiding is None else aiding
    _, parameters = _parameters(errors, wanted)
    new = renewal or renew(study, errors, wanted)

    def moved(exact: FloatArray, after: Sensitivity, before: Sensitivity) -> FloatArray:
        if after is before:
            return exact + after.position_m(parameters - study.parameters)
        return exact + after.position_m(parameters) - before.position_m(study.parameters)

    return Slid(
        names=study.names,
        time_s=study.pure.time_s,
        pure_m=moved(study.pure.position_m, new.pure, study.pure_sensitivity),
        aided_m=moved(study.aided.position_m, new.aided, study.aided_sensitivity),
        parameters=parameters,
        renewal=new,
    )


@dataclass(frozen=True)
class Gap:
    """Linear answer against the exact one at the end of the flight: (cases,) distance in m and as a share of
    the exact error (0 where that is below a metre)."""

    names: tuple[str, ...]
    pure_m: FloatArray
    aided_m: FloatArray
    pure_share: FloatArray
    aided_share: FloatArray


def position_gap(pure_m: FloatArray, aided_m: FloatArray, exact: Study) -> Gap:
    """Gap between position histories (cases, m, 3), pure and aided, and an exact study of the same cases."""

    def compare(linear: FloatArray, truth: FloatArray) -> tuple[FloatArray, FloatArray]:
        distance = np.linalg.norm(linear[:, -1] - truth[:, -1], axis=-1)
        size = np.linalg.norm(truth[:, -1], axis=-1)
        return distance, np.where(size >= 1.0, distance / np.maximum(size, 1.0), 0.0)

    pure_gap, pure_share = compare(pure_m, exact.pure.position_m)
    aided_gap, aided_share = compare(aided_m, exact.aided.position_m)
    return Gap(exact.names, pure_gap, aided_gap, pure_share, aided_share)


def matrix_gap(study: Study) -> Gap:
    """Gap between the plain product S p and the study it belongs to: what the linear model alone would say.

    The curves of `slide` are better: they start at the exact answer and only move by S.
    """
    p = study.parameters
    return position_gap(study.pure_sensitivity.position_m(p), study.aided_sensitivity.position_m(p), study)


def gravity_rows(flight: TrueFlight) -> tuple[tuple[str, str, FloatArray], ...]:
    """Final north, east, up error (m) of an otherwise perfect INS for every pair (true model, INS model) on a
    flight, which is flown again in each of the fields."""
    perfect = ErrorSet()
    nothing = np.zeros((len(ZONALS), len(parameter_vector(perfect))))
    run = mechanise(flight, nothing, perfect, gravity=tuple(ZONALS), every=flight.steps)
    return tuple(
        (true_model, model, error)
        for true_model in ZONALS
        for model, error in zip(
            ZONALS, navigation_errors(in_gravity(flight, true_model), run).position_m[:, -1], strict=True
        )
    )
