"""A tour of the product for who opens it the first time.

All of it happens in the browser: it is offered once, never stands in the way, and whoever has taken or declined it
is not asked again on that browser.
"""

from __future__ import annotations

from typing import Any, ClassVar

import param
from panel.custom import JSComponent

from app.ui.theme import PRINT_NOTHING

STEPS: tuple[dict[str, str], ...] = (
    {
        "title": "Your design",
        "text": "Inertial unit, receiver, flight, radar, limits. Start from the catalogue, then type values as they "
        "stand on a data sheet, such as 0.09 °/√h, or move a slider. “Explain every input” says what each one is.",
        "at": ".sidebar",
    },
    {
        "title": "The answer",
        "text": "Whether the design closes, by how much, and what dominates. It follows every change at once.",
        "at": ".strip[role=status]",
    },
    {
        "title": "Why",
        "text": "The charts below explain the answer. Under each stands how we know; a mark such as [T-17] leads to "
        "its equation and to what it was checked against.",
        "at": ".know",
    },
    {
        "title": "What next",
        "text": "Explore says what would close the design, SAR what the image looks like, Simulate whether the "
        "closed forms hold, and Review compares and signs off with your team.",
        "at": "[role=tablist]",
    },
    {
        "title": "Keep and share",
        "text": "Undo takes any change back. Save writes a file, Link an address, and the reports a document. "
        "Examples has designs to start from.",
        "at": ".tools",
    },
)


class Tour(JSComponent):
    """The button that starts the tour, the offer on a first visit, and the card that walks through the steps."""

    steps = param.List(default=list[Any](STEPS))

    _stylesheets: ClassVar[list[str]] = [
        PRINT_NOTHING,
        """
:host { align-self: center; font-family: Roboto, "Segoe UI", system-ui, sans-serif; font-size: 13px; }
button { font: inherit; font-weight: 500; color: inherit; background: none; border: 1px solid transparent;
  border-radius: 4px; padding: 4px 8px; cursor: pointer; }
button:focus-visible { outline: 2px solid; outline-offset: 1px; }
button:disabled { opacity: .5; cursor: default; }
.offer { border-color: currentColor; }
.card { position: fixed; z-index: 1300; right: 16px; bottom: 16px; width: min(380px, calc(100vw - 32px));
  box-sizing: border-box; padding: 14px 16px; border-radius: 8px; background: Canvas; color: CanvasText;
  border: 1px solid; box-shadow: 0 4px 18px rgb(0 0 0 / 35%); }
.card h2 { font-size: 17px; margin: 0 0 4px; font-weight: 600; }
.card p { margin: 0 0 10px; font-size: 14px; line-height: 1.4; }
.card .row { display: flex; gap: 8px; align-items: center; }
.card .row span { margin-right: auto; }
.card button { border-color: currentColor; }
.frame { position: fixed; z-index: 1290; pointer-events: none; border: 3px solid #d55e00; border-radius: 6px;
  box-sizing: border-box; }
[hidden] { display: none !important; }
""",
    ]

    _esm = """
const KEY = "navbudget-tour"
const known = () => { try { return localStorage.getItem(KEY) } catch { return null } }
const remember = () => { try { localStorage.setItem(KEY, "done") } catch { /* asked again next time */ } }

function find(selector, root = document) {
  for (const found of root.querySelectorAll(selector)) {
    if (found.getClientRects().length) return found
  }
  for (const element of root.querySelectorAll("*")) {
    const found = element.shadowRoot && find(selector, element.shadowRoot)
    if (found) return found
  }
  return null
}

export function render({ model }) {
  const place = document.createElement("div")
  place.innerHTML = `
    <button class="start" type="button">Tour</button><button class="no" type="button" hidden>No, thanks</button>
    <div class="frame" hidden></div>
    <section class="card" role="dialog" aria-modal="false" aria-labelledby="title" aria-describedby="text" hidden>
      <h2 id="title" tabindex="-1"></h2><p id="text"></p>
      <div class="row"><span></span><button class="back" type="button">Back</button>
      <button class="next" type="button"></button><button class="skip" type="button">Skip</button></div>
    </section>`
  const at = (selector) => place.querySelector(selector)
  const [start, no, frame, card] = [".start", ".no", ".frame", ".card"].map(at)
  let step = 0, target = null, watching = 0

  const offered = (open) => {
    start.textContent = open ? "New here? Take the tour" : "Tour"
    start.classList.toggle("offer", open)
    no.hidden = !open
  }
  const follow = () => {
    const box = target?.isConnected && target.getClientRects().length ? target.getBoundingClientRect() : null
    frame.hidden = !box
    if (box) {
      const [left, top] = [Math.max(box.left - 4, 0), Math.max(box.top - 4, 0)]
      Object.assign(frame.style, {
        left: left + "px", top: top + "px",
        width: Math.min(box.right + 4, innerWidth) - left + "px",
        height: Math.max(Math.min(box.bottom + 4, innerHeight) - top, 0) + "px",
      })
    }
    watching = requestAnimationFrame(follow)
  }
  const show = () => {
    const { title, text, at: selector } = model.steps[step]
    const last = step === model.steps.length - 1
    at("h2").textContent = title
    at("p").textContent = text
    at(".row span").textContent = `${step + 1} of ${model.steps.length}`
    at(".back").disabled = step === 0
    at(".next").textContent = last ? "Done" : "Next"
    at(".skip").hidden = last
    target = find(selector)
    target?.scrollIntoView({ block: "nearest" })
    at("h2").focus({ preventScroll: true })
  }
  const close = () => {
    cancelAnimationFrame(watching)
    card.hidden = frame.hidden = true
    remember()
    offered(false)
    start.focus()
  }
  const turn = (by) => {
    step += by
    if (step >= model.steps.length) close()
    else show()
  }
  start.onclick = () => {
    step = 0
    if (location.hash.length > 1) location.hash = "#budget"  // the page it tells of
    card.hidden = false
    // As light or dark as the page, which says so by the colour of its text only.
    const ink = getComputedStyle(place).color
    const light = ink.match(/[0-9.]+/g).slice(0, 3).reduce((sum, part) => sum + Number(part), 0) > 384
    Object.assign(card.style, { color: ink, background: light ? "#161d24" : "#ffffff" })
    show()
    cancelAnimationFrame(watching)
    follow()
  }
  no.onclick = () => { remember(); offered(false); start.focus() }
  at(".back").onclick = () => turn(-1)
  at(".next").onclick = () => turn(1)
  at(".skip").onclick = close
  card.addEventListener("keydown", (event) => { if (event.key === "Escape") close() })
  offered(!known())
  return place
}
"""
