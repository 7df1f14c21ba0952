// Every size that changes has Bokeh measure every element of the document anew, pages out of sight included, and ask
// the browser to lay out in between: a tab turned among eight opened pages took two to six seconds. Here layout runs
// once a frame, and only over what is shown. A dashboard that mounts only the page in view hardly needs it.
//
// Report to send upstream, version and end: docs/upstream/layout_passes.md
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
