"""Inputs of the flight and of the time without fixes."""

from nav_model.base.constants import DEGREE, STANDARD_GRAVITY
from nav_model.design.declaration import Quantity
from nav_model.design.part import Part


class Flight(Part):
    """Flight condition: straight, level, constant velocity."""

    section = "flight"
    title = "Flight"

    speed = Quantity(
        default=100.0,
        dimension="speed",
        unit="m/s",
        short="v",
        bounds=(0.1, 8000.0),
        softbounds=(10.0, 300.0),
        label="Speed",
        doc="Ground speed along the track.",
        datasheet="From the flight plan.",
        typical="small UAV 30, turboprop 90, jet 220 m/s",
        slider=True,
    )
    altitude = Quantity(
        default=3000.0,
        dimension="length",
        unit="km",
        short="h",
        bounds=(-500.0, 1e5),
        softbounds=(0.0, 15e3),
        label="Altitude",
        doc="Height above the ellipsoid; sets the radius in the Schuler and Coriolis terms.",
        datasheet="From the flight plan.",
        typical="1 to 14 km",
    )
    latitude = Quantity(
        default=45 * DEGREE,
        dimension="angle",
        unit="°",
        short="lat",
        bounds=(-90 * DEGREE, 90 * DEGREE),
        softbounds=(-90 * DEGREE, 90 * DEGREE),
        label="Latitude",
        doc="Geodetic latitude; sets the Coriolis coupling during an outage.",
        datasheet="From the flight plan. Take the lowest latitude; the coupling is largest there.",
        typical="where the radar will work",
    )
    heading = Quantity(
        default=0.0,
        dimension="angle",
        unit="°",
        short="hdg",
        bounds=(-360 * DEGREE, 360 * DEGREE),
        softbounds=(0.0, 360 * DEGREE),
        label="Heading",
        doc="Track direction, clockwise from north; sets the Coriolis coupling during an outage.",
        datasheet="From the flight plan.",
        typical="0° is north",
    )
    gravity = Quantity(
        default=STANDARD_GRAVITY,
        dimension="acceleration",
        unit="m/s²",
        short="g",
        bounds=(0.1, 30.0),
        softbounds=(9.7, 9.9),
        label="Gravity",
        doc="Local gravity of the model; unit conversions always use 9.80665 m/s².",
        datasheet="From a gravity formula at the latitude.",
        typical="9.780 at the equator, 9.832 m/s² at the poles",
    )


class Coast(Part):
    """Flight without fixes."""

    section = "coast"
    title = "Outage"

    duration = Quantity(
        default=100.0,
        dimension="time",
        unit="s",
        short="out",
        bounds=(0.1, 7200.0),
        softbounds=(1.0, 1000.0),
        label="Outage duration",
        doc="Length of the outage after the last fix. Requirements on the outage are checked at its end.",
        datasheet="From the mission requirement.",
        typical="the longest outage the mission must survive",
        slider=True,
    )
    before_aperture = Quantity(
        default=0.0,
        dimension="time",
        unit="s",
        short="tc",
        bounds=(0.0, 3600.0),
        softbounds=(0.1, 300.0),
        label="Outage before aperture",
        doc="Time without fixes between the last fix and the start of the aperture.",
        datasheet="From the mission requirement, such as jamming near the scene.",
        typical="0 s when fixes last up to the aperture",
        slider=True,
    )
