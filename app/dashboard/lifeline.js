const KEY = "navbudget-design", AGAIN = "navbudget-again"
const here = () => location.pathname + location.search
const take = (key) => {
  try {
    const text = sessionStorage.getItem(key)
    return text && JSON.parse(text)
  } catch { return null }  // storage forbidden, or not ours
}
const keep = (key, value) => {
  try { sessionStorage.setItem(key, JSON.stringify(value)) } catch { /* not kept then */ }
}

function all(selector, root = document) {
  const below = [...root.querySelectorAll("*")].filter((element) => element.shadowRoot)
  return [...root.querySelectorAll(selector), ...below.flatMap((element) => all(selector, element.shadowRoot))]
}

export function render({ model, view }) {
  const place = document.createElement("div")
  place.innerHTML = `<section role="alert" hidden><p></p><button type="button">Reload</button></section>`
  const [section, text, button] = ["section", "p", "button"].map((name) => place.querySelector(name))

  const kept = take(KEY), again = take(AGAIN)
  const opened = performance.getEntriesByType("navigation")[0]?.type === "navigate" && !again
  keep(AGAIN, false)
  const store = () => keep(KEY, { at: here(), who: model.who, link: model.link, base: model.base })
  const page = view.model.document
  const ours = kept && kept.at === here() && kept.who === model.who
  if (ours && kept.link !== model.link && !opened) {
    // Kept on until the server has taken it back; not before all stands, or half of the page would miss the change.
    const ask = () => requestAnimationFrame(() => model.send_msg({ link: kept.link, base: kept.base }))
    page.is_idle ? ask() : page.idle.connect(ask)
  } else store()
  model.on("link", store)
  model.on("base", store)

  model.on("dark", () => {
    const secure = location.protocol === "https:" ? "; secure" : ""
    document.cookie = `${THEME_COOKIE}=${model.dark ? "dark" : "light"}; path=/; max-age=31536000; samesite=lax${secure}`
  })

  const say = (what) => { text.textContent = what }
  const lost = () => {
    if (!section.hidden) return
    const when = new Date().toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" })
    const said = `Connection to the server lost at ${when}. ` +
      "The figures are from before; nothing is computed now."
    say(said)
    section.hidden = false
    for (const part of all(".sidebar, .tools")) {
      part.inert = true
      part.style.opacity = 0.5
    }
    const look = async () => {
      try {
        const answer = await fetch(new URL("liveness", location.origin + location.pathname), { cache: "no-store" })
        if (!answer.ok) throw new Error(answer.status)
        say(`${said} The server answers again. Reload to get your design back; results of runs are lost.`)
      } catch { setTimeout(look, 3000) }
    }
    setTimeout(look, 1000)
  }
  button.onclick = () => { keep(AGAIN, true); location.reload() }
  page.on_event("connection_lost", lost)
  return place
}
