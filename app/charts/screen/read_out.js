// The curves of every chart at the time under the pointer, in one line above each frame: the time above the first one.
// A name that begins like the one before is shortened ("horizontal 1 m, real time 3 m"), and the unit is told once.
const {x} = curves.data
const show = (at) => charts.forEach(({lines, unit}, i) => {
  const {x_range, y_range} = plots[i], parts = []
  let before = null
  for (const [label, column] of at === null ? [] : lines) {
    const value = curves.data[column][at]
    if (!isFinite(value)) continue
    const first = label.split(", ")[0]
    parts.push(`${before === first ? ", " + label.slice(first.length + 2) : "   " + label} ${Number(value.toPrecision(3))}`)
    before = first
  }
  const time = at === null || i ? "" : `${Number(x[at].toPrecision(3))} ${unit}   `
  const text = time + (parts.length ? `${parts.join("").trim()} ${axes[i].axis_label.match(/\[([^\]]*)\]$/)[1]}` : "")
  sources[i].data = {x: [x_range.start], y: [y_range.end], text: [text.replaceAll("-", "−")]}
})
if (cb_obj.event_name === "mouseleave") return show(null)
let at = 0
for (let i = 1; i < x.length; i++) if (Math.abs(x[i] - cb_obj.x) < Math.abs(x[at] - cb_obj.x)) at = i
show(at)
