// A figure is given its size by the layout of the column it stands in. Below two columns that hold figures Bokeh passes
// the next one over, with all that it holds: a chart that was unfolded under such a page stayed blank, the names of
// its axes on one heap. Here none is passed over.
//
// Report to send upstream, version and end: docs/upstream/skipped_layouts.md
const { LayoutDOMView } = Bokeh.require("models/layouts/layout_dom")
LayoutDOMView.prototype._propagate_layout = function () {
  for (const child of this.layoutable_views) child.layout == null ? child._compute_layout() : child._propagate_layout()
}
