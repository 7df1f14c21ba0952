"""Inputs of the radar."""

from nav_model.base.constants import DEGREE, SPEED_OF_LIGHT
from nav_model.design.declaration import Alternative, Choice, OptionalQuantity, Quantity
from nav_model.design.part import Part, preset


class Radar(Part):
    """Synthetic-aperture radar."""

    section = "radar"
    title = "Radar"

    preset = preset("a radar")
    frequency = Quantity(
        default=9.6e9,
        dimension="frequency",
        unit="GHz",
        short="f",
        bounds=(1e7, 1e12),
        softbounds=(3e8, 4e10),
        label="Frequency",
        doc="Carrier frequency; a file may give the wavelength instead.",
        datasheet='"Centre frequency".',
        typical="L 1.3, C 5.3, X 9.6, Ku 16.7, Ka 35 GHz",
        alternative=Alternative("wavelength", "length", "cm", SPEED_OF_LIGHT),
    )
    slant_range = Quantity(
        default=7000.0,
        dimension="length",
        unit="km",
        short="r",
        bounds=(1.0, 2e6),
        softbounds=(500.0, 50e3),
        label="Slant range",
        doc="Distance to the scene at the middle of the aperture.",
        datasheet='Radar table: "slant range"; else from height and grazing angle.',
        typical="5 to 30 km",
        slider=True,
    )
    grazing_angle = Quantity(
        default=35 * DEGREE,
        dimension="angle",
        unit="°",
        short="gr",
        bounds=(0.0, 90 * DEGREE),
        softbounds=(20 * DEGREE, 70 * DEGREE),
        label="Grazing angle",
        doc="Between the line of sight and the ground; weights vertical against cross-track errors [S-1].",
        datasheet='Radar table: "grazing angle" or "depression angle"; 90° less the incidence angle.',
        typical="20 to 65°",
    )
    azimuth_resolution = Quantity(
        default=0.5,
        dimension="length",
        unit="m",
        short="rho",
        bounds=(1e-3, 1e3),
        softbounds=(0.05, 10.0),
        label="Azimuth resolution",
        doc="Required −3 dB width. It sets the aperture time unless one is given [S-3].",
        datasheet='Radar table: "azimuth" or "cross-range resolution".',
        typical="0.1 m spotlight to 3 m strip map",
        slider=True,
        unless="aperture_time",
    )
    range_resolution = OptionalQuantity(
        dimension="length",
        unit="m",
        short="rr",
        bounds=(1e-3, 1e3),
        softbounds=(0.05, 10.0),
        label="Range resolution",
        doc="Size of a range cell, half of which the path error before autofocus may be.",
        datasheet='Radar table: "range resolution"; else the speed of light over twice the bandwidth.',
        typical="0.1 to 3 m",
        when_empty="as azimuth",
        instead="azimuth_resolution",
        variable=False,
        since="0.2.0",
    )
    window = Choice(
        default="uniform",
        options={"uniform": "uniform", "hamming": "Hamming", "taylor": "Taylor −35 dB, n̄ 5"},
        short="win",
        label="Window",
        doc="Azimuth weighting: uniform, Hamming, or Taylor (-35 dB, n̄ = 5). A setting of the image processor: "
        "uniform is sharpest, Taylor usual, Hamming lowest in side lobes.",
    )
    squint_angle = Quantity(
        default=0.0,
        dimension="angle",
        unit="°",
        short="sq",
        bounds=(-60 * DEGREE, 60 * DEGREE),
        softbounds=(-60 * DEGREE, 60 * DEGREE),
        label="Squint angle",
        doc="Angle of the line of sight in the slant plane, forward positive. Squint lengthens the aperture that a "
        "resolution needs.",
        datasheet='Radar table: "squint".',
        typical="0° strip map, up to 45° spotlight",
    )
    aperture_time = OptionalQuantity(
        dimension="time",
        unit="s",
        short="ta",
        bounds=(1e-3, 3600.0),
        softbounds=(0.1, 100.0),
        label="Aperture time",
        doc="Replaces the aperture time that follows from range, speed, resolution and window.",
        datasheet='Radar table: "integration time" or "synthetic aperture time".',
        typical="0.5 to 50 s",
        when_empty="from the resolution",
    )
    autofocus_order = Choice(
        default=1,
        options={1: "nothing (linear phase only)", 2: "quadratic", 3: "quadratic and cubic"},
        short="af",
        label="Autofocus removes",
        doc="Highest polynomial order of phase removed: 1 linear only (no autofocus), 2 quadratic, 3 cubic. A "
        "setting of the image processor; map drift removes 2.",
    )
