// How sizes go through the parts of a page.
//
// Reports to send upstream, versions and ends: docs/upstream/layouts.md

const { LayoutDOMView } = Bokeh.require("models/layouts/layout_dom")

// A part whose size changes asks for a new layout, unless one that holds it is looked at first: that one takes over the
// sizes of all it holds, and says that nothing has changed where its own size has not. The figure beside a text that
// grew then stayed as high as it was, over the edge of its card. Here a part has changed when one it holds has.
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

// A figure is given its size by the layout of the column it stands in. Below two columns that hold figures Bokeh passes
// the next one over, with all that it holds: a chart that was unfolded under such a page stayed blank, the names of
// its axes on one heap. Here none is passed over.
LayoutDOMView.prototype._propagate_layout = function () {
  for (const child of this.layoutable_views) child.layout == null ? child._compute_layout() : child._propagate_layout()
}

// Every size that changes has Bokeh measure every element of the document anew, pages out of sight included, and ask
// the browser to lay out in between: a tab turned among eight opened pages took two to six seconds. Here layout runs
// once a frame, and only over what is shown.
let root = view
while (root.parent) root = root.parent
let base = Object.getPrototypeOf(root)
while (base && !Object.hasOwn(base, "layoutable_views")) base = Object.getPrototypeOf(base)
if (base) {
  const all = Object.getOwnPropertyDescriptor(base, "layoutable_views").get
  // What becomes visible again is laid out then: Bokeh invalidates the layout at that change.
  Object.defineProperty(base, "layoutable_views", {
    configurable: true,
    get() { return all.call(this).filter((child) => child.model.visible) },
  })
  const compute = root.compute_layout.bind(root)
  let asked = false
  const now = () => { asked = false; compute() }
  root.compute_layout = () => {
    if (asked) return
    asked = true
    document.hidden ? setTimeout(now, 50) : requestAnimationFrame(now)
  }
}
