"""The outage with what the polynomials leave out. [T-17]

Beside [T-1], the horizontal channels feel the Schuler term -g/R, the vertical channel gravity's gradient
+2g/R and the horizontal velocity error through Coriolis and the centrifugal term:
``d(dv_down)/dt += 2 Omega cos(lat) dv_east + (2V/R) dv_along``. Left out, the vertical curve is optimistic
after about 45 s. The covariance obeys a linear equation with constant coefficients; its Taylor series
converges everywhere, and is summed once for all times.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.steady_state import Array, Horizontal, Vertical

EARTH_RADIUS = 6371008.8  # m, mean radius (IUGG)
EARTH_RATE = 7.2921150e-5  # rad/s
_MAX_TERMS = 400


class RefinedGrowth(NamedTuple):
    """Variances against time, shape (times,).

    Position [m²] and velocity [m²/s²] along the track, across it and down; tilt [rad²].
    """

    along: Array
    cross: Array
    vertical: Array
    velocity_along: Array
    velocity_cross: Array
    velocity_vertical: Array
    tilt: Array

    @property
    def horizontal(self) -> Array:
        """The larger of the two horizontal position variances at each time."""
        worst: Array = np.maximum(self.along, self.cross)
        return worst

    @property
    def velocity_horizontal(self) -> Array:
        """The larger of the two horizontal velocity variances at each time."""
        worst: Array = np.maximum(self.velocity_along, self.velocity_cross)
        return worst


def dynamics(g: float, radius: float, speed: float, latitude: float, heading: float) -> Array:
    """System matrix of the eight error states, shape (8, 8).

    States: along-track position, velocity, pitch; cross-track (right) position, velocity, roll; down
    position, velocity.
    """
    f = np.zeros((8, 8))
    f[0, 1] = f[3, 4] = f[6, 7] = 1
    f[1, 2], f[4, 5] = -g, g
    f[1, 0] = f[4, 3] = -g / radius
    f[7, 6] = 2 * g / radius
    coriolis = 2 * EARTH_RATE * np.cos(latitude)
    # east = along sin(heading) + cross cos(heading)
    f[7, 1] = coriolis * np.sin(heading) + 2 * speed / radius
    f[7, 4] = coriolis * np.cos(heading)
    return f


def refined_growth(
    start: Horizontal,
    start_vertical: Vertical,
    sigma_a: float,
    sigma_w: float,
    g: float,
    time: ArrayLike,
    *,
    speed: float,
    latitude: float,
    altitude: float = 0.0,
    heading: float = 0.0,
) -> RefinedGrowth:
    """Variances `time` seconds after the last fix, from the posterior covariance of the filter. [T-17]

    Parameters
    ----------
    start, start_vertical
        Covariances just after the last fix, of one horizontal channel and the vertical one. The two
        horizontal channels start alike and independent.
    sigma_a, sigma_w, g : float
        Velocity random walk [m/s/√s], angle random walk [rad/√s], gravity [m/s²].
    time : array_like, shape (times,)
        Seconds since the last fix.
    speed, latitude, altitude, heading : float
        m/s, rad, m, rad.

    One design at a time: the matrices are those of one flight condition.

    Raises
    ------
    ArithmeticError
        If rounding swallows a variance: far beyond the outages of aircraft.
    """
    t = np.atleast_1d(np.asarray(time, float))
    end = float(np.max(t, initial=0.0)) or 1.0
    f = dynamics(g, EARTH_RADIUS + altitude, speed, latitude, heading) * end
    q = np.diag([0, sigma_a**2, sigma_w**2, 0, sigma_a**2, sigma_w**2, 0, sigma_a**2]) * end
    p = np.zeros((8, 8))
    block = start.matrix()
    flip = np.diag([1.0, 1.0, -1.0])  # positive pitch accelerates backward
    p[:3, :3], p[3:6, 3:6] = flip @ block @ flip, block
    p[6, 6], p[6, 7], p[7, 6], p[7, 7] = (
        start_vertical.v11,
        start_vertical.v12,
        start_vertical.v12,
        start_vertical.v22,
    )
    terms = _taylor(f, q, p)
    powers = np.vander(t / end, len(terms), increasing=True)
    # einsum, not @: a product this small is slowed manyfold when BLAS wakes its threads on a busy machine
    sums = np.einsum("tk,kn->nt", powers, terms)
    if not np.all(sums >= 0):
        raise ArithmeticError("the outage series lost a variance to rounding")
    return RefinedGrowth(
        along=sums[0],
        cross=sums[3],
        vertical=sums[6],
        velocity_along=sums[1],
        velocity_cross=sums[4],
        velocity_vertical=sums[7],
        tilt=np.maximum(sums[2], sums[5]),
    )


def _taylor(f: Array, q: Array, p: Array) -> Array:
    """Coefficients of the diagonal of P(x), P' = F P + P F' + Q, shape (terms, n), for x up to one.

    The series is cut where four terms in a row are below the rounding of their sums.
    """
    diagonal = [np.diagonal(p).copy()]
    total = diagonal[0].copy()
    quiet = 0
    for k in range(1, _MAX_TERMS):
        half = f @ p
        p = half + half.T
        if k == 1:
            p = p + q
        p = p / k
        diagonal.append(np.diagonal(p).copy())
        total = total + diagonal[-1]
        quiet = quiet + 1 if np.all(np.abs(diagonal[-1]) <= 1e-17 * np.abs(total)) else 0
        if quiet == 4:
            return np.array(diagonal)
    raise ArithmeticError(f"the outage series did not settle in {_MAX_TERMS} terms")
