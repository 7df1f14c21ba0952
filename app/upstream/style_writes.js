// Every paint of a figure writes the sheets that place its parts, mostly with the same text, and the browser works out
// the styles of the whole page again: 26 sheets for one figure. Here a sheet is written when its text changes.
//
// Written for: Bokeh 3.9.2
// Upstream: bokeh/bokeh#15286 (open), on the styles that are read in between
// Needless when: tests/browser/test_as_shipped.py::test_a_sheet_is_written_again_with_the_same_text_and_a_paint_asks_for_computed_styles fails
const { InlineStyleSheet } = Bokeh.require("core/dom")
InlineStyleSheet.prototype._update = function (css) {
  if (this.written === css) return
  this.written = css
  this.el.textContent = css
}
