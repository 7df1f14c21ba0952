const style = document.createElement("style")
style.textContent = `@media print { @page { size: portrait; margin: 12mm } html, body { height: auto !important } }
  .imprint { display: none; margin: 0 0 6px; font: 12px Roboto, sans-serif; color: #000; background: #fff }
  @media print { .imprint { display: block } }`
document.head.append(style)
const all = (root, match) => [...root.querySelectorAll("*")].flatMap((element) =>
  element.matches(match) ? [element] : element.shadowRoot ? all(element.shadowRoot, match) : [])
const imprint = document.createElement("p")
imprint.className = "imprint"
imprint.setAttribute("aria-hidden", "true")
document.body.prepend(imprint)
window.addEventListener("beforeprint", () => {
  const today = new Date().toLocaleString("en-GB", { dateStyle: "long", timeStyle: "short" })
  imprint.textContent = `${all(document, ".design input")[0]?.value} · ${today} · NavBudget VERSION`
  for (const part of all(document, ".first-screen, .bk-Figure")) {
    const [width, height] = [part.offsetWidth, part.offsetHeight], zoom = Math.min(1, WIDTH / (width || 1))
    const sizes = { "--paper-width": `${width}px`, "--paper-height": `${height}px`, "--paper-zoom": zoom }
    for (const [name, size] of Object.entries(sizes)) part.style.setProperty(name, size)
    if (part.classList.contains("bk-Figure")) part.style.zoom = zoom
  }
})
window.addEventListener("afterprint", () => {
  for (const figure of all(document, ".bk-Figure")) figure.style.zoom = ""
})
