"""Inputs of the navigation filter: its states, and its tuning."""

from typing import Any, Final

from nav_model.base.constants import DEGREE
from nav_model.design.declaration import Choice, Quantity
from nav_model.design.part import Part

FILTER_STATES: Final = {
    9: "no biases, no slow error",
    12: "slow GNSS error",
    15: "biases",
    18: "biases, slow GNSS error",
    21: "constant and varying biases",
    24: "both kinds of bias, slow GNSS error",
}
"""Number of states of a filter -> what it estimates beyond position, velocity and attitude."""
_SINCE = "0.2.0"
_CHOICE = "A choice of the filter's designer."


def _scale(short: str, label: str, doc: str) -> Any:
    return Quantity(
        default=1.0, dimension="", unit="", short=short, bounds=(1e-3, 1e3), softbounds=(0.1, 10.0), label=label,
        doc=doc, datasheet=_CHOICE, typical="1: matched", variable=False, since=_SINCE,
    )  # fmt: skip


class Filter(Part):
    """Filter of flights and runs; the closed forms are of a matched one."""

    section = "filter"
    title = "Filter of flights and runs"
    optional = True

    states = Choice(
        default=0,
        options={0: "as the design declares"}
        | {count: f"{count}: {known}" for count, known in FILTER_STATES.items()},
        short="fst",
        label="States",
        doc="As declared: 9; 15 where a sensor has a bias, constant or varying; 21 where it has both; and 3 more for "
        "a slow GNSS error.",
        since=_SINCE,
    )
    process_noise_scale = _scale(
        "fpn", "Process noise factor",
        "Factor on the standard deviation of the process noise that the filter assumes; 0.71 halves the variance.",
    )  # fmt: skip
    gnss_noise_scale = _scale("fgn", "Fix noise factor", "Factor on the fix noise that the filter assumes.")
    propagation_rate = Quantity(
        default=10.0, dimension="frequency", unit="Hz", short="fpr", bounds=(0.5, 1e4), softbounds=(1.0, 100.0),
        label="Propagation rate", doc="Covariance steps per second between fixes, in simulated runs.",
        datasheet=_CHOICE, typical="10 Hz loses nothing at 100 Hz", variable=False, since=_SINCE,
    )  # fmt: skip
    initial_yaw = Quantity(
        default=0.1 * DEGREE, dimension="angle", unit="°", short="fiy", bounds=(1e-6 * DEGREE, 20 * DEGREE),
        softbounds=(1e-3 * DEGREE, 5 * DEGREE), label="Initial heading error",
        doc="1σ of the heading at the start of a flight or run.", datasheet="From the alignment.",
        typical="gyrocompass 0.05, two antennas 0.1, magnetometer 1 to 2°", variable=False, since=_SINCE,
    )  # fmt: skip
