// A figure is given its size by the layout of the column it stands in. Below two columns that hold figures Bokeh passes
// the next one over, with all that it holds: a chart that was unfolded under such a page stayed blank, the names of
// its axes on one heap. Here none is passed over.
//
// Written for: Bokeh 3.9.2
// Upstream: bokeh/bokeh#12612 (merged: one level, not those below)
// Needless when: tests/browser/test_as_shipped.py::test_what_stands_deeper_is_given_no_size_and_ours_is fails
const { LayoutDOMView } = Bokeh.require("models/layouts/layout_dom")
LayoutDOMView.prototype._propagate_layout = function () {
  for (const child of this.layoutable_views) child.layout == null ? child._compute_layout() : child._propagate_layout()
}
