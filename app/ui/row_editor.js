// Rows to fill in. A row that lacks something it needs is begun: it stays here until it is whole. What is typed while
// the rows change stays typed, and so does what was refused. A row in force goes when its removal is taken.
export function render({ model }) {
  const place = document.createElement("div")
  const table = document.createElement("table"), said = document.createElement("p")
  const make = (tag, text = "", more = {}) => Object.assign(document.createElement(tag), { textContent: text, ...more })
  const whole = (row) => model.columns.every(({ key, needed }) => !needed || row[key]?.trim())
  let rows = []
  const inForce = (row) => model.rows.some((each) => model.columns.every(({ key }) => (each[key] ?? "") === (row[key] ?? "")))
  const tell = (told = rows) => {
    const missing = told.some((row) => !whole(row) && !row.begun)
    const needed = model.columns.filter((column) => column.needed).map(({ label }) => label.toLowerCase())
    said.textContent = missing ? `Each row needs ${needed.join(" and ")}.` : model.refused
    if (!missing) model.send_msg({ rows: told.filter(whole) })
  }
  // Rows copied from a spreadsheet, into a table whose rows have an order and only boxes.
  const paste = (event, row, key) => {
    const text = (event.clipboardData?.getData("text") ?? "").trim()
    if (!model.ordered || !/[\t\n]/.test(text)) return
    event.preventDefault()
    const keys = model.columns.map((column) => column.key), from = keys.indexOf(key), first = rows.indexOf(row)
    text.split(/\r?\n/).forEach((line, down) => {
      const into = (rows[first + down] ??= {})
      line.split("\t").slice(0, keys.length - from).forEach((cell, right) => { into[keys[from + right]] = cell.trim() })
    })
    draw()
    tell()
  }
  const boxOf = (row, { key, label, example, choices }, index) => {
    const box = choices.length ? make("select") : make("input", "", { type: "text", maxLength: 300, placeholder: example })
    if (choices.length) box.append(...choices.map(([value, text]) => new Option(text, value)))
    const known = (value) => choices.some(([each]) => each === value)
    box.value = choices.length && !known(row[key]) ? choices[0][0] : row[key] ?? ""
    row[key] = box.value
    box.dataset.place = `${index} ${key}`
    box.dataset.says = `${label}:`
    box.oninput = () => { row[key] = box.value; nameAll() }
    box.onchange = () => tell()
    box.onpaste = (event) => paste(event, row, key)
    return box
  }
  // Every control is named after its row: by the number where rows have an order, or by what is in its first cell.
  const nameAll = () => [...table.tBodies[0].rows].forEach((line, index) => {
    const name = !model.ordered && rows[index][model.columns[0].key] || `row ${index + 1}`
    for (const each of line.querySelectorAll("[data-says]")) each.setAttribute("aria-label", each.title = `${each.dataset.says} ${name}`)
  })
  const draw = (focus) => {
    const at = place.getRootNode().activeElement, focused = focus ?? at?.dataset?.place, from = at?.selectionStart
    table.replaceChildren()
    table.createCaption().textContent = model.caption
    const heads = table.createTHead().insertRow(), body = table.createTBody()
    for (const { label, read } of model.columns) heads.append(make("th", label, { scope: "col", className: read ? "num" : "" }))
    if (model.noun) heads.append(make("td"))
    heads.cells[0].className = ""
    if (model.ordered) heads.prepend(make("td"))
    rows.forEach((row, index) => {
      const line = body.insertRow()
      if (model.ordered) line.append(make("td", index + 1, { className: "num" }))
      for (const column of model.columns) {
        if (column.read) line.append(column === model.columns[0] ? make("th", row[column.key], { scope: "row" }) : make("td", row[column.key], { className: "num" }))
        else line.insertCell().append(boxOf(row, column, index))
      }
      if (!model.noun) return
      const tools = line.insertCell(), tool = (text, says, onclick) => {
        const made = make("button", text, { type: "button", onclick })
        made.dataset.says = says
        tools.append(made)
      }
      if (model.ordered) tool("+", "Insert above", () => begin(index))
      tool(model.ordered ? "✕" : "Remove", "Remove", () => {
        const left = rows.filter((each) => each !== row)
        if (!inForce(row)) {
          rows = left
          draw()
        }
        add.focus()
        tell(left)
      })
    })
    nameAll()
    table.tHead.hidden = !rows.length
    const box = [...table.querySelectorAll("input, select")].find(({ dataset }) => dataset.place === focused)
    box?.focus({ preventScroll: true })
    if (box && from != null) box.setSelectionRange?.(from, from)
  }
  const add = make("button", `Add ${model.noun}`, { type: "button", hidden: !model.noun })
  const begin = (index) => {
    rows.splice(index, 0, { begun: true })
    draw(`${index} ${model.columns.find(({ read }) => !read).key}`)
  }
  add.onclick = () => begin(rows.length)
  const take = () => {
    const typed = place.getRootNode().activeElement?.dataset?.place?.split(" "), row = typed && rows[typed[0]]
    const next = model.rows.map((each) => ({ ...each }))
    rows.forEach((each, index) => { if (each.begun && !whole(each)) next.splice(index, 0, each) })
    if (typed && row && !row.begun && next[typed[0]]) next[typed[0]][typed[1]] = row[typed[1]]
    rows = next
    draw()
  }
  const refuse = () => { said.textContent = model.refused }
  said.className = "refused"
  said.setAttribute("role", "alert")
  table.className = "checks"
  const scroll = make("div", "", { className: model.ordered ? "scroll tall" : "scroll", tabIndex: 0 })
  scroll.setAttribute("role", "region")
  scroll.setAttribute("aria-label", model.caption)
  scroll.append(table)
  place.append(scroll, said, add)
  for (const property of ["rows", "caption", "columns"]) model.on(property, take)
  model.on("refused", refuse)
  take()
  refuse()
  return place
}
