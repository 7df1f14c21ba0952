// Rows of inputs. The server says what each row shows; what a person does is told as a message, the next one when the
// last has been answered: a slider that is dragged is followed as fast as the server can, and the newest place wins.
export function render({ model }) {
  const place = document.createElement("div")
  const make = (tag, more = {}, ...inside) => {
    const made = Object.assign(document.createElement(tag), more)
    made.append(...inside)
    return made
  }
  const rows = new Map()  // key -> what is known of a row, and its elements

  // --- what is told ---
  const waiting = new Map()  // the newest of what has not been told, by row and kind
  let sent = model.heard, asked = null  // the row whose message has not been answered
  const send = () => {
    const [[slot, what]] = waiting
    waiting.delete(slot)
    asked = what.key
    sent += 1
    model.send_msg({ ...what, number: sent })
  }
  const next = () => { if (model.heard >= sent && waiting.size) send() }
  place.addEventListener("focusout", () => { while (waiting.size) send() })  // before what is done elsewhere, as Reset
  const tell = (key, kind, what) => {
    waiting.delete(`${key} ${kind}`)
    waiting.set(`${key} ${kind}`, { key, [kind]: what })
    next()
  }
  const underWay = (key) => asked === key || ["text", "place", "unit"].some((kind) => waiting.has(`${key} ${kind}`))

  // --- amounts in a unit ---
  const factor = (row) => new Map(row.units ?? []).get(row.now.unit) ?? 1
  const quoted = (size, by, unit, digits) => {
    const number = Number((size / by).toPrecision(digits))
    return `${number}${unit && unit !== "°" ? " " : ""}${unit ?? ""}`
  }
  const atPlace = (row, at) => quoted(at < row.slider.zero ? 0 : 10 ** at, factor(row), row.now.unit, 3)

  // --- a row, made once ---
  const parts = {
    text(row) {
      const box = make("input", { type: "text", spellcheck: false, autocomplete: "off", placeholder: row.empty })
      box.oninput = () => { row.typed = true }
      box.onblur = () => { row.typed = false }
      box.onchange = () => { row.typed = false; tell(row.key, "text", box.value) }
      box.onkeydown = ({ key }) => {
        if (key !== "Escape") return
        box.value = row.now.text
        box.onchange()
      }
      return box
    },
    choice(row) {
      const box = make("select", {}, ...row.options.map(([value, label]) => new Option(label, value)))
      box.onchange = () => tell(row.key, "text", box.value)
      return box
    },
    switch(row) {
      const box = make("input", { type: "checkbox" })
      box.setAttribute("role", "switch")
      box.onchange = () => tell(row.key, "text", String(box.checked))
      return box
    },
  }
  const unitsOf = (row) => {
    const menu = make("select", { title: "The same in another unit" })
    menu.setAttribute("aria-label", `Unit of ${row.label}`)
    menu.append(...row.units.map(([unit]) => new Option(unit, unit)))
    menu.onchange = () => tell(row.key, "unit", menu.value)
    return menu
  }
  const sliderOf = (row) => {
    const { start, end, step } = row.slider
    const slider = make("input", { type: "range", min: start, max: end, step: "any" })
    slider.setAttribute("aria-label", row.label)
    const moved = () => {
      const text = atPlace(row, slider.valueAsNumber)
      slider.setAttribute("aria-valuetext", text)
      slider.classList.remove("empty")
      if (!row.slider.ofAxes) row.box.value = text
      tell(row.key, "place", slider.valueAsNumber)
    }
    const by = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10 }
    slider.onkeydown = (event) => {
      if (!(event.key in by)) return
      event.preventDefault()
      slider.value = slider.valueAsNumber + by[event.key] * step
      moved()
    }
    slider.oninput = moved
    slider.onpointerdown = () => { row.dragged = true }
    slider.onpointerup = slider.onpointercancel = () => { row.dragged = false; show(row) }
    return slider
  }
  // Help is on the page where it is in view or its row has the focus: a search finds no text that nobody sees.
  const wanted = make("input", { type: "checkbox" })
  const explain = (row) => {
    row.help.textContent = wanted.checked || row.line.matches(".explained") ? row.explanation : ""
  }
  const rowOf = ({ help, key, ...begin }) => {
    const row = { ...begin, key, begin, explanation: help, now: {} }
    rows.set(key, row)
    row.box = parts[row.kind](row)
    row.box.id = row.key
    row.box.setAttribute("aria-describedby", `${row.key}.error ${row.key}.note ${row.key}.help`)
    row.mark = make("button", { type: "button", className: "mark", tabIndex: -1 })
    row.mark.onclick = () => { row.line.classList.toggle("explained"); explain(row) }
    const field = make("span", { className: "field" }, row.box)
    if (row.units?.length > 1) field.append(row.menu = unitsOf(row))
    row.error = make("p", { id: `${row.key}.error`, className: "refusal" })
    row.note = make("p", { id: `${row.key}.note`, className: "note" })
    row.line = make("div", { className: `row ${row.kind}${row.wide ? " wide" : ""}${row.slider?.ofAxes ? " axes" : ""}` },
      make("label", { htmlFor: row.key, textContent: row.label, title: help }), row.mark, field)
    if (row.slider) row.line.append(row.range = sliderOf(row))
    if (row.restore) {
      row.again = make("button", { type: "button", className: "again", textContent: row.restore })
      row.again.onclick = () => tell(row.key, "text", row.now.text)
      row.said = make("span")
      row.line.append(make("p", {}, row.said, row.again))
    }
    row.help = make("p", { id: `${row.key}.help`, className: "help" })
    row.line.append(row.error, row.note, row.help)
    row.line.addEventListener("focusin", () => { row.help.textContent = help })
    explain(row)
    return row.line
  }

  // --- what a row shows ---
  const put = (element, name, value) => { if (element[name] !== value) element[name] = value }
  const showBox = (row, { text, named }) => {
    const { box } = row
    if (row.kind === "switch") put(box, "checked", text === "true")
    else put(box, "value", text)
    row.line.classList.toggle("long", row.kind === "text" && text.length > 14)
    if (row.kind !== "choice") return
    // An entry that was edited has another name; a list as long as this is not made anew at each change.
    for (const [index, [value, label]] of row.options.entries()) {
      put(box.options[index], "label", named && value === text ? named : label)
    }
  }
  const showSlider = (row, { place: at, text, size }) => {
    const { range } = row
    if (Math.abs(range.valueAsNumber - at) > row.slider.step / 2 || !row.drawn) range.value = at
    range.classList.toggle("empty", size === null)
    range.setAttribute("aria-valuetext", size === null ? row.empty : row.slider.ofAxes ? text : atPlace(row, at))
  }
  const showUnits = (row, { unit, size }) => {
    for (const [index, [name, by]] of row.units.entries()) {
      row.menu.options[index].label = size == null ? name : quoted(size, by, name, 4)
    }
    put(row.menu, "value", unit)
  }
  const show = (row) => {
    const now = model.news[row.key] ?? row.begin
    if (now === row.shown) return
    row.now = now
    row.box.setAttribute("aria-invalid", Boolean(now.error))
    put(row.error, "textContent", now.error)
    put(row.note, "textContent", now.note ?? "")
    row.note.classList.toggle("converted", Boolean(now.converted))
    put(row.mark, "textContent", now.mark ?? "")
    put(row.mark, "title", now.note ?? "")
    if (now.mark) row.mark.setAttribute("aria-label", `Source of ${row.label}`)
    if (row.again) {
      put(row.said, "textContent", now.said)
      row.again.hidden = !now.said
    }
    const busy = row.dragged || underWay(row.key)  // what a person does there is newer
    row.shown = busy ? null : now
    if (busy) return
    if (row.range) showSlider(row, now)
    if (row.menu) showUnits(row, now)
    // A text that is being typed stays, and so does one that was refused.
    if (row.kind !== "text" || !(row.typed || (now.error && row.drawn))) showBox(row, now)
    row.drawn = true
  }

  // --- groups ---
  const folds = []
  const groupOf = (group, index) => {
    const inside = make("div", { id: `group-${index}`, className: "rows" })
    const fill = () => {
      if (group.pictured) inside.append(make("div", { className: "picture", innerHTML: model.picture }))
      inside.append(...group.rows.map(rowOf))
      for (const { key } of group.rows) show(rows.get(key))
    }
    if (!group.title) {
      fill()
      return inside
    }
    const arrow = make("span", { className: "arrow", ariaHidden: "true", textContent: "▾" })
    const title = make("button", { type: "button" }, group.title, arrow)
    title.setAttribute("aria-controls", inside.id)
    const fold = (open) => {
      if (open && !inside.hasChildNodes()) fill()
      inside.hidden = !open
      title.setAttribute("aria-expanded", open)
    }
    title.onclick = () => fold(inside.hidden)
    folds.push([group.title, fold, title])
    fold(group.open)
    return make("section", {}, make("h3", {}, title), inside)
  }
  if (model.heading) place.append(make("h2", { className: "hidden", textContent: model.heading }))
  wanted.setAttribute("role", "switch")
  wanted.onchange = () => { place.classList.toggle("explained", wanted.checked); rows.forEach(explain) }
  if (model.groups.some(({ title }) => title)) {
    place.append(make("label", { className: "explain" }, wanted, "Show help for all inputs"))
  }
  const groups = make("div", { className: "groups" })
  place.append(groups)
  groups.append(...model.groups.map(groupOf))

  const showAll = () => rows.forEach(show)
  const pictured = () => { for (const at of place.querySelectorAll(".picture")) at.innerHTML = model.picture }
  model.on("picture", pictured)
  model.on("news", showAll)
  model.on("heard", () => {
    const answered = rows.get(asked)
    asked = null
    next()
    if (answered) answered.shown = null  // what was told may be what there was, in other words
    showAll()
  })
  model.on("msg:custom", ({ open, enter }) => {
    for (const [title, fold] of folds) fold(open.includes(title))
    const first = folds.find(([title]) => title === open[0])?.[2]
    first?.scrollIntoView({ block: "nearest" })
    if (enter) first?.closest("section").querySelector("input:not([type=range], [type=checkbox])")?.select()
  })
  return place
}
