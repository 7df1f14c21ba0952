"""From a design to its budget: one pass through the closed forms.

`analyse` composes the closed forms through `nav_model.budget.figures` into the `Budget` of `nav_model.budget.result`,
which pages, reports and JSON read. A figure here is a standard deviation that a requirement limits.
"""

from functools import partial

from numpy.typing import ArrayLike

from nav_model.budget.figures import begun, free_shifts, real_time_figures, sampled, settled
from nav_model.budget.image import placement_of, sar_of, spectral_of
from nav_model.budget.inputs import inputs_of
from nav_model.budget.navigation import outage_of, outage_times, steady_state_of
from nav_model.budget.post_processing import after_flight
from nav_model.budget.refusals import refuse_hidden_target, refuse_late_data, refuse_long_aperture, refused
from nav_model.budget.result import Budget
from nav_model.budget.shares import shares_by_step, shares_of
from nav_model.budget.verdict import judge
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
    >>> f"{budget.steady_state.prior.tilt:.3e} rad"
    '6.706e-05 rad'
    >>> budget.verdict.closes
    True
    """
    with refused(design):
        budget = _analyse(design, times)
        assert budget.verdict  # of a post-processed design it is computed here, so that a refusal is raised here
        return budget


def _analyse(design: Design, times: ArrayLike | None) -> Budget:
    inputs = inputs_of(design)
    refuse_hidden_target(float(inputs.squint), float(inputs.grazing_angle))
    refuse_long_aperture(float(inputs.aperture))
    refuse_late_data(design.motion.delay, float(inputs.aperture))
    time = outage_times(design, times)
    closed = settled(inputs)
    moments = sampled(inputs)
    sized = shares_by_step(inputs, real_time_figures)
    shares = shares_of(sized)
    start = begun(inputs, moments.posterior)
    steady_state = steady_state_of(inputs, closed, start, moments, shares)
    coast = outage_of(inputs, closed, moments.posterior, time, sized)
    sar = sar_of(design, inputs, start.horizontal, shares)
    placement = placement_of(inputs, free_shifts(inputs, start), sized)
    spectral = spectral_of(inputs, sar.cell_length)
    verdict = judge(design, steady_state, coast, sar, placement, spectral)
    later = partial(after_flight, design, inputs, steady_state, coast, sar, spectral)
    return Budget(design, steady_state, coast, sar, placement, spectral, verdict, later)
