"""Charts as plain data (`kinds`), drawn by Bokeh on `screen` and by Matplotlib for `print`."""
