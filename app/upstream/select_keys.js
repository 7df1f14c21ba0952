// A choice opens by click alone. Here Enter, Space and the arrows up and down open the closed choice that has the focus.
//
// Report to send upstream, version and end: docs/upstream/select_keys.md
const KEYS = new Set(["Enter", " ", "ArrowDown", "ArrowUp"])
// Choices live in shadow roots: the event's own path tells which one has the focus.
document.addEventListener("keydown", (event) => {
  const choice = event.composedPath()[0]
  if (KEYS.has(event.key) && choice.getAttribute?.("role") === "combobox"
      && choice.getAttribute("aria-haspopup") === "listbox"
      && choice.getAttribute("aria-expanded") === "false" && choice.tagName === "DIV") {
    event.preventDefault()
    choice.click()
  }
}, true)
