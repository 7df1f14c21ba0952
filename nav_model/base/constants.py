"""Constants of nature, of the WGS 84 Earth and of the units, each with its source. SI, angles in rad.

Everything that needs one takes it from here; the compiled kernels are compiled again when this file changes
(`nav_model.base.compiled`).
"""

import math
from typing import Final

DEGREE: Final = math.pi / 180
"""One degree [rad]."""
ARCSECOND: Final = math.pi / 648000
"""One second of arc [rad]."""
DEGREE_PER_HOUR: Final = DEGREE / 3600
"""One degree per hour [rad/s]."""

SPEED_OF_LIGHT: Final = 299792458.0
"""In vacuum [m/s], exact: defines the metre (SI Brochure, 9th edition, section 2.2)."""
STANDARD_GRAVITY: Final = 9.80665
"""One g of data sheets [m/s²], exact (3rd CGPM, 1901)."""
MILLI_G: Final = 1e-3 * STANDARD_GRAVITY
"""One mg [m/s²]."""

# Defining parameters of WGS 84: NIMA TR8350.2, 3rd edition, table 3.1.
SEMI_MAJOR_AXIS: Final = 6378137.0
"""Equatorial radius of WGS 84 [m]."""
FLATTENING: Final = 1.0 / 298.257223563
"""Flattening of WGS 84."""
EARTH_RATE: Final = 7.292115e-5
"""Angular rate of the Earth in inertial space [rad/s]."""
GRAVITATIONAL_PARAMETER: Final = 3.986004418e14
"""Gravitational constant times the mass of the Earth with its atmosphere, GM [m³/s²]; KM in star_tracker.md."""

# Zonal coefficients of the normal field: TR8350.2, table 3.5 and its recursion.
J2: Final = 1.08262982e-3
J4: Final = -2.37091126e-6
J6: Final = 6.08346498e-9

MEAN_RADIUS: Final = 6371008.8
"""Mean radius (2a + b)/3 of the Earth [m] (IUGG; Moritz, Geodetic Reference System 1980, 6371008.7714 m)."""
SPHERE_RADIUS: Final = 6371000.0
"""Radius of the spherical Earth of the suborbital study [m]. The final errors of the reference flight in
star_tracker.md, which the study is checked against, hold for this value, not for `MEAN_RADIUS`."""
