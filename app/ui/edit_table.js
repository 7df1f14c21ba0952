// Rows of inputs, and one empty row at the end to go on in. The browser keeps what is typed; the server is told all
// rows once a changed one is left, and answers with an error, or with the rows as it understood them.
export function render({ model }) {
  const place = document.createElement("div")
  place.className = "scroll tall"
  const make = (tag, text = "", more = {}) => Object.assign(document.createElement(tag), { textContent: text }, more)
  const wrong = make("p", "", { className: "wrong" })
  wrong.setAttribute("role", "alert")
  const width = () => model.columns.length
  const empty = () => Array(width()).fill("")
  const full = (row) => row.some((cell) => cell.trim())
  const filled = () => rows.filter(full)
  let rows = model.rows.map((row) => [...row])
  let changed = false, drawing = false
  const send = () => { changed = false; model.send_msg({ rows: filled() }) }
  const paste = (event, r, c) => {
    const text = event.clipboardData?.getData("text") ?? ""
    if (!/[\t\n]/.test(text.trim())) return
    event.preventDefault()
    text.trim().split(/\r?\n/).forEach((line, down) => {
      while (rows.length <= r + down) rows.push(empty())
      line.split("\t").slice(0, width() - c).forEach((cell, right) => { rows[r + down][c + right] = cell.trim() })
    })
    draw(`${r} ${c}`)
    send()
  }
  const button = (text, label, action) => {
    const made = make("button", text, { type: "button", title: label, onclick: action })
    made.setAttribute("aria-label", label)
    return made
  }
  const draw = (focus) => {
    const at = place.getRootNode().activeElement
    const focused = focus ?? at?.dataset?.cell, from = at?.selectionStart
    const table = make("table", "", { className: "checks" })
    table.createCaption().textContent = model.caption
    const heads = table.createTHead().insertRow()
    for (const name of ["", ...model.columns]) heads.append(make("th", name, { scope: "col" }))
    heads.append(make("td"))
    const body = table.createTBody()
    if (!rows.length || full(rows.at(-1))) rows.push(empty())
    rows.forEach((row, r) => {
      const line = body.insertRow()
      line.addEventListener("focusout", (event) => { if (changed && !drawing && !line.contains(event.relatedTarget)) send() })
      line.append(make("th", `${r + 1}`, { scope: "row" }))
      row.forEach((text, c) => {
        const field = make("input", "", { type: "text", value: text, maxLength: 200 })
        field.setAttribute("aria-label", `${model.columns[c]}, row ${r + 1}`)
        field.dataset.cell = `${r} ${c}`
        field.oninput = () => {
          rows[r][c] = field.value
          changed = true
          if (r === rows.length - 1) draw()
        }
        field.onkeydown = (event) => { if (event.key === "Enter" && changed) send() }
        field.onpaste = (event) => paste(event, r, c)
        const cell = make("td")
        cell.append(field)
        line.append(cell)
      })
      const tools = make("td", "", { className: "nw" })
      if (r < rows.length - 1) {
        tools.append(
          button("+", `Insert a row above row ${r + 1}`, () => { rows.splice(r, 0, empty()); draw(`${r} 0`) }),
          button("×", `Remove row ${r + 1}`, () => { rows.splice(r, 1); draw(`${r} 0`); send() }))
      }
      line.append(tools)
    })
    drawing = true  // what has the focus goes, but nobody leaves its row
    place.replaceChildren(table, wrong)
    drawing = false
    const field = [...place.querySelectorAll("input")].find((input) => input.dataset.cell === focused)
    field?.focus()
    if (field && from != null && focus === undefined) field.setSelectionRange?.(from, from)
  }
  model.on("rows", () => {
    if (JSON.stringify(filled()) === JSON.stringify(model.rows)) return
    rows = model.rows.map((row) => [...row])
    draw()
  })
  const tell = () => { wrong.textContent = model.error }
  model.on("error", tell)
  draw()
  tell()
  return place
}
