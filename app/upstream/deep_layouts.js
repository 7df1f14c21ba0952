// A layout is handed down to what has none of its own through one level only: where a part that has a layout holds
// another such part, what that one holds was left out. A figure unfolded below the first screen then had no width.
//
// Written for: Bokeh 3.9.2
// Upstream: none found, searched 2026-11-23
// Needless when: tests/browser/test_as_shipped.py::test_a_layout_stops_at_the_second_level fails
const { LayoutDOMView } = Bokeh.require("models/layouts/layout_dom")
LayoutDOMView.prototype._propagate_layout = function () {
  for (const child of this.layoutable_views) {
    if (child.layout == null) child._compute_layout()
    else child._propagate_layout()
  }
}
