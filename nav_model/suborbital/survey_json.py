"""A survey as JSON: the contract's keys, every input with its origin, and all further results."""

import math
import shlex
from typing import Any

from nav_model.base.constants import ARCSECOND
from nav_model.suborbital.input_table import INPUTS
from nav_model.suborbital.noise_ensemble import LEVEL, NoiseEnsemble
from nav_model.suborbital.settings import DEFAULTS, Settings
from nav_model.suborbital.study import Study
from nav_model.suborbital.summary import by_channel, to_json
from nav_model.suborbital.survey import Survey

MAPPING = (
    "imu.velocity_random_walk and imu.angle_random_walk, each times imu.vibration_factor, replace the white noise; "
    "imu.accelerometer_bias and imu.gyro_bias (1 sigma per axis) replace the constant bias on every axis, with the "
    "sign GP-1 has there; instability, scale factor, misalignment and initial errors stay those of GP-1"
)
"""Conversion of a design to the study, in words."""


def survey_json(survey: Survey, study: Study | None = None, settings: Settings | None = None) -> dict[str, Any]:
    """The contract's JSON of `navbudget suborbital` with everything else a survey found.

    study, settings: the moved study and its settings (`survey.moved`) where those are to be written.
    """
    track = survey.track
    moved, inputs = study or survey.study, settings or survey.settings
    return {
        **to_json(moved),
        "exact": study is None or study is survey.study,
        "inputs": {
            key: {
                "value": inputs.show(key, 9),
                "si": inputs[key],
                "from": inputs.origin[key],
            }
            for key in INPUTS
        },
        "design_mapping": MAPPING,
        "command": command(inputs, survey.trajectory),
        "trajectory": survey.trajectory or None,
        "attitude_methods": [
            {
                "method": score.method,
                "mean_error_arcsec": score.mean_error_rad / ARCSECOND,
                "axis_rms_arcsec": [rms / ARCSECOND for rms in score.axis_rms_rad],
                "mean_nees": score.mean_nees,
                "scenes": score.scenes,
                "source": score.source,
            }
            for score in survey.scores
        ],
        "star_frames": {
            "used": int(moved.used.sum()),
            "refused_by_gate": survey.scenes_refused,
            "mean_nees": None if track is None or math.isnan(track.mean_nees) else track.mean_nees,
        },
        "gravity_mismatch_final_m": [
            {"truth": truth, "ins": model, **by_channel(error)} for truth, model, error in survey.gravity
        ],
    }


def noise_json(ensemble: NoiseEnsemble) -> dict[str, Any]:
    """A white-noise ensemble: final rms, the predicted sigma, and the interval for its verdict."""
    return {
        "runs": ensemble.runs,
        "seed": ensemble.seed,
        "final_rms_m": by_channel(ensemble.pure_rms_m[-1]),
        "aided_final_rms_m": by_channel(ensemble.aided_rms_m[-1]),
        "predicted_sigma_m": by_channel(ensemble.pure_sigma_m[-1]),
        "aided_predicted_sigma_m": by_channel(ensemble.aided_sigma_m[-1]),
        "interval": {"level": LEVEL, "low": ensemble.low, "high": ensemble.high},
        "inside": all(inside for *_, inside in ensemble.final),
        "source": ensemble.source,
    }


def command(settings: Settings, trajectory: str = "") -> str:
    """The command line that gives the same study."""
    changed = [f"{key}={settings.show(key, 9)}" for key in INPUTS if settings[key] != DEFAULTS[key]]
    words = ["navbudget", "suborbital"]
    if trajectory:
        words += ["--trajectory", trajectory]
    if changed:
        words += ["--set", *changed]
    return shlex.join(words)
