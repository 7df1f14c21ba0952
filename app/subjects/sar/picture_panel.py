"""Pictures on the page: all at one scale, and to take away as numbers (NPZ, CSV) or as they print (SVG)."""

import io
from html import escape

import numpy as np
import panel as pn
import param

from app.charts.kinds import PictureChart
from app.charts.print.svg import to_svg
from app.charts.screen.pictures import picture_gallery
from app.declared import optional
from app.ui.downloads import download
from app.ui.html_pane import html_pane
from app.ui.view import View
from app.work.pool import run_in_pool


class PicturePanel(View):
    """The pictures of one chart under its title, with links; nothing while there is none."""

    chart = optional(PictureChart, "What is shown; None: nothing yet.")
    stale = param.String(default="", doc="Mark beside the title, as HTML.")

    def __init__(self, title: str, key: str, *, pair: bool = False) -> None:
        """Title and key are those of the links and their files; a `pair` is shown large."""
        super().__init__()
        self._pair = pair
        # Heading and pictures apart: the mark of a stale study must not send the pictures again.
        self._heading, self._pictures = html_pane("", margin=(8, 10, 0, 10)), html_pane("")
        self.links = pn.FlexBox(
            download(f"{title}: NPZ", f"{key}.npz", self._npz),
            download(f"{title}: CSV", f"{key}.csv", lambda: run_in_pool(pictures_csv, self._shown())),
            download(f"{title}: SVG", f"{key}.svg", lambda: run_in_pool(to_svg, self._shown())),
        )
        self._view = pn.Column(self._heading, self._pictures, self.links, visible=self.param.chart.rx.is_not(None))

    @param.depends("chart", "stale", watch=True)
    def _head(self) -> None:
        if self.chart is not None:
            self._heading.object = f"<h3>{escape(self.chart.title)}</h3>{self.stale}"

    @param.depends("chart", watch=True)
    def _draw(self) -> None:
        if self.chart is not None:
            gallery = picture_gallery(self.chart)
            self._pictures.object = f'<div class="pair">{gallery}</div>' if self._pair else gallery

    def _shown(self) -> PictureChart:
        assert self.chart is not None  # the links are hidden without one
        return self.chart

    def _npz(self) -> bytes:
        chart, packed = self._shown(), io.BytesIO()
        np.savez_compressed(packed, names=np.array(chart.names), x_m=chart.x, y_m=chart.y, power_db=chart.power_db)
        return packed.getvalue()


def pictures_csv(chart: PictureChart) -> str:
    """The pictures as a table, a pixel a line and a column a picture."""
    y, x = np.meshgrid(chart.y, chart.x, indexing="ij")
    table = np.column_stack([x.ravel(), y.ravel(), *(power.ravel() for power in chart.power_db)])
    head = ",".join([chart.x_label, chart.y_label, *(f'"{name} [dB]"' for name in chart.names)])
    text = io.StringIO()
    np.savetxt(text, table, fmt="%.5g", delimiter=",", header=head, comments="")
    return text.getvalue()
