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
    design_arguments(suborbital, one=True)
    suborbital.add_argument("--save", type=Path, metavar="FILE", help="also write the study's inputs as a study file")
    suborbital.add_argument("--inputs", action="store_true", help="list the inputs of the study and stop")
    suborbital.add_argument(
        "--trajectory", metavar="FILE", help="flight from a CSV file instead of the reference flight"
    )
    suborbital.add_argument("--from-height", metavar="HEIGHT", help='use the tracker from this height, e.g. "80 km"')
    suborbital.add_argument("--latency", metavar="TIME", help='age of an attitude when it is used, e.g. "10 ms"')
    suborbital.add_argument(
        "--misalignment", metavar="ANGLES", help='angles from camera to IMU, e.g. "60, 0, 0 arcsec"'
    )
    suborbital.add_argument(
        "--star-images", action="store_true", help="take attitude from star images instead of a perfect camera"
    )
    suborbital.add_argument("--method", metavar="NAME", help="TRIAD, N-vector, q-method, QUEST or SVD")
    suborbital.add_argument("--seed", metavar="N", help="seed of centroid noise and white noise (default 1)")
    suborbital.add_argument(
        "--noise-runs",
        type=int,
        default=0,
        metavar="N",
        help="also run N flights with white noise alone (Monte Carlo)",
    )
    suborbital.set_defaults(run=_suborbital)


def _suborbital(options: argparse.Namespace) -> int:
    from app.subjects.suborbital.console import list_inputs, run

    return list_inputs() if options.inputs else run(options)
