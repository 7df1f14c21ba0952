"""Pictures in decibels as one PNG with axes, names and their common scale."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence

from nav_model.sar.pictures import Pictures

FLOOR_DB = -40.0
_ACROSS = 3


def to_png(pictures: Pictures, names: Sequence[str]) -> bytes:
    """All pictures on one scale from `FLOOR_DB` to 0 dB, three in a row, axes in metres."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    rows = math.ceil(len(names) / _ACROSS)
    figure = Figure(figsize=(10, 3.2 * rows), layout="constrained")
    FigureCanvasAgg(figure)
    extent = (pictures.x[0], pictures.x[-1], pictures.y[0], pictures.y[-1])
    image = None
    for place, (name, power) in enumerate(zip(names, pictures.power_db, strict=True)):
        axes = figure.add_subplot(rows, min(_ACROSS, len(names)), place + 1)
        image = axes.imshow(
            power, extent=extent, origin="lower", vmin=FLOOR_DB, vmax=0, cmap="viridis", aspect="auto"
        )
        axes.set_title(f"{name}, brightest {power.max():+.2f} dB".replace("⁽ʳ⁾", "(r)").replace("-", "−"), fontsize=9)
        axes.set_xlabel("azimuth or x [m]", fontsize=8)
        axes.set_ylabel("range or y [m]", fontsize=8)
        axes.tick_params(labelsize=7)
    if image is not None:
        figure.colorbar(image, ax=figure.axes, label="power [dB]", shrink=0.6)
    packed = io.BytesIO()
    figure.savefig(packed, format="png", dpi=120)
    return packed.getvalue()
