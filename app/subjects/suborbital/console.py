"""`navbudget suborbital`: the study from a design or a study file and options, JSON out, progress on standard
error."""

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from app.console.arguments import content_of, paths_of, put_json
from app.console.files import whole_file
from app.console.progress import show_progress
from nav_model.base.errors import InputError, under
from nav_model.design import Design
from nav_model.design.declaration import Choice
from nav_model.design.file import parse_design, read_bytes
from nav_model.design.parts import INPUTS, TOP_KEYS, all_keys
from nav_model.suborbital.flight_file import BOUNDS
from nav_model.suborbital.input_table import GROUPS
from nav_model.suborbital.noise_ensemble import MOST_RUNS, fly_noise
from nav_model.suborbital.settings import DEFAULTS, Settings, from_design, read_changes
from nav_model.suborbital.study_file import MAX_BYTES as MAX_STUDY
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


def run(options: argparse.Namespace) -> int:
    """Run the study and write its JSON.

    Raises
    ------
    InputError
        For an option, a file or an input that cannot be used.
    """
    if not 0 <= options.noise_runs <= MOST_RUNS:
        raise InputError("--noise-runs", f"{options.noise_runs} is not allowed. Enter 0 to {MOST_RUNS}.")
    settings, design, flown = _asked(options)
    if options.trajectory is not None:
        flown = (Path(options.trajectory).name, read_bytes(options.trajectory, BOUNDS.most_bytes))
    if options.save is not None:
        with under("--save"), whole_file(options.save) as file:
            file.write(format_study(settings, flown).encode("utf-8"))
    with study_progress() as progress:
        survey = run_survey(settings, flown, progress=progress)
        answer = survey_json(survey)
        answer["design"] = None if design is None else design.name
        if options.noise_runs:
            covariance = None if survey.track is None else survey.track.covariance
            seed = int(settings["seed"])
            noise = fly_noise(survey.study, options.noise_runs, seed, covariance, progress=progress)
            answer["white_noise_monte_carlo"] = noise_json(noise)
    return put_json(lambda: answer)


@contextmanager
def study_progress(of: str = "") -> Iterator[Callable[[float, str], None]]:
    """Progress of a study, on standard error after ``of``."""
    with show_progress() as show:
        yield lambda share, what: show(f"{of}{what}", share)


def _asked(options: argparse.Namespace) -> tuple[Settings, Design | None, tuple[str, bytes] | None]:
    """The settings of a design or a study file and of the options, the design, and the flight of the study file."""
    designs, changes = list(options.designs), list(options.changes)
    if designs or any("=" not in change for change in changes):
        designs = paths_of(options)
        changes = list(options.changes)
    of_design = [change for change in changes if _is_of_design(change.partition("=")[0].strip())]
    asked = dict(part.split("=", 1) for part in changes if part not in of_design)
    asked |= {key: text for key, text in vars(options).items() if key in DEFAULTS.values and text is not None}
    data, where = content_of(designs[0], MAX_STUDY) if designs else (None, "")
    settings, design, flown = DEFAULTS, None, None
    if of_design and (data is None or is_study(data)):
        key = of_design[0].partition("=")[0]
        raise InputError(key, f"is a key of a design, and no DESIGN is given{'' if data is None else ' but a study'}")
    if data is not None and is_study(data):
        study = parse_study(data, where)
        settings, flown = study.settings, study.trajectory
    elif data is not None:
        design = parse_design(data, where, of_design)
        settings = from_design(DEFAULTS, design)
    return read_changes(settings, asked, "command line"), design, flown


def _is_of_design(key: str) -> bool:
    """True for a key of a design, or of a section that only designs have; what both have is the study's."""
    ours = {name.partition(".")[0] for name in DEFAULTS.values}
    section = key.partition(".")[0]
    return key not in DEFAULTS.values and (key in (*TOP_KEYS, *all_keys()) or section in INPUTS.keys() - ours)
