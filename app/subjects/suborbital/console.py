"""`navbudget suborbital`: the study from a design or a study file and options, JSON out, progress on standard
error."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from app.console.arguments import put_json
from app.console.files import put_file, spare
from app.console.progress import show_progress
from nav_model.base.errors import InputError
from nav_model.design.declaration import Choice
from nav_model.design.file import parse_design, read_bytes
from nav_model.suborbital.flight_file import BOUNDS
from nav_model.suborbital.input_table import GROUPS
from nav_model.suborbital.noise_ensemble import MOST_RUNS, fly_noise
from nav_model.suborbital.settings import DEFAULTS, from_design, read_changes
from nav_model.suborbital.study_file import format_study, is_study, parse_study
from nav_model.suborbital.survey import run_survey
from nav_model.suborbital.survey_json import noise_json, survey_json


def list_inputs() -> int:
    """Print every input of the study with its default and what it is."""
    for title, group in GROUPS.items():
        print(title)
        for declared in group:
            choices = f" ({', '.join(declared.objects)})" if isinstance(declared, Choice) else ""
            default = DEFAULTS.show(declared.key) or "none"
            print(f"  {declared.key:40} {default:22} {declared.label}. {declared.doc}{choices}")
    return 0


def run(
    data: bytes | None,
    where: str,
    of_design: Sequence[str],
    changes: Mapping[str, str],
    trajectory: str | None,
    noise_runs: int,
    save: Path | None,
) -> int:
    """Run the study and write its JSON; InputError for bad input.

    data, where: a design or a study file and its name, or None; of_design: assignments to keys of the design;
    changes: inputs of the study that come on top; save: where to write the study as a file.
    """
    if not 0 <= noise_runs <= MOST_RUNS:
        raise InputError("--noise-runs", f"{noise_runs} is not allowed. Enter 0 to {MOST_RUNS}.")
    settings, design, flown = DEFAULTS, None, None
    if of_design and (data is None or is_study(data)):
        key = of_design[0].partition("=")[0]
        raise InputError(key, f"is a key of a design, and no DESIGN is given{'' if data is None else ' but a study'}")
    if data is not None and is_study(data):
        study = parse_study(data, where)
        settings, flown = study.settings, study.trajectory
    elif data is not None:
        spare(where, save, "--save")
        design = parse_design(data, where, of_design)
        settings = from_design(DEFAULTS, design)
    settings = read_changes(settings, changes, "command line")
    if trajectory is not None:
        flown = (Path(trajectory).name, read_bytes(trajectory, BOUNDS.most_bytes))
    if save is not None:
        try:
            put_file(save, format_study(settings, flown).encode("utf-8"))
        except InputError as error:
            raise error.under("--save") from error
    try:
        with show_progress() as show:
            survey = run_survey(settings, flown, progress=lambda share, what: show(what, share))
            answer = survey_json(survey)
            answer["design"] = None if design is None else design.name
            if noise_runs:
                covariance = None if survey.track is None else survey.track.covariance
                answer["white_noise_monte_carlo"] = noise_json(
                    fly_noise(survey.study, noise_runs, int(settings["seed"]), covariance,
                              progress=lambda share, what: show(what, share))
                )  # fmt: skip
    except InputError:
        raise
    except ValueError as error:
        raise InputError("suborbital", str(error)) from error
    return put_json(lambda: answer)
