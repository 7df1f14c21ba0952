const KEY = "navbudget-tour"
const known = () => { try { return localStorage.getItem(KEY) } catch { return null } }
const remember = () => { try { localStorage.setItem(KEY, "done") } catch { /* asked again next time */ } }

export function render({ model }) {
  const place = document.createElement("div")
  place.innerHTML = `
    <p class="offer" hidden><button class="start" type="button">New here? Take the tour</button>
      <button class="no" type="button">No, thanks</button></p>
    <div class="frame" hidden></div>
    <section class="card" role="dialog" aria-modal="false" aria-labelledby="title" aria-describedby="text" hidden>
      <h2 id="title" tabindex="-1"></h2><p id="text"></p>
      <div class="row"><span></span><button class="back" type="button">Back</button>
      <button class="next" type="button"></button><button class="skip" type="button">Skip</button></div>
    </section>`
  const at = (selector) => place.querySelector(selector)
  const [offer, start, no, frame, card] = [".offer", ".start", ".no", ".frame", ".card"].map(at)
  let step = 0, target = null, watching = 0, back = null

  const dress = (part) => {
    // As light or dark as the page, which says so by the colour of its text only.
    const ink = getComputedStyle(place).color
    const light = ink.match(/[0-9.]+/g).slice(0, 3).reduce((sum, part) => sum + Number(part), 0) > 384
    Object.assign(part.style, { color: ink, background: light ? "#161d24" : "#ffffff" })
  }
  const offered = (open) => { offer.hidden = !open || !model.offers }
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
    at("#text").textContent = text
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
    back?.focus()
  }
  const turn = (by) => {
    step += by
    if (step >= model.steps.length) close()
    else show()
  }
  const begin = () => {
    step = 0
    offered(false)
    if (location.hash.length > 1) location.hash = "#budget"  // the page it tells of
    card.hidden = false
    dress(card)
    show()
    cancelAnimationFrame(watching)
    follow()
  }
  start.onclick = begin
  window.addEventListener("navbudget-tour", ({ detail }) => { back = detail; begin() })
  no.onclick = () => { remember(); offered(false) }
  at(".back").onclick = () => turn(-1)
  at(".next").onclick = () => turn(1)
  at(".skip").onclick = close
  card.addEventListener("keydown", (event) => { if (event.key === "Escape") close() })
  // It lies over the inputs, so it goes with the first press beside it; the bar's button still starts the tour.
  let passed = false
  const ask = () => { if (!known() && !passed && card.hidden) { dress(offer); offered(true) } }
  const elsewhere = (event) => { if (!event.composedPath().includes(place)) { passed = true; offered(false) } }
  addEventListener("pointerdown", elsewhere, { capture: true, once: true })
  model.on("offers", ask)
  requestAnimationFrame(ask)
  return place
}
