"""The smallest page of the same framework that a slider moves: what the product's figures are held against.

python benchmarks/bare_page.py      # prints its address and serves until it is stopped
"""

import signal
import socket
import sys
from typing import Any

import numpy as np
import panel as pn
import panel_material_ui as pmui
from bokeh.models import ColumnDataSource
from bokeh.plotting import figure

SLIDER, DATA = "bare", ("bare 0", "bare 1", "bare 2")


def page() -> pmui.Page:
    """Three curves of 300 points, a line of text and the slider that all of them follow."""
    time = np.linspace(0.0, 100.0, 300)
    sources = [ColumnDataSource({"x": time, "y": np.ones_like(time)}, name=name) for name in DATA]
    charts = [figure(height=260, sizing_mode="stretch_width") for _ in sources]
    for chart, source in zip(charts, sources, strict=True):
        chart.line("x", "y", source=source)
    slider = pmui.FloatSlider(label=SLIDER, name=SLIDER, show_value=False, start=-5, end=5, step=0.02, value=1)
    text = pn.pane.HTML("moved 1")

    def follow(event: Any) -> None:
        with pn.io.hold():
            for number, source in enumerate(sources, 1):
                source.data = {"x": time, "y": np.exp(-time / 50 * number) * event.new}
            text.object = f"moved {event.new!r}"

    slider.param.watch(follow, "value")
    return pmui.Page(title="bare", sidebar=[slider], main=[text, *(pn.pane.Bokeh(chart) for chart in charts)])


def main() -> None:
    """Serve until stopped."""
    pn.extension()
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    server = pn.serve({"/": page}, port=port, address="127.0.0.1", show=False, start=False, verbose=False)
    print(f"bare page on http://127.0.0.1:{port}", flush=True)
    server.start()
    server.io_loop.start()


if __name__ == "__main__":
    main()
