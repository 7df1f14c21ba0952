// A part whose size changes asks for a new layout, unless one that holds it is looked at first: that one takes over the
// sizes of all it holds, and says that nothing has changed where its own size has not. The figure beside a text that
// grew then stayed as high as it was, over the edge of its card. Here a part has changed when one it holds has.
//
// Report to send upstream, version and end: docs/upstream/swallowed_sizes.md
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
