"""Choices opened by the keyboard: the component library (0.16) opens them by click alone."""

from __future__ import annotations

from panel.custom import JSComponent


class SelectKeys(JSComponent):
    """Invisible; Enter, Space and the arrows up and down open the closed choice that has the focus."""

    _esm = """
    const KEYS = new Set(["Enter", " ", "ArrowDown", "ArrowUp"])

    export function render() {
      if (!window.select_keys) {
        window.select_keys = true
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
      }
      return document.createElement("span")
    }
    """
