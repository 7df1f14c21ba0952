const style = document.createElement("style")
style.textContent = "@media print { @page { margin: 12mm } html, body { height: auto !important } }"
document.head.append(style)
const figures = (root) => [...root.querySelectorAll("*")].flatMap((element) =>
  element.classList.contains("bk-Figure") ? [element] : element.shadowRoot ? figures(element.shadowRoot) : [])
window.addEventListener("beforeprint", () => {
  for (const figure of figures(document)) figure.style.zoom = Math.min(1, WIDTH / (figure.offsetWidth || 1))
})
window.addEventListener("afterprint", () => {
  for (const figure of figures(document)) figure.style.zoom = ""
})
