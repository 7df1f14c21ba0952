"""Pictures in decibels as plain HTML, on a page and in a report: all at one scale, each with its words."""

import base64
import io
from html import escape

import numpy as np
from bokeh.palettes import Viridis256
from PIL import Image

from app.charts.kinds import Array, PictureChart

_PALETTE = bytes.fromhex("".join(colour[1:] for colour in Viridis256))
_WEAKEST = -20.0  # dB: a point that is weaker at its peak is none to see


def picture_gallery(chart: PictureChart, row: bool = False) -> str:
    """The images of a chart beside each other, y upwards, and the scale they share; ``row``: in one row, in which
    those without a point to see have no place and are named below it."""
    axes, floor = chart.axes, chart.floor_db
    images = list(zip(chart.power_db, chart.names, chart.captions, strict=True))
    weak = [f"{name}, {caption}" for image, name, caption in images if row and image.max() < _WEAKEST]
    figures = "".join(
        f'<figure class="pic"><img src="{_source(image, floor)}" alt="{escape(f"{name}: {caption}; {axes}")}">'
        f"<figcaption><b>{escape(name)}</b><br>{escape(caption)}</figcaption></figure>"
        for image, name, caption in images
        if not row or image.max() >= _WEAKEST
    )
    ramp = _source(np.linspace(floor, 0, 160)[None, :], floor)
    scale = (
        f'<div class="scale"><span class="num">−{-floor:.0f} dB</span><img src="{ramp}" alt="colour scale">'
        f'<span class="num">0 dB</span><span class="quiet">{escape(chart.reference)}; {escape(axes)}</span></div>'
    )
    without = f'<p class="know quiet">No point to see: {escape("; ".join(weak))}.</p>' if weak else ""
    return f'{scale}<div class="pics{" row" if row else ""}">{figures}</div>{without}'


def _source(power_db: Array, floor_db: float) -> str:
    level = np.clip((power_db - floor_db) / -floor_db, 0, 1) * 255
    image = Image.fromarray(level[::-1].astype(np.uint8)).convert("P")
    image.putpalette(_PALETTE)
    data = io.BytesIO()
    image.save(data, "png")
    return f"data:image/png;base64,{base64.b64encode(data.getvalue()).decode('ascii')}"
