"""Pictures to take away: the numbers as NPZ or CSV, and all of them with axes and scale as one PNG."""

from __future__ import annotations

import io
from collections.abc import Sequence

import numpy as np
import panel as pn
import panel_material_ui as pmui

from app.charts.pictures_in_print import to_png
from app.workers import elsewhere
from nav_model.sar.pictures import Pictures, pictures_arrays, pictures_csv


class PictureDownloads:
    """A row of links under pictures; hidden while there are none."""

    def __init__(self, title: str, key: str, names: Sequence[str]) -> None:
        self._names = names
        self._pictures: Pictures | None = None
        look = {"description": "", "variant": "text", "size": "small", "margin": (0, 8), "icon": "download"}
        self.view = pn.FlexBox(
            *(
                pmui.FileDownload(
                    callback=make,
                    filename=f"{key}.{suffix}",
                    label=f"{title.partition(',')[0].partition(':')[0]}: {what}",
                    **look,
                )
                for make, suffix, what in (
                    (self._npz, "npz", "data (NPZ)"),
                    (self._csv, "csv", "data (CSV)"),
                    (self._png, "png", "picture (PNG)"),
                )
            ),
            visible=False,
            sizing_mode="stretch_width",
            margin=(0, 4),
        )

    def show(self, pictures: Pictures) -> None:
        """Offer these."""
        self._pictures = pictures
        self.view.visible = True

    def hide(self) -> None:
        """Offer nothing."""
        self._pictures = None
        self.view.visible = False

    def _shown(self) -> Pictures:
        assert self._pictures is not None
        return self._pictures

    def _npz(self) -> io.BytesIO:
        packed = io.BytesIO()
        np.savez_compressed(packed, **pictures_arrays(self._shown(), self._names))  # type: ignore[arg-type]
        packed.seek(0)
        return packed

    async def _csv(self) -> io.BytesIO:
        return io.BytesIO((await elsewhere(pictures_csv, self._shown(), self._names)).encode("utf-8"))

    async def _png(self) -> io.BytesIO:
        return io.BytesIO(await elsewhere(to_png, self._shown(), self._names))
