"""Pictures to take away: the numbers as NPZ or CSV, and all of them with axes and scale as they print."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import panel as pn
import panel_material_ui as pmui

from app.charts.kinds import PictureChart
from app.charts.print.svg import to_svg
from app.work.pool import elsewhere


class PictureDownloads:
    """A row of links under pictures; hidden while there are none."""

    def __init__(self, title: str, key: str) -> None:
        self._chart: PictureChart | None = None
        look: dict[str, Any] = {"description": "", "variant": "text", "size": "small", "margin": (0, 8)}
        links = [
            pmui.FileDownload(
                callback=make, filename=f"{key}.{suffix}", label=f"{title}: {what}", icon="download", **look
            )
            for make, suffix, what in (
                (self._npz, "npz", "NPZ"),
                (self._csv, "csv", "CSV"),
                (self._svg, "svg", "SVG"),
            )
        ]
        self.view = pn.FlexBox(*links, visible=False, sizing_mode="stretch_width", margin=(0, 4))

    def show(self, chart: PictureChart) -> None:
        """Offer these."""
        self._chart = chart
        self.view.visible = True

    def hide(self) -> None:
        """Offer nothing."""
        self._chart = None
        self.view.visible = False

    def _shown(self) -> PictureChart:
        assert self._chart is not None
        return self._chart

    def _npz(self) -> io.BytesIO:
        chart, packed = self._shown(), io.BytesIO()
        np.savez_compressed(packed, names=np.array(chart.names), x_m=chart.x, y_m=chart.y, power_db=chart.power_db)
        packed.seek(0)
        return packed

    async def _csv(self) -> io.BytesIO:
        return io.BytesIO((await elsewhere(pictures_csv, self._shown())).encode("utf-8"))

    async def _svg(self) -> io.BytesIO:
        return io.BytesIO((await elsewhere(to_svg, self._shown())).encode("utf-8"))


def pictures_csv(chart: PictureChart) -> str:
    """The pictures as a table, a pixel a line and a column a picture."""
    y, x = np.meshgrid(chart.y, chart.x, indexing="ij")
    table = np.column_stack([x.ravel(), y.ravel(), *(power.ravel() for power in chart.power_db)])
    head = ",".join([chart.x_label, chart.y_label, *(f'"{name} [dB]"' for name in chart.names)])
    text = io.StringIO()
    np.savetxt(text, table, fmt="%.5g", delimiter=",", header=head, comments="")
    return text.getvalue()
