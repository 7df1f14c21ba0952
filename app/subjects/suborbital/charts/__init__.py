"""The charts of the suborbital study, as plain data. Each takes a `Shown` and draws what is in it; none computes
an error."""

from app.subjects.suborbital.charts.attitude import (
    inertial_attitude_chart,
    navigation_attitude_chart,
    star_chart,
    star_count_chart,
)
from app.subjects.suborbital.charts.camera_noise import NOISES, camera_noise_answer, camera_noise_chart
from app.subjects.suborbital.charts.errors import aided_chart, growth_chart, source_chart
from app.subjects.suborbital.charts.flight import force_chart, gravity_chart, height_chart, map_chart, rate_chart
from app.subjects.suborbital.charts.sensors import noise_chart, sensor_chart
from app.subjects.suborbital.charts.shown import CHANNELS, SHOWN_SOURCES, Shown

__all__ = [
    "CHANNELS",
    "NOISES",
    "SHOWN_SOURCES",
    "Shown",
    "aided_chart",
    "camera_noise_answer",
    "camera_noise_chart",
    "force_chart",
    "gravity_chart",
    "growth_chart",
    "height_chart",
    "inertial_attitude_chart",
    "map_chart",
    "navigation_attitude_chart",
    "noise_chart",
    "rate_chart",
    "sensor_chart",
    "source_chart",
    "star_chart",
    "star_count_chart",
]
