"""All results of the suborbital study for one set of `Settings`: run once, then moved with the sliders.

`run_survey` is the exact answer. `moved` follows sliders through the linear sensitivity matrix [B-4]; inputs it
cannot follow (flight, gravity, camera) are told by `needs_run`, those that need other matrices by `needs_renewal`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from nav_model.earth.rotation import FloatArray
from nav_model.earth.sphere import local_axes
from nav_model.suborbital.aiding import frame_steps
from nav_model.suborbital.attitude import METHODS, MethodScore, compare_methods
from nav_model.suborbital.channels import channel_errors, decoupled_response
from nav_model.suborbital.flight import TrueFlight, reference_flight
from nav_model.suborbital.flight_file import parse_flight
from nav_model.suborbital.mechanisation import Cancelled
from nav_model.suborbital.navigation_errors import NavigationErrors
from nav_model.suborbital.sensitivity import NoiseParts, Sensitivity, noise_parts
from nav_model.suborbital.settings import Settings, output_every
from nav_model.suborbital.sky import Sky
from nav_model.suborbital.star_camera import (
    StarCamera,
    StarFrame,
    StarTrack,
    gate,
    measure,
    select_stars,
    star_frames,
    track_stars,
)
from nav_model.suborbital.study import (
    Parts,
    Renewal,
    Study,
    gravity_rows,
    needs_renewal,
    renew,
    slide,
    study_in_parts,
)

STAR_FRAME_SPACING_S = 2.0

ProgressCallback = Callable[[float, str], None]


@dataclass(frozen=True)
class Survey:
    """Result of `run_survey`.

    track: the whole flight's star images (None with a perfect camera); parts: what the study's channels and noise
    are made of; star_frames: an image every two seconds; scores: the five methods on those images; gravity: cost of
    every pair (true model, INS model), m; trajectory: name of the file flown, or "".
    """

    settings: Settings
    study: Study
    track: StarTrack | None = field(repr=False)
    parts: Parts = field(repr=False)
    star_frames: tuple[StarFrame, ...] = field(repr=False)
    scores: tuple[MethodScore, ...]
    scenes_refused: int
    gravity: tuple[tuple[str, str, FloatArray], ...] = field(repr=False)
    trajectory: str


def run_survey(
    settings: Settings,
    trajectory: tuple[str, bytes] | None = None,
    *,
    progress: ProgressCallback | None = None,
    cancel: Callable[[], bool] | None = None,
) -> Survey:
    """Run everything, a few seconds.

    trajectory: name and content of a file (`flight_file.parse_flight`), flown instead of the reference
    flight; the true gravity stays that of the settings. progress takes the share done and what is being done.
    ValueError for values that do not fit together, Cancelled when `cancel()` turns true.
    """

    def say(share: float, what: str) -> None:
        if cancel is not None and cancel():
            raise Cancelled(f"stopped at {100 * share:.0f} % ({what})")
        if progress is not None:
            progress(share, what)

    say(0.0, "flight (the first run on a machine compiles, about ten seconds)")
    inputs = settings.study_inputs()
    flight = reference_flight(inputs.flight) if trajectory is None else parse_flight(
        trajectory[1], trajectory[0], inputs.flight.step_s, inputs.flight.gravity
    )  # fmt: skip
    every = output_every(flight.steps)
    inputs = replace(inputs, output_interval_s=every * flight.step_s)
    camera, sky = settings.camera(), settings.sky()
    say(0.05, "star images")
    track = None
    if settings["camera.frames"] == "star images":
        track = track_stars(
            flight,
            camera,
            sky,
            method=settings["camera.method"],
            seed=int(settings["seed"]),
            progress=lambda share: say(0.05 + 0.2 * share, "star images"),
            cancel=cancel,
        )
    study, parts = study_in_parts(
        inputs,
        flight=flight,
        measured=None if track is None else track.frames,
        progress=lambda share: say(0.25 + 0.6 * share, "error sources"),
        cancel=cancel,
    )
    say(0.86, "star frames and attitude methods")
    times = np.arange(0.0, float(flight.time_s[-1]) + 1e-9, STAR_FRAME_SPACING_S)
    method, seed = settings["camera.method"], int(settings["seed"])
    shown = star_frames(flight, camera, sky, times, seed, method)
    scores, refused = _scores(flight, camera, sky, seed)
    say(0.95, "gravity models")
    return Survey(
        settings=settings,
        study=study,
        track=track,
        parts=parts,
        star_frames=shown,
        scores=scores,
        scenes_refused=refused,
        gravity=() if trajectory is not None else gravity_rows(flight),
        trajectory="" if trajectory is None else trajectory[0],
    )


def _scores(flight: TrueFlight, camera: StarCamera, sky: Sky, seed: int) -> tuple[tuple[MethodScore, ...], int]:
    """The five methods on a flight's images, one a second, and how many images the gate refused."""
    attitude = flight.attitude_bi[:: max(1, round(1.0 / flight.step_s))]
    chosen, _ = select_stars(camera, sky, attitude)
    body, reference, weight = measure(camera, sky, attitude, chosen, np.random.default_rng(seed))
    good = np.all([gate(camera, body, weight, method)[0] for method in METHODS], axis=0)
    if not good.any():
        return (), len(good)
    scores = compare_methods(
        body[good], reference[good], np.swapaxes(attitude[good], -1, -2), camera.centroid_sigma_rad, weight[good]
    )
    return scores, int(np.sum(~good))


_LINEAR = ("accelerometers.", "gyros.", "initial.", "tracker.")


def needs_run(survey: Survey, settings: Settings) -> bool:
    """Whether only a new run can follow the settings: flight, gravity, camera or sky changed, or, with star
    images, the instants of the frames, which also depend on the gate."""
    other = any(
        value != survey.settings[key] for key, value in settings.values.items() if not key.startswith(_LINEAR)
    )
    frames = survey.track is not None and any(
        settings[key] != survey.settings[key]
        for key in ("tracker.from_height", "tracker.frame_interval", "tracker.latency", "tracker.dropouts")
    )
    return other or frames


def needs_other_matrices(survey: Survey, settings: Settings) -> bool:
    """Whether `moved` needs a `Renewed` first: other periods, or frames at other instants."""
    inputs = settings.study_inputs()
    return needs_renewal(survey.study, inputs.errors, inputs.aiding)


@dataclass(frozen=True)
class Renewed:
    """Results that change with other periods or frame instants: matrices, decoupled channels (None: unchanged), noise
    with the tracker."""

    matrices: Renewal
    channel_response: FloatArray | None = field(repr=False)
    aided_noise: NoiseParts = field(repr=False)


def renewed(study: Study, settings: Settings) -> Renewed:
    """Compute a `Renewed` for a study with a perfect camera (a fraction of a second)."""
    inputs = settings.study_inputs()
    flight, every = study.flight, round(study.inputs.output_interval_s / study.flight.step_s)
    matrices = renew(study, inputs.errors, inputs.aiding)
    same_periods = matrices.pure is study.pure_sensitivity
    return Renewed(
        matrices,
        None if same_periods else decoupled_response(flight, inputs.errors, every=every),
        noise_parts(flight, inputs.errors, frame_steps(flight, inputs.aiding), None, every),
    )


def moved(survey: Survey, settings: Settings, renewal: Renewed | None = None) -> Study:
    """The study at other settings without integrating again: every error history by the linear sensitivity
    matrix [B-4], white noise and decoupled channels exactly.

    renewal: needed when `needs_other_matrices`; without it that work is done here. Settings that `needs_run`
    are not followed.
    """
    study, inputs = survey.study, settings.study_inputs()
    if renewal is None and needs_renewal(study, inputs.errors, inputs.aiding):
        renewal = renewed(study, settings)
    slid = slide(study, inputs.errors, inputs.aiding, renewal.matrices if renewal else None)
    response = survey.parts.channel_response
    if renewal is not None and renewal.channel_response is not None:
        response = renewal.channel_response
    noise = renewal.aided_noise if renewal else survey.parts.aided_noise
    new = slid.renewal
    every = round(study.inputs.output_interval_s / study.flight.step_s)
    return replace(
        study,
        inputs=replace(study.inputs, errors=inputs.errors, aiding=inputs.aiding),
        parameters=slid.parameters,
        marks=tuple(
            mark if kind == "gravity" else f"{mark}; moved by the sensitivity matrix [B-4]"
            for mark, kind in zip(study.marks, study.kinds, strict=True)
        ),
        used=new.used,
        pure=_moved_errors(study, study.pure, slid.pure_m, slid.parameters, new.pure, study.pure_sensitivity),
        aided=_moved_errors(study, study.aided, slid.aided_m, slid.parameters, new.aided, study.aided_sensitivity),
        channels=channel_errors(study.flight, slid.parameters, response, every),
        pure_sensitivity=new.pure,
        aided_sensitivity=new.aided,
        pure_noise=survey.parts.pure_noise.spread(inputs.errors),
        aided_noise=noise.spread(inputs.errors),
    )


def _moved_errors(
    study: Study,
    exact: NavigationErrors,
    position: FloatArray,
    parameters: FloatArray,
    new: Sensitivity,
    old: Sensitivity,
) -> NavigationErrors:
    """All error histories of `exact` at new parameters, given the moved positions."""
    every = round(study.inputs.output_interval_s / study.flight.step_s)
    path = study.flight.position_i[::every]
    track = study.flight.track_rad[::every]
    north, east = position[..., 0], position[..., 1]

    def change(name: str) -> FloatArray:
        after = np.einsum("mip,cp->cmi", getattr(new, name), parameters)
        return np.asarray(after - np.einsum("mip,cp->cmi", getattr(old, name), study.parameters))

    turned = change("attitude")
    # A wrong position turns the local axes: their error is dr/r, and the navigation attitude carries it.
    shift = (position - exact.position_m) / np.linalg.norm(path, axis=-1)[:, None]
    tangent = np.tan(study.flight.latitude_rad[::every])
    transport = np.stack([shift[..., 1], -shift[..., 0], -shift[..., 1] * tangent], axis=-1)
    local = np.einsum("mji,cmj->cmi", local_axes(path), turned) - transport
    return NavigationErrors(
        time_s=exact.time_s,
        position_m=position,
        velocity_m_s=exact.velocity_m_s + change("velocity"),
        down_range_m=north * np.cos(track) + east * np.sin(track),
        cross_range_m=-north * np.sin(track) + east * np.cos(track),
        attitude_inertial_rad=exact.attitude_inertial_rad + turned,
        attitude_navigation_rad=exact.attitude_navigation_rad + local,
        source=f"{exact.source}; moved by the sensitivity matrix [B-4]",
    )
