"""The command `suborbital`: the star-tracker study."""

from __future__ import annotations

import argparse
from typing import Any

from app.console.arguments import content_of, declare, paths_of


def add_to(commands: Any) -> None:
    """Declare the command."""
    declare(commands, __file__, suborbital=_suborbital)


def _suborbital(options: argparse.Namespace) -> int:
    from app.subjects.suborbital.console import list_inputs, run
    from nav_model.suborbital.study_file import MAX_BYTES as MAX_STUDY

    if options.inputs:
        return list_inputs()
    designs, changes = list(options.designs), list(options.changes)
    if designs or any("=" not in change for change in changes):
        designs = paths_of(options)
        changes = list(options.changes)
    of_design = [change for change in changes if _is_of_design(change.partition("=")[0].strip())]
    asked = dict(part.split("=", 1) for part in changes if part not in of_design)
    asked |= {
        key: text
        for key, text in (
            ("tracker.from_height", options.from_height),
            ("tracker.latency", options.latency),
            ("tracker.misalignment", options.misalignment),
            ("camera.frames", "star images" if options.star_images else None),
            ("camera.method", options.method),
            ("seed", options.seed),
        )
        if text is not None
    }
    data, where = content_of(designs[0], MAX_STUDY) if designs else (None, "")
    return run(data, where, of_design, asked, options.trajectory, options.noise_runs, options.save)


def _is_of_design(key: str) -> bool:
    """Whether a key is one of a design, or of a section that only designs have; what both have is the study's."""
    from nav_model.design.parts import INPUTS, TOP_KEYS, all_keys
    from nav_model.suborbital.settings import DEFAULTS

    ours = {name.partition(".")[0] for name in DEFAULTS.values}
    section = key.partition(".")[0]
    return key not in DEFAULTS.values and (key in (*TOP_KEYS, *all_keys()) or section in INPUTS.keys() - ours)
