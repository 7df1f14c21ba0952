// Buttons of which one is on. Words, and which it is, change in the frame in which the page's other text does.
export function render({ model }) {
  const group = document.createElement("div")
  group.className = "switch"
  group.setAttribute("role", "group")
  group.setAttribute("aria-label", model.label)
  const draw = () => {
    const words = Object.entries(model.options)
    while (group.childElementCount > words.length) group.lastChild.remove()
    while (group.childElementCount < words.length) group.append(document.createElement("button"))
    words.forEach(([word, value], index) => {
      const button = group.children[index]
      if (button.textContent !== word) button.textContent = word
      button.value = value
      button.setAttribute("aria-pressed", value === model.value)
    })
  }
  group.addEventListener("click", (event) => {
    const button = event.target.closest("button")
    if (button) model.send_msg(button.value)
  })
  model.on(["options", "value"], draw)
  draw()
  return group
}
