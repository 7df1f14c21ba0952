"""From a design to its budget: one pass through the closed forms.

`analyse` gives the `Budget` of `nav_model.budget.result`, which pages, reports and JSON read. What a figure is stands
in its declaration, `nav_model.design.figures`; its formula in `nav_model.budget.real_time` and, post-processed, in
`nav_model.budget.smoothed`.
"""

from numpy.typing import ArrayLike

from nav_model.budget.navigation import outage_times
from nav_model.budget.refusals import imaged_inputs
from nav_model.budget.result import Budget
from nav_model.design import Design

__all__ = ["Budget", "analyse"]


def analyse(design: Design, times: ArrayLike | None = None) -> Budget:
    """The budget of one design.

    Parameters
    ----------
    design : Design
    times : array_like, optional
        Seconds since the last fix for the outage curves; by default 300 points over ``coast.duration``.

    Returns
    -------
    Budget

    Raises
    ------
    InputError
        If `times` are not finite, negative or beyond the bounds of ``coast.duration``, if the aperture that
        follows from the radar's inputs is longer than ``radar.aperture_time`` may be, or if the design's
        values are so far apart that double precision cannot hold them together.

    Examples
    --------
    >>> from nav_model import Design, analyse
    >>> budget = analyse(Design({"imu.angle_random_walk": 1e-5, "requirements.tilt": 1e-3}))
    >>> f"{budget.steady_state.prior['tilt']:.3e} rad"
    '6.706e-05 rad'
    >>> budget.verdict.closes
    True
    """
    budget = Budget(design, imaged_inputs(design), outage_times(design, times))
    budget.compute()  # so that a refusal is raised here
    return budget
