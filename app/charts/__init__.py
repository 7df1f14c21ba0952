"""Charts, told once as plain data (`kinds`) and drawn twice: by Bokeh on `screen`, by Matplotlib for `print`."""
