"""All results of the suborbital study for one set of `Settings`: run once, then moved with the sliders.

`run_survey` is the exact answer. `moving.moved` follows sliders through the linear sensitivity matrix [B-4]; inputs
it cannot follow (flight, gravity, camera) are told by `needs_run`.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from nav_model.base.arrays import Array
from nav_model.suborbital.attitude import METHODS, MethodScore, compare_methods
from nav_model.suborbital.flight import TrueFlight, reference_flight
from nav_model.suborbital.flight_file import parse_flight
from nav_model.suborbital.settings import Settings, inputs_named, output_every
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
from nav_model.suborbital.study import Study, gravity_rows, run_study

STAR_FRAME_SPACING_S = 2.0


@dataclass(frozen=True)
class Survey:
    """Result of `run_survey`.

    track: the whole flight's star images (None with a perfect camera); star_frames: an image every two seconds;
    scores: the attitude methods on those images; gravity: cost of every pair (true model, INS model), m; trajectory:
    name of the file flown, or "".
    """

    settings: Settings
    study: Study
    track: StarTrack | None = field(repr=False)
    star_frames: tuple[StarFrame, ...] = field(repr=False)
    scores: tuple[MethodScore, ...]
    scenes_refused: int
    gravity: tuple[tuple[str, str, Array], ...] = field(repr=False)
    trajectory: str


@inputs_named()
def run_survey(
    settings: Settings,
    trajectory: tuple[str, bytes] | None = None,
    *,
    progress: Callable[[float, str], None] | None = None,
) -> Survey:
    """Run everything, a few seconds.

    trajectory: name and content of a file (`flight_file.parse_flight`), flown instead of the reference
    flight; the true gravity stays that of the settings. progress takes the share done and what is being done.
    InputError for values that do not fit together.
    """

    def say(share: float, what: str) -> None:
        if progress is not None:
            progress(share, what)

    say(0.0, "flight (the first run on a machine compiles, about ten seconds)")
    inputs = settings.study_inputs()
    flight = reference_flight(inputs.flight) if trajectory is None else parse_flight(
        trajectory[1], trajectory[0], inputs.flight.step_s, inputs.flight.gravity
    )  # fmt: skip
    camera, sky, method, seed = settings.camera(), settings.sky(), settings["camera.method"], int(settings["seed"])
    say(0.05, "star images")
    track = None
    if settings["camera.frames"] == "star images":
        track = track_stars(
            flight, camera, sky, method, seed, progress=lambda share: say(0.05 + 0.2 * share, "star images")
        )
    study = run_study(
        inputs,
        flight=flight,
        measured=None if track is None else track.frames,
        every=output_every(flight.steps),
        progress=lambda share: say(0.25 + 0.6 * share, "error sources"),
    )
    say(0.86, "star frames and attitude methods")
    times = np.arange(0.0, float(flight.time_s[-1]) + 1e-9, STAR_FRAME_SPACING_S)
    images = star_frames(flight, camera, sky, times, seed, method)
    scores, refused = _scores(flight, camera, sky, seed)
    say(0.95, "gravity models")
    return Survey(
        settings=settings,
        study=study,
        track=track,
        star_frames=images,
        scores=scores,
        scenes_refused=refused,
        gravity=() if trajectory is not None else gravity_rows(flight),
        trajectory="" if trajectory is None else trajectory[0],
    )


def _scores(flight: TrueFlight, camera: StarCamera, sky: Sky, seed: int) -> tuple[tuple[MethodScore, ...], int]:
    """The attitude methods on a flight's images, one a second, and how many images the gate refused."""
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
    """True if only a new run can follow the settings: flight, gravity, camera or sky changed, or, with star
    images, the instants of the frames, which also depend on the gate."""
    other = any(
        value != survey.settings[key] for key, value in settings.values.items() if not key.startswith(_LINEAR)
    )
    frames = survey.track is not None and any(
        settings[key] != survey.settings[key]
        for key in ("tracker.from_height", "tracker.frame_interval", "tracker.latency", "tracker.dropouts")
    )
    return other or frames
