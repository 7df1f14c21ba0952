"""Bokeh's layout, once a frame and only of what is shown.

As shipped (3.9), every size that changes measures every element of the document anew, pages out of sight included,
and asks the browser to lay out in between: a tab turned among eight opened pages took two to six seconds.
"""

from __future__ import annotations

from panel.custom import JSComponent


class LayoutPasses(JSComponent):
    """Invisible; must stand on the page once, outside what is hidden."""

    _esm = """
    export function render({ view }) {
      let root = view
      while (root.parent) root = root.parent
      let base = Object.getPrototypeOf(root)
      while (base && !Object.hasOwn(base, "layoutable_views")) base = Object.getPrototypeOf(base)
      if (base && !window.layout_passes) {
        window.layout_passes = true
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
      return document.createElement("span")
    }
    """
