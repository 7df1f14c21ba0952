"""A table that is sorted by pressing its headings, in the browser: no message to the server, no library.

A row is chosen by its radio button, or by a button in it, where the table has any.
"""

from __future__ import annotations

from typing import ClassVar

import param
from panel.custom import JSComponent

from app.ui.theme import SHEET

_SORTING = """
th button { all: unset; cursor: pointer; font-weight: 500; }
th button:focus-visible { outline: 2px solid; outline-offset: 2px; border-radius: 2px; }
thead button::after { content: " ↕"; opacity: .45; }
tbody button { text-decoration: underline; text-underline-offset: 2px; }
th[aria-sort="ascending"] button::after { content: " ↑"; opacity: 1; }
th[aria-sort="descending"] button::after { content: " ↓"; opacity: 1; }
"""


class SortableTable(JSComponent):
    """Our own HTML with one table; a column whose heading holds a `<button>` can be sorted.

    A cell sorts by its `data-sort` attribute when it has one (a number or a text), else by what it says; an
    empty `data-sort` goes last in both directions. The order chosen survives new content, and so do the row chosen
    as long as it is there, the place scrolled to and the focus on a row's button.
    """

    html = param.String(default="", doc="Already escaped.")
    chosen = param.String(default="", doc="Value of the radio button that is on, or of the button last pressed.")

    _stylesheets: ClassVar[list[str]] = [SHEET, _SORTING]

    _esm = """
export function render({ model }) {
  const place = document.createElement("div")
  let column = -1, sign = 1
  const key = (row) => {
    const cell = row.cells[column]
    const text = cell.dataset.sort ?? cell.textContent.trim()
    const number = Number(text)
    return text === "" ? null : Number.isNaN(number) ? text.toLowerCase() : number
  }
  const compare = (a, b) => {
    const [left, right] = [key(a), key(b)]
    if (left === null || right === null) return (left === null) - (right === null)
    return sign * (typeof left === typeof right && left < right ? -1 : left > right ? 1 : 0)
  }
  const sort = () => {
    if (column < 0) return
    const body = place.querySelector("tbody")
    body.append(...[...body.rows].sort(compare))
    place.querySelectorAll("thead th").forEach((head, index) => {
      if (index === column) head.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending")
      else head.removeAttribute("aria-sort")
    })
  }
  const draw = () => {
    const focused = place.getRootNode().activeElement?.value
    const { scrollTop, scrollLeft } = place.querySelector(".scroll") ?? { scrollTop: 0, scrollLeft: 0 }
    place.innerHTML = model.html
    place.querySelectorAll("thead th").forEach((head, index) => {
      head.querySelector("button")?.addEventListener("click", () => {
        sign = index === column ? -sign : 1
        column = index
        sort()
      })
    })
    sort()
    choose()
    place.querySelector(".scroll")?.scrollTo(scrollLeft, scrollTop)
    const again = [...place.querySelectorAll("input[type=radio]")].find((radio) => radio.value === focused)
    again?.focus({ preventScroll: true })
  }
  const choose = () => place.querySelectorAll("input[type=radio]").forEach((radio) => {
    radio.checked = radio.value === model.chosen
  })
  place.addEventListener("change", (event) => { model.chosen = event.target.value })
  place.addEventListener("click", (event) => {
    const button = event.target.closest("tbody button")
    if (button) model.chosen = button.value
  })
  model.on("html", draw)
  model.on("chosen", choose)
  draw()
  return place
}
"""
