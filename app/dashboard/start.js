export function render({ model }) {
  const place = document.createElement("div")
  place.innerHTML = `<p>Is your navigation good enough for SAR?</p>
    <div role="group" aria-label="Start with"></div>
    <p class="next" aria-live="polite"></p>
    <form hidden><textarea rows="3" maxlength="5000" aria-label="Rows of the data sheet"
      placeholder="Angle random walk 0.15 °/√h, velocity random walk 0.06 m/s/√h"></textarea>
      <button>Fill in</button><div class="answer" role="status"></div></form>`
  const group = place.querySelector("div"), form = place.querySelector("form"), rows = place.querySelector("textarea")
  for (const name of model.names) {
    const button = document.createElement("button")
    Object.assign(button, { type: "button", textContent: name, onclick: () => model.send_msg(name) })
    group.append(button)
  }
  form.onsubmit = (event) => {
    event.preventDefault()
    model.send_msg({ rows: rows.value })
  }
  const show = () => {
    for (const button of group.querySelectorAll("button")) {
      button.setAttribute("aria-pressed", button.textContent === model.chosen)
    }
    place.querySelector(".next").textContent = model.says
    const opens = form.hidden && model.chosen === model.pasted
    form.hidden = model.chosen !== model.pasted
    if (opens) rows.focus()
  }
  const answer = () => { place.querySelector(".answer").innerHTML = model.answer }
  model.on("chosen", show)
  model.on("says", show)
  model.on("answer", answer)
  show()
  answer()
  return place
}
