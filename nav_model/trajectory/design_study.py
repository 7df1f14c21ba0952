"""The covariance along a flight of a design: its study, its aperture, its limits."""

from __future__ import annotations

from nav_model.budget.inputs import inputs_of
from nav_model.budget.verdict import confidence_of
from nav_model.design import Design
from nav_model.simulation.specification import SimulationSpec
from nav_model.trajectory.result import FIGURES, STATES
from nav_model.trajectory.specification import Aiding, Aperture, CovarianceSpec, Limits, Line


def aperture_of(design: Design) -> Aperture:
    """The design's aperture, looking to the right."""
    x, radar = inputs_of(design), design.radar
    return Aperture(
        duration=float(x.aperture),
        wavelength=float(x.wavelength),
        grazing_angle=radar.grazing_angle,
        slant_range=radar.slant_range,
        squint=radar.squint_angle,
        autofocus_order=radar.autofocus_order,
        scene_height_error=design.processing.scene_height_error,
    )


def covariance_specification(
    design: Design, study: SimulationSpec, aiding: Aiding | None = None, lines: tuple[Line, ...] = ()
) -> CovarianceSpec:
    """The covariance along the flight of `study`, as `simulation.design_study.specification` makes it of the design.

    The limits are the design's requirements on figures that are known along a flight, less their confidence, in its
    processing.
    """
    limits = [
        (name, limit / confidence_of(design, name))
        for name in (*FIGURES, *STATES)
        if (limit := getattr(design.requirements, name)) is not None
    ]
    return CovarianceSpec(
        study, aperture_of(design), aiding or Aiding(), lines, Limits(design.processing.mode, tuple(limits))
    )
