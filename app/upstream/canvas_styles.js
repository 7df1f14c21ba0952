// Each line and word that is painted asks whether a style sheet gives its colour, some 250 times for a figure, and the
// styles of the page are worked out for it: with the sheets written in between, half of a slider's step. Here colours
// come from the figure alone.
//
// Report to send upstream, version and end: docs/upstream/canvas_styles.md
const { VisualProperties } = Bokeh.require("core/visuals/visual")
VisualProperties.prototype._get_css_value = () => ""
