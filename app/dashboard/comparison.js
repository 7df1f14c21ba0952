export function render({ model }) {
  const place = document.createElement("div")
  place.innerHTML = `
    <p><span></span> <button class="clear" type="button">clear</button>
      <button class="choose" type="button" aria-expanded="false">choose</button></p>
    <div class="menu" hidden>
      <button data-do="changes" type="button">Previous version</button>
      <label>Saved design <select><option value="">choose a design</option></select></label>
      <button class="file" type="button">Design file…</button>
      <input type="file" accept=".toml" tabindex="-1" aria-label="Design file to compare with" hidden>
    </div>
    <p class="problem" aria-live="polite"></p>`
  const at = (selector) => place.querySelector(selector)
  const [said, clear, choose, menu, select, file, problem] =
    ["span", ".clear", ".choose", ".menu", "select", "input", ".problem"].map(at)
  const tell = (message) => { shut(); model.send_msg(message) }
  const shut = () => { menu.hidden = true; choose.setAttribute("aria-expanded", "false") }
  clear.onclick = () => tell({ do: "clear" })
  choose.onclick = () => {
    menu.hidden = !menu.hidden
    choose.setAttribute("aria-expanded", String(!menu.hidden))
    if (!menu.hidden) model.send_msg({ do: "list" })
  }
  at("[data-do]").onclick = () => tell({ do: "changes" })
  select.onchange = () => { if (select.value) tell({ do: "saved", key: select.value }) }
  at(".file").onclick = () => file.click()
  file.onchange = async () => {
    const [chosen] = file.files
    if (chosen) {
      tell({ do: "file", name: chosen.name, data: chosen.size <= model.most ? await chosen.arrayBuffer() : null })
    }
    file.value = ""
  }
  place.addEventListener("keydown", (event) => { if (event.key === "Escape" && !menu.hidden) { shut(); choose.focus() } })
  const named = () => {
    said.textContent = model.compared ? `Compared with: ${model.compared}` : "Compare with:"
    clear.hidden = !model.compared
  }
  const listed = () => {
    select.replaceChildren(new Option("choose a design", ""), ...model.saved.map(([key, name]) => new Option(name, key)))
  }
  const follow = { compared: named, saved: listed, problem: () => { problem.textContent = model.problem } }
  for (const [property, change] of Object.entries(follow)) {
    model.on(property, change)
    change()
  }
  return place
}
