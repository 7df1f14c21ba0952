"""What holds when the page loses its server or is loaded again: nothing on it pretends to be computed, the design
comes back, and dark stays dark."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

THEME_COOKIE = "navbudget-theme"


class Lifeline(JSComponent):
    """Keeps the design in the browser's tab, gives it back to a page loaded again there, and says so when the server
    is gone.

    The tab forgets it when it is closed, or when somebody else logs in on it. A page that is opened, not loaded
    again, takes nothing back: it shows what its address says. ``come_back`` is called with what was kept: the texts
    `link` and `base`.
    """

    link = param.String(doc="The design in force and the study beside it, as a link's query.")
    base = param.String(doc="Key of the saved revision the design came from; empty: none.")
    who = param.String(doc="Who is logged in; empty: nobody has to.")
    dark = param.Boolean(doc="Whether the page is dark: kept in a cookie, for every page of this server.")

    _stylesheets: ClassVar[list[str]] = [
        """
section { position: fixed; z-index: 1400; left: 50%; bottom: 16px; transform: translateX(-50%);
  box-sizing: border-box; width: min(640px, calc(100vw - 32px)); padding: 12px 16px; border-radius: 8px;
  border: 2px solid #ffffff; background: #10151a; color: #ffffff; box-shadow: 0 4px 18px rgb(0 0 0 / 45%);
  font: 14px/1.4 Roboto, "Segoe UI", system-ui, sans-serif; display: flex; gap: 16px; align-items: center; }
section p { margin: 0; }
button { font: inherit; font-weight: 500; color: inherit; background: none; border: 1px solid; border-radius: 4px;
  padding: 6px 14px; cursor: pointer; }
button:focus-visible { outline: 2px solid; outline-offset: 2px; }
[hidden] { display: none; }
""",
    ]

    _esm = """
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
    document.cookie = `COOKIE=${model.dark ? "dark" : "light"}; path=/; max-age=31536000; samesite=lax${secure}`
  })

  const say = (what) => { text.textContent = what }
  const lost = () => {
    if (!section.hidden) return
    const when = new Date().toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" })
    const said = `Connection to the server lost at ${when}. ` +
      "The figures are those from before; nothing is computed now."
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
        say(`${said} The server answers again: reload, and the design comes back; results of runs do not.`)
      } catch { setTimeout(look, 3000) }
    }
    setTimeout(look, 1000)
  }
  button.onclick = () => { keep(AGAIN, true); location.reload() }
  page.on_event("connection_lost", lost)
  return place
}
""".replace("COOKIE", THEME_COOKIE)

    def __init__(self, come_back: Callable[[str, str], None], **params: Any) -> None:
        super().__init__(**params)
        self._come_back = come_back

    def _handle_msg(self, msg: Any) -> None:
        link, base = (msg.get(key) for key in ("link", "base")) if isinstance(msg, dict) else (None, None)
        if isinstance(link, str) and isinstance(base, str):
            self._come_back(link, base)
