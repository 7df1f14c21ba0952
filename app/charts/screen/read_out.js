// The curves of every chart at the time under the pointer, at the top of each frame, in as many lines as its width needs.
const {x} = curves.data
const LETTER = 5.8  // px
const lines_of = (parts, width) => parts.reduce((told, part) => {
  const line = told.length - told.lastIndexOf("\n") + part.length + 3
  return told + (line * LETTER > width ? "\n" : "   ") + part
})
const show = (at) => charts.forEach(({lines, unit}, i) => {
  const {x_range, y_range} = plots[i], shown = at === null ? NaN : lines
    .map(([label, column]) => [label, curves.data[column][at]])
    .filter(([, y]) => isFinite(y))
    .map(([label, y]) => `${label} ${Number(y.toPrecision(3))} ${axes[i].axis_label.match(/\[([^\]]*)\]$/)[1]}`)
  const parts = at === null ? [""] : [`${Number(x[at].toPrecision(3))} ${unit}`, ...shown]
  const text = lines_of(parts, plots[i].inner_width).replaceAll("-", "−")
  sources[i].data = {x: [x_range.start], y: [y_range.end], text: [text]}
})
if (cb_obj.event_name === "mouseleave") return show(null)
let at = 0
for (let i = 1; i < x.length; i++) if (Math.abs(x[i] - cb_obj.x) < Math.abs(x[at] - cb_obj.x)) at = i
show(at)
