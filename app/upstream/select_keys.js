// A choice opens by click alone. Here Enter, Space and the arrows up and down open the closed choice that has the focus.
//
// Written for: panel-material-ui 0.16.6
// Upstream: none found, searched 2026-11-22
// Needless when: tests/browser/test_as_shipped.py::test_a_choice_does_not_open_by_keyboard fails
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
