"""A figure is painted without asking the browser to work out the styles of the whole page again and again."""

from __future__ import annotations

from panel.custom import JSComponent


class StyleWrites(JSComponent):
    """Invisible; has Bokeh write a style sheet only when it changes, and look for no colours in it.

    As shipped (3.9), every paint of a figure writes the sheets that place its parts, with the same text, and each
    line and word asks in between whether a sheet gives its colour: the styles of the page are worked out some forty
    times for one step of a slider, half of the time a step takes. Here colours come from the figure alone.
    """

    _esm = """
    const { InlineStyleSheet } = Bokeh.require("core/dom")
    const { VisualProperties } = Bokeh.require("core/visuals/visual")
    InlineStyleSheet.prototype._update = function (css) {
      if (this.written === css) return
      this.written = css
      this.el.textContent = css
    }
    VisualProperties.prototype._get_css_value = () => ""

    export function render() { return document.createElement("span") }
    """
