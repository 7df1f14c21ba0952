"""Charts as Bokeh figures."""
