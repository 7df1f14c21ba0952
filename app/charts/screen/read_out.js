// The curves of every chart at the time under the pointer, above each frame, in one row or two; the time above the first.
// A name that begins like the one before is shortened ("horizontal 1, real time 3"), and the unit is told once.
const {x} = curves.data
const show = (at) => charts.forEach(({lines, unit, rows, clock: inMinutes}, i) => {
  const {x_range, y_range} = plots[i], [, of_axis] = axes[i].axis_label.match(/\[([^\]]*)\]$/)
  let text = at === null || i ? "" : `${inMinutes ? clock(x[at]) : `${Number(x[at].toPrecision(3))} ${unit}`}   `, before = ""
  for (const [label, column] of at === null ? [] : lines) {
    const value = curves.data[column][at], [name, ...rest] = label.split(", ")
    if (!isFinite(value)) continue
    text += `${name !== before ? (before && (rows > 1 ? "\n" : "   ")) + label : ", " + rest.join(", ")} ${Number(value.toPrecision(3))}`
    before = name
  }
  if (before) text += ` ${of_axis}`
  sources[i].data = {x: [x_range.start], y: [y_range.end], text: [text.replaceAll("-", "−")]}
})
if (cb_obj.event_name === "mouseleave") return show(null)
let at = 0
for (let i = 1; i < x.length; i++) if (Math.abs(x[i] - cb_obj.x) < Math.abs(x[at] - cb_obj.x)) at = i
show(at)
