"""A page of the shipped libraries, with nothing of this product on it: a program of its own, which tells its port."""

import panel as pn
import panel_material_ui as pmui
from bokeh.plotting import figure


def page() -> pmui.Page:
    plot = figure(height=200, width=300)
    plot.line([1, 2, 3], [1, 2, 3])
    return pmui.Page(
        title="as shipped",
        main=[
            pn.Column(
                pn.pane.HTML('<a href="#there">there</a>'),
                pmui.Select(label="choice", options=["a", "b"]),
                pn.pane.Bokeh(plot),
                pn.Column(pn.pane.HTML("hidden"), visible=False),
                pn.Column(pn.Spacer(height=3000), name="tall"),
                sizing_mode="stretch_width",
            )
        ],
    )


if __name__ == "__main__":
    server = pn.serve({"/": page}, address="127.0.0.1", port=0, show=False, start=False, verbose=False)
    print(server.port, flush=True)
    server.start()
    server.io_loop.start()
