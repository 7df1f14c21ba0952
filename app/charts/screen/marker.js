// One place of the flight on charts and map: the nearest in time under a chart's pointer, the nearest on the map.
const {t, x, y} = way.data
if (cb_obj.event_name === "mouseleave") {
  here.data = {x: [NaN], y: [NaN]}
  for (const rule of rules) rule.visible = false
} else {
  const far = (i) => map ? Math.hypot(x[i] - cb_obj.x, y[i] - cb_obj.y) : Math.abs(t[i] - cb_obj.x)
  let at = 0
  for (let i = 1; i < t.length; i++) if (far(i) < far(at)) at = i
  here.data = {x: [x[at]], y: [y[at]]}
  for (const rule of rules) Object.assign(rule, {location: t[at], visible: map})
}
