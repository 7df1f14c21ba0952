// Each line and word that is painted asks whether a style sheet gives its colour, some 250 times for a figure, and the
// styles of the page are worked out for it: with the sheets written in between, half of a slider's step. Here colours
// come from the figure alone.
//
// Written for: Bokeh 3.9.2
// Upstream: bokeh/bokeh#15286 (open), bokeh/bokeh#15205 (merged: fewer, not none)
// Needless when: tests/browser/test_as_shipped.py::test_a_sheet_is_written_again_with_the_same_text_and_a_paint_asks_for_computed_styles fails
const { VisualProperties } = Bokeh.require("core/visuals/visual")
VisualProperties.prototype._get_css_value = () => ""
