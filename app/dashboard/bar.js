// The bar on top of the page. What a person does here is told to the server as a message; what the server knows comes
// as the model's properties.
const ICONS = {
  undo: "M12.5 8c-2.65 0-5.05.99-6.9 2.6L2 7v9h9l-3.62-3.62A8 8 0 0 1 20.1 16l2.37-.78A10.5 10.5 0 0 0 12.5 8z",
  redo: "M18.4 10.6A10.5 10.5 0 0 0 1.54 15.22l2.36.78a8 8 0 0 1 12.72-3.62L13 16h9V7z",
}
const icon = (name) => `<svg viewBox="0 0 24 24" width="20" height="20" aria-hidden="true"><path d="${ICONS[name]}"/></svg>`

export function render({ model }) {
  const place = document.createElement("div")
  place.className = "bar"
  place.innerHTML = `
    <button class="skip" type="button">Skip to the result</button>
    <h1>NavBudget</h1>
    <label class="design" title="Name of the design"><span class="hidden">Design</span>
      <input type="text" maxlength="200" spellcheck="false" autocomplete="off"></label>
    <div class="tabs" role="tablist" aria-label="Pages"></div>
    <button class="more" type="button" aria-expanded="false" aria-label="Tools">⋯</button>
    <div class="tools" role="toolbar" aria-label="Tools">
      <button data-do="undo" type="button" aria-label="Undo" title="Undo">${icon("undo")}</button>
      <button data-do="redo" type="button" aria-label="Redo" title="Redo">${icon("redo")}</button>
      <button data-menu="open" type="button" aria-expanded="false">Open</button>
      <button data-do="save" type="button" title="Save the design as a TOML file">Save</button>
      <button data-menu="share" type="button" aria-expanded="false">Share</button>
      <button data-menu="view" type="button" aria-expanded="false">View</button>
      <button data-menu="report" type="button" aria-expanded="false">Report</button>
      <button class="tour" type="button" aria-label="Tour" title="Tour of the product">?</button>
    </div>
    <div class="menu" data-for="open" hidden>
      <button class="file" type="button">Design file…</button>
      <button data-do="reset" type="button">Reset</button>
      <p>Examples</p>
    </div>
    <div class="menu" data-for="share" hidden>
      <label>Link to this design and page<input type="text" readonly></label>
      <button class="copy" type="button">Copy link</button><span aria-live="polite"></span>
    </div>
    <div class="menu" data-for="view" hidden>
      <label>Values as <select class="spread"><option value="">as required</option><option value="1s">1σ</option>
        <option value="2s">2σ</option><option value="95">95 %</option><option value="cep">CEP (horizontal position)</option></select></label>
      <label>Units <select class="units"><option value="">data-sheet units</option><option value="si">SI</option>
        </select></label>
      <p>For the Budget page, comparisons and reports. Image shows values as required, other pages 1σ. The verdict does not change.</p>
    </div>
    <div class="menu" data-for="report" hidden>
      <label>Description<textarea rows="4" maxlength="2000"></textarea></label>
      <div class="studies"></div><p class="left"></p>
      <button data-report="pdf" type="button">PDF report</button>
      <button data-report="html" type="button">HTML report</button>
      <button data-report="xlsx" type="button" title="The budget with live formulas; without studies">Spreadsheet</button>
      <button data-sheet="imu" type="button">IMU requirement sheet (HTML)</button>
      <button data-sheet="gnss" type="button">Receiver requirement sheet (HTML)</button>
      <p>Sensor noise for another filter</p>
      <button data-filter="kalibr" type="button">kalibr: imu.yaml</button>
      <button data-filter="px4" type="button">PX4 EKF2: parameters</button>
      <button data-filter="kf-gins" type="button">KF-GINS: imunoise</button>
      <button data-filter="pyins" type="button">pyins: models</button>
      <p class="writing" aria-live="polite"></p>
      <button class="stop" type="button" hidden>Cancel</button>
    </div>
    <input class="chooser" type="file" accept=".toml" tabindex="-1" aria-label="Design file" hidden>`
  const at = (selector) => place.querySelector(selector)
  const all = (selector) => [...place.querySelectorAll(selector)]
  const tell = (message) => model.send_msg(message)
  const [name, tabs, tools, more, chooser] = [".design input", ".tabs", ".tools", ".more", ".chooser"].map(at)

  const skip = at(".skip")
  skip.onclick = () => {
    const result = find(".strip[role=status]") ?? find(".main-content")
    result?.setAttribute("tabindex", "-1")
    result?.focus()
  }
  const first = () => {  // the first stop of Tab: before the button of the drawer, in the frame's own part of the bar
    const around = find(".MuiToolbar-root")
    if (around && skip.parentNode !== around) around.prepend(skip)
  }

  // --- name of the design ---
  const named = () => { if (document.activeElement !== name) name.value = model.named; name.title = model.named }
  name.onchange = () => { model.named = name.value }
  name.onkeydown = (event) => {
    if (event.key === "Enter") name.blur()
    if (event.key === "Escape") { name.value = model.named; name.blur() }
  }

  // --- its description ---
  const description = at("textarea")
  const described = () => { if (document.activeElement !== description) description.value = model.description }
  description.onchange = () => { model.description = description.value }

  // --- tabs ---
  tabs.innerHTML = model.tabs.map(() => `<button type="button" role="tab"></button>`).join("")
  const buttons = [...tabs.children]
  const inView = () => buttons.filter((tab) => !tab.hidden)
  const turned = () => buttons.forEach((tab, index) => {
    const [group, title] = model.tabs[index], open = group === model.tabs[model.active][0]
    const first = group !== model.tabs[index - 1]?.[0], several = group === model.tabs[index + 1]?.[0] || !first
    tab.hidden = !open && !first
    tab.textContent = open ? title : group
    tab.classList.toggle("within", open && several)
    tab.setAttribute("aria-selected", index === model.active)
    tab.tabIndex = index === model.active ? 0 : -1
    if (index === model.active) tab.scrollIntoView?.({ block: "nearest", inline: "start" })
  })
  // On a phone the tab in view may be out of sight until the bar has its width.
  new ResizeObserver(() => { first(); turned() }).observe(tabs)
  buttons.forEach((tab, index) => { tab.onclick = () => { model.active = index } })
  tabs.onkeydown = (event) => {
    const row = inView(), here = row.indexOf(event.target)
    const to = { ArrowRight: here + 1, ArrowLeft: here - 1, Home: 0, End: row.length - 1 }[event.key]
    if (to === undefined) return
    event.preventDefault()
    row[(to + row.length) % row.length].focus()
  }

  // --- menus ---
  const menus = all(".menu"), openers = all("[data-menu]")
  const close = (focus) => {
    for (const menu of menus) menu.hidden = true
    for (const opener of openers) {
      if (focus && opener.getAttribute("aria-expanded") === "true") opener.focus()
      opener.setAttribute("aria-expanded", "false")
    }
  }
  const shut = () => {
    close()
    tools.classList.remove("open")
    more.setAttribute("aria-expanded", "false")
  }
  for (const opener of openers) {
    opener.onclick = () => {
      const menu = menus.find((each) => each.dataset.for === opener.dataset.menu), open = menu.hidden
      close()
      menu.hidden = !open
      opener.setAttribute("aria-expanded", String(open))
      if (open) {
        const right = innerWidth - opener.getBoundingClientRect().right
        menu.style.right = Math.max(8, Math.min(right, innerWidth - 320)) + "px"
        if (opener.dataset.menu === "share") share()
        menu.querySelector("input:not([type=checkbox]), textarea, select, button")?.focus()
      }
    }
  }
  more.onclick = () => {
    const open = tools.classList.toggle("open")
    more.setAttribute("aria-expanded", String(open))
    if (!open) close()
  }
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape") { close(true); shut() }
    const undo = event.key.toLowerCase() === "z", redo = event.key.toLowerCase() === "y" || event.shiftKey
    const typing = event.composedPath()[0].matches?.("input:not([type=range], [type=checkbox]), textarea, [contenteditable]")
    if ((event.ctrlKey || event.metaKey) && (undo || event.key.toLowerCase() === "y") && !typing) {
      event.preventDefault()
      tell({ do: redo ? "redo" : "undo" })
    }
  })
  document.addEventListener("pointerdown", (event) => { if (!event.composedPath().includes(place)) shut() })

  // --- what the buttons do ---
  for (const button of all("[data-do]")) button.onclick = () => { shut(); tell({ do: button.dataset.do }) }
  at(".tour").onclick = () => { shut(); window.dispatchEvent(new CustomEvent("navbudget-tour", { detail: at(".tour") })) }
  at(".file").onclick = () => { shut(); chooser.click() }
  for (const [key, textContent, title] of model.examples) {
    const onclick = () => { shut(); tell({ do: "example", key }) }
    at("[data-for=open]").append(Object.assign(document.createElement("button"), { type: "button", textContent, title, onclick }))
  }
  chooser.onchange = async () => {
    const [file] = chooser.files
    if (!file) return
    const fits = file.size <= model.most
    tell({ do: "open", name: file.name, size: file.size, data: fits ? await file.arrayBuffer() : null })
    chooser.value = ""
  }
  const address = () => {
    const page = model.tabs[model.active][2]
    at("[data-for=share] input").value = `${location.origin}${location.pathname}?${model.link}#${page}`
  }
  model.on("link", address)  // a slider's last steps may still be on their way
  const share = () => {
    const field = at("[data-for=share] input")
    address()
    at("[data-for=share] span").textContent = ""
    requestAnimationFrame(() => field.select())
  }
  at(".copy").onclick = async () => {
    const field = at("[data-for=share] input")
    field.select()
    try {
      if (navigator.clipboard) await navigator.clipboard.writeText(field.value)
      else document.execCommand("copy")
      at("[data-for=share] span").textContent = "Copied."
    } catch { at("[data-for=share] span").textContent = "Press Ctrl+C to copy." }
  }

  // --- how figures are told ---
  const [spread, units] = [".spread", ".units"].map(at)
  const display = () => { [spread.value, units.value] = [...(model.display || "").split("."), ""] }
  spread.onchange = units.onchange = () => {
    tell({ do: "show", word: units.value ? `${spread.value}.${units.value}` : spread.value })
  }

  // --- reports ---
  const studies = () => {
    at(".studies").innerHTML = model.studies.map(({ kind, label, ticked }) =>
      `<label><input type="checkbox" value="${kind}" ${ticked ? "checked" : ""}> ${label}</label>`).join("")
    at(".left").textContent = model.left_out
  }
  at(".studies").onchange = ({ target }) => tell({ do: "tick", kind: target.value, ticked: target.checked })
  for (const button of all("[data-report]")) button.onclick = () => tell({ do: "report", suffix: button.dataset.report })
  for (const button of all("[data-filter]")) button.onclick = () => { shut(); tell({ do: "filter", name: button.dataset.filter }) }
  for (const button of all("[data-sheet]")) button.onclick = () => tell({ do: "sheet", unit: button.dataset.sheet })
  at(".stop").onclick = () => tell({ do: "stop" })
  const report = openers.find((opener) => opener.dataset.menu === "report")
  let since = 0, clock = 0
  const writing = () => {
    clearInterval(clock)
    const busy = Boolean(model.writing)
    if (busy) {
      since = performance.now()
      const show = () => {
        const seconds = Math.floor((performance.now() - since) / 1000)
        report.textContent = `${/waits/.test(model.writing) ? "Waiting" : "Writing"}… ${seconds} s`
        if (seconds % 5 === 0) at(".writing").textContent = `Writing the ${model.writing}: ${seconds} s.`
      }
      show()
      clock = setInterval(show, 1000)
    } else {
      report.textContent = "Report"
      at(".writing").textContent = ""
    }
    at(".stop").hidden = !busy
    for (const button of all("[data-report], [data-sheet]")) button.disabled = busy
  }
  model.on("msg:custom", (file) => {
    if (!file?.file) return
    const link = document.createElement("a")
    link.href = URL.createObjectURL(new Blob([file.data], { type: file.kind }))
    link.download = file.file
    link.click()
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000)
  })

  const can = () => {
    at("[data-do=undo]").disabled = !model.can_undo
    at("[data-do=redo]").disabled = !model.can_redo
  }
  const follow = {
    named, description: described, active: () => { turned(); shut(); find(".main-content")?.scrollTo(0, 0) }, can_undo: can, can_redo: can, studies, left_out: studies, writing, display,
  }
  for (const [property, change] of Object.entries(follow)) {
    model.on(property, change)
    change()
  }
  return place
}
