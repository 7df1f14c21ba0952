"""The command `suborbital`: the star-tracker study."""

import argparse
from pathlib import Path
from typing import Any

from app.console.arguments import design_arguments


def add_to(commands: Any) -> None:
    """Declare the command."""
    suborbital = commands.add_parser(
        "suborbital",
        help="run the star-tracker study of a suborbital flight, as JSON",
        description="INS errors of a suborbital flight by source, with and without star tracker. Without a file the "
        "sensors are those of the set GP-1; a design's [imu] replaces white noise and constant biases; a study file "
        "(saved on the Suborbital page or with --save) states every input. --set takes keys of the design and "
        "inputs of the study, e.g. --set tracker.from_height='80 km'.",
    )
    design_arguments(suborbital, single=True)
    add = suborbital.add_argument
    add("--save", type=Path, metavar="FILE", help="also write the study's inputs as a study file")
    add("--inputs", action="store_true", help="list the inputs of the study and stop")
    add("--trajectory", metavar="FILE", help="flight from a CSV file instead of the reference flight")
    add("--noise-runs", type=int, default=0, metavar="N",
        help="also run N flights with white noise alone (Monte Carlo)")  # fmt: skip
    # Each of these is kept under the key of the input that it sets.
    add("--from-height", dest="tracker.from_height", metavar="HEIGHT",
        help='use the tracker from this height, e.g. "80 km"')  # fmt: skip
    add("--latency", dest="tracker.latency", metavar="TIME", help='age of an attitude when it is used, e.g. "10 ms"')
    add("--misalignment", dest="tracker.misalignment", metavar="ANGLES",
        help='angles from camera to IMU, e.g. "60, 0, 0 arcsec"')  # fmt: skip
    add("--star-images", dest="camera.frames", action="store_const", const="star images",
        help="take attitude from star images instead of a perfect camera")  # fmt: skip
    add("--method", dest="camera.method", metavar="NAME", help="TRIAD, N-vector or SVD")
    add("--seed", metavar="N", help="seed of centroid noise and white noise (default 1)")
    suborbital.set_defaults(run=_suborbital)


def _suborbital(options: argparse.Namespace) -> int:
    from app.subjects.suborbital.console import list_inputs, run

    return list_inputs() if options.inputs else run(options)
