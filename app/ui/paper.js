const style = document.createElement("style")
style.textContent = `@media print { @page { margin: 12mm } html, body { height: auto !important } }
  .imprint { display: none; margin: 0 0 6px; font: 12px Roboto, sans-serif; color: #000; background: #fff }
  @media print { .imprint { display: block } }`
document.head.append(style)
const figures = (root) => [...root.querySelectorAll("*")].flatMap((element) =>
  element.classList.contains("bk-Figure") ? [element] : element.shadowRoot ? figures(element.shadowRoot) : [])
const name = (root) => [...root.querySelectorAll("*")].reduce((found, element) => found
  || (element.matches(".design input") ? element.value : element.shadowRoot && name(element.shadowRoot)), "")
const imprint = document.createElement("p")
imprint.className = "imprint"
imprint.setAttribute("aria-hidden", "true")
document.body.prepend(imprint)
window.addEventListener("beforeprint", () => {
  const today = new Date().toLocaleString("en-GB", { dateStyle: "long", timeStyle: "short" })
  imprint.textContent = `${name(document)} · ${today} · NavBudget VERSION`
  for (const figure of figures(document)) figure.style.zoom = Math.min(1, WIDTH / (figure.offsetWidth || 1))
})
window.addEventListener("afterprint", () => {
  for (const figure of figures(document)) figure.style.zoom = ""
})
