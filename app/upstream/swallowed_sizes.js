// A part whose size changes asks for a new layout, unless one that holds it is looked at first: that one takes over the
// sizes of all it holds, and says that nothing has changed where its own size has not. The figure beside a text that
// grew then stayed as high as it was, over the edge of its card. Here a part has changed when one it holds has.
//
// Written for: Bokeh 3.9.2
// Upstream: none found, searched 2026-11-23
// Needless when: tests/browser/test_as_shipped.py::test_every_wish_is_a_pass_over_hidden_parts_too_and_a_size_that_changes_within_is_swallowed fails
const { LayoutDOMView } = Bokeh.require("models/layouts/layout_dom")
LayoutDOMView.prototype.update_bbox = function () {
  let within = false
  for (const child of this.layoutable_views) {
    const { width, height } = child.bbox
    child.update_bbox()
    within ||= child.bbox.width !== width || child.bbox.height !== height || Boolean(child.changed_within)
  }
  this.changed_within = within
  const changed = this._update_bbox()
  if (this.layout != null) this.layout.visible = this.is_displayed
  return changed || within
}
