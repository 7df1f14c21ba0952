export function render({ model }) {
  const place = document.createElement("div")
  place.innerHTML = `<p>Is your navigation good enough for SAR?</p>
    <div role="group" aria-label="Start with"><span aria-hidden="true">Start with</span></div>
    <p class="next" aria-live="polite"></p>`
  const group = place.querySelector("div")
  for (const name of model.names) {
    const button = document.createElement("button")
    Object.assign(button, { type: "button", textContent: name, onclick: () => model.send_msg(name) })
    group.append(button)
  }
  const show = () => {
    for (const button of group.querySelectorAll("button")) {
      button.setAttribute("aria-pressed", button.textContent === model.chosen)
    }
    place.querySelector(".next").textContent = model.says
  }
  model.on("chosen", show)
  model.on("says", show)
  show()
  return place
}
