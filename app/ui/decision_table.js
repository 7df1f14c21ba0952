// Rows to decide on. What is sent says which decision was in view, so that nobody's is replaced unseen; a row that is
// being edited keeps its text and the focus when others change the table, its text also when they decide it first.
export function render({ model }) {
  const place = document.createElement("div")
  place.className = "scroll"
  // Row key -> {accepted, reason} being written, or sent; without accepted a decided row is opened again, or, with
  // `late`, was decided by somebody else while the reason was written.
  const editing = new Map()
  const make = (tag, text = "", more = {}) => Object.assign(document.createElement(tag), { textContent: text }, more)
  const key = (row) => `${row.place} ${row.name}`
  const send = (row, accepted, reason) => {
    model.send_msg({ do: "decide", place: row.place, name: row.name, seen: row.seen, accepted, reason })
  }
  const button = (text, row, action, main = false) => {
    const made = make("button", text, { type: "button", className: main ? "main" : "", onclick: action })
    made.setAttribute("aria-label", `${text}: ${row.label}`)
    return made
  }
  const edit = (row, state) => { editing.set(key(row), { ...state, seen: row.seen }); draw(key(row)) }
  const actions = (row, reason) => {
    const cell = make("td"), state = editing.get(key(row))
    cell.className = "act"
    if (!model.open) return cell
    if (state && state.accepted !== undefined) {
      const say = state.accepted ? "Accept with a waiver" : "Reject"
      const field = make("input", "", { type: "text", maxLength: 1000, value: state.reason ?? "" })
      field.placeholder = state.accepted ? "Not met: why is it accepted?" : "Why is it rejected?"
      field.setAttribute("aria-label", `Reason: ${row.label}`)
      field.dataset.row = key(row)
      field.oninput = () => { state.reason = field.value }
      const missing = make("span", "", { role: "alert" })
      const done = () => {
        if (field.value.trim()) return send(row, state.accepted, field.value)
        missing.textContent = "Enter a reason."
        field.focus()
      }
      field.onkeydown = (event) => {
        if (event.key === "Enter") done()
        if (event.key === "Escape") { editing.delete(key(row)); draw() }
      }
      reason.replaceChildren(field, missing)
      cell.append(button(say, row, done, true), button("Cancel", row, () => { editing.delete(key(row)); draw() }))
    } else if (row.seen && (!state || state.late)) {
      cell.append(button("Change", row, () => edit(row, { reason: state?.reason })))
      if (state) cell.append(make("p", `Your reason was not sent: ${state.reason}`, { className: "late", role: "status" }))
    } else {
      cell.append(
        button("Accept", row, () => row.met ? send(row, true, "") : edit(row, { ...state, accepted: true })),
        button("Reject", row, () => edit(row, { ...state, accepted: false })))
    }
    return cell
  }
  const draw = (focus) => {
    const at = place.getRootNode().activeElement
    const focused = focus ?? at?.dataset?.row, from = at?.selectionStart
    const table = make("table")
    table.className = "checks"
    table.createCaption().textContent = model.caption
    const heads = table.createTHead().insertRow()
    for (const name of ["Requirement", "Value", "Limit", "Verdict", "Decision", "Reason", model.open ? "Decide" : ""]) {
      if (name) heads.append(make("th", name, { scope: "col" }))
    }
    const body = table.createTBody()
    for (const row of model.rows) {
      const state = editing.get(key(row))
      if (state && state.seen !== row.seen) {  // decided: as written here, or by somebody else meanwhile
        const reason = (state.reason ?? "").trim()
        if (!reason || reason === row.reason) editing.delete(key(row))
        else editing.set(key(row), { reason, seen: row.seen, late: true })
      }
      const line = body.insertRow()
      line.append(make("th", row.label, { scope: "row" }))
      for (const text of [row.value, row.limit]) line.append(make("td", text, { className: "num" }))
      line.append(make("td", row.verdict, { className: `tone ${row.tone}` }))
      const reason = make("td", row.reason)
      line.append(make("td", row.decision), reason)
      if (model.open) line.append(actions(row, reason))
    }
    place.replaceChildren(table)
    const left = model.rows.filter((row) => !row.seen && row.met)
    if (model.open && left.length > 1) {
      const all = make("button", `Accept the ${left.length} that are met`, { type: "button", className: "all" })
      all.onclick = () => model.send_msg({ do: "accept", points: left.map((row) => [row.place, row.name]) })
      place.append(all)
    }
    const field = [...place.querySelectorAll("input")].find((input) => input.dataset.row === focused)
    field?.focus()
    if (field && from != null) field.setSelectionRange?.(from, from)
  }
  for (const property of ["rows", "open", "caption"]) model.on(property, () => draw())
  draw()
  place.tabIndex = 0
  place.setAttribute("role", "region")
  place.setAttribute("aria-label", "Requirements and decisions")
  return place
}
