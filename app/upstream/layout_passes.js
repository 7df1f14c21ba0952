// Every size that changes has Bokeh measure every element of the document anew, pages out of sight included, and ask
// the browser to lay out in between: a tab turned among eight opened pages took two to six seconds. Here layout runs
// once a frame, and only over what is shown. A dashboard that mounts only the page in view hardly needs it.
//
// Written for: Bokeh 3.9.2
// Upstream: bokeh/bokeh#9515 (closed), bokeh/bokeh#15205 (merged: tabs, not hidden columns)
// Needless when: tests/browser/test_as_shipped.py::test_every_wish_is_a_pass_over_hidden_parts_too_and_a_size_that_changes_within_is_swallowed fails
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
