"""Charts, described once as plain data and drawn by two thin renderers.

- `description`: what a chart is made of.
- `budget`: the charts of a budget; `comparison`: of several side by side.
- `sensors`: Allan deviations of a log.
- `on_screen`: Bokeh, for pages and the HTML report.
- `in_print`: Matplotlib to SVG, for the PDF report.
"""
