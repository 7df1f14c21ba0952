"""Inputs of the processing: in real time or after the flight, and how much of the flight is used."""

from nav_model.design.declaration import Choice, Quantity
from nav_model.design.part import Part

REAL_TIME, POST_PROCESSED = "real time", "post-processed"


class Processing(Part):
    """Processing of the trajectory for the image: in real time, or after the flight."""

    section = "processing"
    title = "Processing"

    mode = Choice(
        default=REAL_TIME,
        options={REAL_TIME: "real time", POST_PROCESSED: "post-processed"},
        short="proc",
        label="Processing",
        doc="Real time: a free INS from the last fix before the aperture. Post-processed: a smoother with the fixes "
        "before, in and after the aperture. Requirements are checked for the one chosen.",
        since="0.1.0",
    )
    leg_after = Quantity(
        default=200.0,
        dimension="time",
        unit="s",
        short="la",
        bounds=(0.0, 1e5),
        softbounds=(1.0, 1000.0),
        label="Fixes after aperture",
        doc=(
            "Time after the aperture whose fixes the smoother uses; 0: fixes up to the aperture's end. Before the "
            "aperture the filter has settled."
        ),
        datasheet="From the flight plan.",
        typical="60 to 600 s",
        since="0.1.0",
    )
    scene_height_error = Quantity(
        default=0.0,
        dimension="length",
        unit="m",
        short="she",
        bounds=(0.0, 1e4),
        softbounds=(0.1, 100.0),
        label="Scene height error",
        doc="1σ of the terrain height that the image is projected on. It shifts the image in ground range by the "
        "height error times the tangent of the grazing angle.",
        datasheet='Elevation model: "LE90" is 1.645 σ.',
        typical="lidar 0.2, TanDEM-X 2, SRTM 5 m",
        since="0.1.0",
        source="scene height error",
    )
