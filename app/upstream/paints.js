// What a paint of a figure costs: half of a slider's step in the browser.
//
// Reports to send upstream, versions and ends: docs/upstream/paints.md

// Every paint of a figure writes the sheets that place its parts, mostly with the same text, and the browser works out
// the styles of the whole page again: 26 sheets for one figure. Here a sheet is written when its text changes.
const { InlineStyleSheet } = Bokeh.require("core/dom")
InlineStyleSheet.prototype._update = function (css) {
  if (this.written === css) return
  this.written = css
  this.el.textContent = css
}

// Each line and word that is painted asks whether a style sheet gives its colour, some 250 times for a figure, and the
// styles of the page are worked out for it: with the sheets written in between, half of a slider's step. Here colours
// come from the figure alone.
const { VisualProperties } = Bokeh.require("core/visuals/visual")
VisualProperties.prototype._get_css_value = () => ""
