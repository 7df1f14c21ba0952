"""Cautions and assumptions of a budget, for its page and its report."""

from app.document.blocks import Bullets
from app.document.numbers import number
from app.document.wording import MOMENTS
from app.report.inputs import doubtful_inputs
from nav_model.budget import Budget
from nav_model.budget.provenance import cautions
from nav_model.budget.verdict import flies
from nav_model.design.processing import POST_PROCESSED


def caution_list(budget: Budget) -> Bullets:
    """Cautions about this budget: inputs that are not confirmed, then those of the model."""
    doubtful = doubtful_inputs(budget.design)
    first = (f"Not confirmed at the source: {', '.join(doubtful)}.",) if doubtful else ()
    return Bullets((*first, *cautions(budget)), "Cautions")


def assumption_list(budget: Budget) -> Bullets:
    """The assumptions of every budget, and which figures its requirements limit."""
    requirements, gnss, processing = budget.design.requirements, budget.design.gnss, budget.design.processing
    noise = "with white noise from fix to fix [T-2]"
    if gnss.correlated:
        noise = "with a slow first-order Gauss-Markov error on top of white noise"
    measured = "position only" if gnss.velocity_noise is None else "position and velocity"
    held = "post-processed figures" if processing.mode == POST_PROCESSED else "figures in real time"
    return Bullets(
        (
            "Straight, level flight at constant velocity; steady state before the last fix; small errors [T-1]."
            + (" Requirements along the flight are checked with its turns [P-13]." if flies(budget.design) else ""),
            "Random walks are white, Gaussian, equal and independent on the three axes; residual biases are constant "
            "over the outage and the aperture.",
            f"GNSS measures {measured}, per axis, {noise}.",
            f"Requirements are checked against the {held}. "
            "Real time: a free INS from the last fix before the aperture. "
            "Post-processed: a smoother with all fixes before the aperture, those in it, and those of "
            f"{number(processing.leg_after, given=True)} s after it [P-3].",
            "In real time, requirements in steady state are checked against the value "
            f"{MOMENTS[requirements.steady_state]} [T-8], "
            "after the last fix against the curve with Schuler and Coriolis terms [T-17].",
            f"Each value is checked at {requirements.confidence:g}σ.",
            "Broadside strip map. Only the IMU measures motion during the aperture, which starts "
            f"{number(budget.design.coast.before_aperture, given=True)} s after the last fix [S-1], [S-5].",
            "Lever arm, timing, atmosphere and range migration are not part of the budget."
            if not budget.design.contributors
            else "The budget includes the design's own contributors. They are independent of the "
            "model's errors and of each other; a systematic one adds linearly. Range migration is not part of it.",
        ),
        "Assumptions",
    )
