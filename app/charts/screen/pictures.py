"""Pictures in decibels as plain HTML: one image a strategy, all at one scale, each with its words."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from html import escape

import numpy as np
from bokeh.palettes import Viridis256
from numpy.typing import NDArray
from PIL import Image

from app.charts.kinds import FLOOR_DB, PictureChart

_PALETTE = bytes.fromhex("".join(colour[1:] for colour in Viridis256))


def picture_gallery(chart: PictureChart) -> str:
    """The images of a chart with the scale they share."""
    return gallery(chart.power_db, chart.names, chart.captions, chart.axes, chart.reference)


def gallery(
    power_db: NDArray[np.float64], titles: Sequence[str], captions: Sequence[str], axes: str, reference: str
) -> str:
    """Images (k, y, x) [dB] side by side from `FLOOR_DB` to 0 dB, y upwards, and the scale they share."""
    figures = "".join(
        f'<figure class="pic"><img src="{_source(image)}" alt="{escape(f"{title}: {caption}; {axes}", quote=True)}">'
        f"<figcaption><b>{escape(title)}</b><br>{escape(caption)}</figcaption></figure>"
        for image, title, caption in zip(power_db, titles, captions, strict=True)
    )
    ramp = _source(np.linspace(FLOOR_DB, 0, 160)[None, :])
    scale = (
        f'<div class="scale"><span class="num">−{-FLOOR_DB:.0f} dB</span><img src="{ramp}" alt="colour scale">'
        f'<span class="num">0 dB</span><span class="quiet">{escape(reference)}; {escape(axes)}</span></div>'
    )
    return f'{scale}<div class="pics">{figures}</div>'


def _source(power_db: NDArray[np.float64]) -> str:
    level = np.clip((power_db - FLOOR_DB) / -FLOOR_DB, 0, 1) * 255
    image = Image.fromarray(level[::-1].astype(np.uint8)).convert("P")
    image.putpalette(_PALETTE)
    data = io.BytesIO()
    image.save(data, "png")
    return f"data:image/png;base64,{base64.b64encode(data.getvalue()).decode('ascii')}"
