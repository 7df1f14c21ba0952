export function render({ model }) {
  const place = document.createElement("div")
  const go = (name, tries = 60) => {
    const target = place.querySelector("#" + CSS.escape(name))
    if (!target) return
    for (let part = target.closest("details"); part; part = part.parentElement.closest("details")) part.open = true
    if (!target.getClientRects().length && tries) {  // the page is still being turned
      setTimeout(() => go(name, tries - 1), 50)
      return
    }
    place.querySelectorAll(".here").forEach(old => old.classList.remove("here"))
    target.classList.add("here")
    target.setAttribute("tabindex", "-1")
    target.scrollIntoView({ block: "start" })
    target.focus({ preventScroll: true })
  }
  place.addEventListener("click", (event) => {
    const address = event.target.closest("a")?.getAttribute("href") ?? ""
    // A new address is answered by the server. Were it followed here as well, the answer would pull back whoever has
    // moved on meanwhile; one that stands already is told to nobody.
    if (address.startsWith("#theory-") && address === location.hash) go(address.slice(8))
  })
  const draw = () => { place.innerHTML = model.html }
  const answer = () => { if (model.asked) go(model.asked.split(" ")[0]) }
  model.on("html", draw)
  model.on("asked", answer)
  draw()
  answer()
  return place
}
