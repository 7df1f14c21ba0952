"""The whole study: every error source and class, pure INS and aided, with the matrices for the sliders."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError, not_a_choice
from nav_model.earth.gravity import ZONALS
from nav_model.suborbital.aiding import Aiding, camera_frames, frame_stride, perfect_frames
from nav_model.suborbital.channels import decoupled_response
from nav_model.suborbital.errors import CLASSES, SOURCES, ErrorSet, mask, parameter_vector
from nav_model.suborbital.flight import FlightParameters, TrueFlight, in_gravity, reference_flight
from nav_model.suborbital.mechanisation import AttitudeFrames, mechanise
from nav_model.suborbital.navigation_errors import NavigationErrors, navigation_errors
from nav_model.suborbital.sensitivity import NoiseParts, NoiseSpread, Sensitivity, noise_parts, sensitivity

GRAVITY_ROW = "gravity model"


@dataclass(frozen=True)
class SuborbitalInputs:
    """Inputs of a study. The default is the reference flight with GP-1 and a perfect camera.

    ins_gravity is what the INS believes; the true field is flight.gravity.
    """

    flight: FlightParameters = field(default_factory=FlightParameters)
    errors: ErrorSet = field(default_factory=ErrorSet)
    aiding: Aiding = field(default_factory=Aiding)
    ins_gravity: str = "spherical"

    def __post_init__(self) -> None:
        if self.ins_gravity not in ZONALS:
            raise InputError("ins_gravity", not_a_choice(self.ins_gravity, ZONALS), self.ins_gravity)
        frame_stride(self.aiding, self.flight.step_s)


@dataclass(frozen=True)
class LinearParts:
    """Parts that a flight's errors are linear in, for its periods and instants of frames; other sizes need no run.

    used (n+1,) marks the steps with a frame; pure, aided: position, velocity and attitude by parameter;
    channel_response (61, m, 3): the channels [B-5] for a unit of each parameter; *_noise: white noise by source.
    """

    used: np.ndarray
    pure: Sensitivity
    aided: Sensitivity
    channel_response: Array
    pure_noise: NoiseParts
    aided_noise: NoiseParts


@dataclass(frozen=True)
class Study:
    """Result of `run_study`. Case k of `names` is row k of `parameters` and of every error array.

    kinds: "source", "class" or "gravity" per case; marks: the equation or run each number came from; pure
    and aided: error histories (cases first), with `every` steps of the flight between two points.
    """

    inputs: SuborbitalInputs
    flight: TrueFlight = field(repr=False)
    names: tuple[str, ...]
    kinds: tuple[str, ...]
    marks: tuple[str, ...] = field(repr=False)
    parameters: Array = field(repr=False)
    pure: NavigationErrors = field(repr=False)
    aided: NavigationErrors = field(repr=False)
    linear: LinearParts = field(repr=False)
    every: int

    def case(self, name: str) -> int:
        """Index of a case; InputError naming it when there is none."""
        if name not in self.names:
            raise InputError("case", not_a_choice(name, self.names), name)
        return self.names.index(name)

    def final_m(self, name: str) -> tuple[Array, Array]:
        """Errors of a case at the end, north, east, up, of the INS alone and with the tracker."""
        k = self.case(name)
        return self.pure.position_m[k, -1], self.aided.position_m[k, -1]

    @property
    def used(self) -> np.ndarray:
        """Steps at which a frame was taken, (n+1,) bool."""
        return self.linear.used

    @cached_property
    def channels_m(self) -> Array:
        """The decoupled channels [B-5] of the same cases: north, east, up (c, m, 3), m."""
        return np.asarray(np.einsum("cp,pmi->cmi", self.parameters, self.linear.channel_response))

    @cached_property
    def pure_noise(self) -> NoiseSpread:
        """Spread of the white noise, INS alone."""
        return self.linear.pure_noise.spread(self.inputs.errors)

    @cached_property
    def aided_noise(self) -> NoiseSpread:
        """Spread of the white noise, with the tracker."""
        return self.linear.aided_noise.spread(self.inputs.errors)


def case_parameters(errors: ErrorSet, aiding: Aiding) -> tuple[tuple[str, ...], Array]:
    """Names of the cases, and their errors (cases, 61) in the order of `layout`."""
    p = parameter_vector(errors, aiding.misalignment_rad, aiding.latency_s)
    groups = {**SOURCES, **CLASSES}
    names = (*groups, GRAVITY_ROW)
    return names, np.stack([*(p * mask(group) for group in groups.values()), np.zeros_like(p)])


def run_study(
    inputs: SuborbitalInputs | None = None,
    *,
    flight: TrueFlight | None = None,
    measured: AttitudeFrames | None = None,
    every: int = 10,
    progress: Callable[[float], None] | None = None,
) -> Study:
    """Integrate every case, with and without star tracker.

    The row "gravity model" is an INS without any other error whose gravity is not the true one; when both are the
    same it asks what a truth with J2 would cost, flying the reference flight again in that field (for a loaded
    trajectory it is then zero).

    Parameters
    ----------
    inputs : SuborbitalInputs, optional
        The reference flight with GP-1 and a perfect camera by default.
    flight : TrueFlight, optional
        A loaded trajectory, or `inputs.flight` where it has been flown already.
    measured : AttitudeFrames, optional
        Attitudes from star images (`star_camera.track_stars`), taken by the case "all" in place of perfect frames.
    every : int, optional
        Steps between two points of the histories, a divisor of the flight's.
    progress : callable, optional
        Takes the share done.

    Raises
    ------
    InputError
        For bad input.
    """
    inputs = inputs or SuborbitalInputs()
    truth = flight or reference_flight(inputs.flight)
    names, parameters = case_parameters(inputs.errors, inputs.aiding)
    frames_of_case = {
        "star tracker misalignment": camera_frames(truth, replace(inputs.aiding, latency_s=0.0)),
        "star tracker latency": camera_frames(truth, replace(inputs.aiding, misalignment_rad=(0.0, 0.0, 0.0))),
        "all": camera_frames(truth, inputs.aiding, measured),
    }
    # Every case has its frames at the instants of "all", so that the rows add up.
    used = frames_of_case["all"].used
    frames_of_case = {name: replace(frames, used=used) for name, frames in frames_of_case.items()}
    ideal = replace(perfect_frames(truth, inputs.aiding), used=used)
    mismatch, believed = truth, inputs.ins_gravity
    if truth.gravity == believed and not truth.from_file:
        mismatch = in_gravity(truth, "j2" if believed == "spherical" else "spherical")
    count = len(names)
    models = [believed if name in (GRAVITY_ROW, "all") else truth.gravity for name in names]
    run = mechanise(
        truth,
        np.concatenate([parameters, parameters]),
        inputs.errors,
        frames=[None] * count + [frames_of_case.get(name, ideal) for name in names],
        gravity=2 * models,
        every=every,
        progress=progress,
    )
    errors = navigation_errors(truth, run)
    if mismatch is not truth:  # what the INS measures there, and so its run, is the same: the truth is another
        row = names.index(GRAVITY_ROW)
        rows = [row, count + row]
        other = navigation_errors(mismatch, run.cases(rows))
        for name in errors.histories:
            getattr(errors, name)[rows] = getattr(other, name)
    pure, aided = errors.cases(slice(0, count)), errors.cases(slice(count, None))
    return Study(
        inputs=inputs,
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
        pure=pure,
        aided=aided,
        linear=LinearParts(
            used=used,
            pure=sensitivity(truth, inputs.errors, every=every),
            aided=sensitivity(truth, inputs.errors, used, every),
            channel_response=decoupled_response(truth, inputs.errors, every=every),
            pure_noise=noise_parts(truth, None, None, every),
            aided_noise=noise_parts(truth, used, frames_of_case["all"].covariance, every),
        ),
        every=every,
    )


@dataclass(frozen=True)
class Gap:
    """Linear answer against the exact one at the end of the flight: (cases,) distance in m and as a share of
    the exact error (0 where that is below a metre)."""

    names: tuple[str, ...]
    pure_m: Array
    aided_m: Array
    pure_share: Array
    aided_share: Array


def position_gap(pure_m: Array, aided_m: Array, exact: Study) -> Gap:
    """Gap between position histories (cases, m, 3), pure and aided, and an exact study of the same cases."""

    def compare(linear: Array, truth: Array) -> tuple[Array, Array]:
        distance = np.linalg.norm(linear[:, -1] - truth[:, -1], axis=-1)
        size = np.linalg.norm(truth[:, -1], axis=-1)
        return distance, np.where(size >= 1.0, distance / np.maximum(size, 1.0), 0.0)

    pure_gap, pure_share = compare(pure_m, exact.pure.position_m)
    aided_gap, aided_share = compare(aided_m, exact.aided.position_m)
    return Gap(exact.names, pure_gap, aided_gap, pure_share, aided_share)


def matrix_gap(study: Study) -> Gap:
    """Gap between the plain product S p and the study it belongs to: what the linear model alone would say.

    Moved curves (`moving.moved`) are better: they start at the exact answer and only move by S.
    """
    p = study.parameters
    return position_gap(study.linear.pure.position_m(p), study.linear.aided.position_m(p), study)


def gravity_rows(flight: TrueFlight) -> tuple[tuple[str, str, Array], ...]:
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
