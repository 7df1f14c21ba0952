// Every paint of a figure writes the sheets that place its parts, mostly with the same text, and the browser works out
// the styles of the whole page again: 26 sheets for one figure. Here a sheet is written when its text changes.
//
// Report to send upstream, version and end: docs/upstream/style_writes.md
const { InlineStyleSheet } = Bokeh.require("core/dom")
InlineStyleSheet.prototype._update = function (css) {
  if (this.written === css) return
  this.written = css
  this.el.textContent = css
}
