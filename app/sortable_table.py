"""A table that is sorted and searched in the browser: no message to the server, no library."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

from app.theme import SHEET

_SORTING = """
th button { all: unset; cursor: pointer; font-weight: 500; }
th button:focus-visible { outline: 2px solid; outline-offset: 2px; border-radius: 2px; }
th button::after { content: " ↕"; opacity: .45; }
th[aria-sort="ascending"] button::after { content: " ↑"; opacity: 1; }
th[aria-sort="descending"] button::after { content: " ↓"; opacity: 1; }
.scroll.tall { max-height: 430px; overflow-y: auto; }
.scroll.tall thead th { position: sticky; top: 0; background: var(--mui-palette-background-paper, Canvas); }
td button { font: inherit; font-size: 12.5px; cursor: pointer; color: inherit; background: none; padding: 2px 10px;
  border: 1px solid color-mix(in srgb, currentColor 45%, transparent); border-radius: 6px; }
td button:hover, td button:focus-visible { outline: 2px solid; outline-offset: 1px; }
"""


class SortableTable(JSComponent):
    """Our own HTML with one table; a column whose heading holds a `<button>` can be sorted.

    A cell sorts by its `data-sort` attribute when it has one (a number or a text), else by what it says; an
    empty `data-sort` goes last in both directions. Order, focus and place scrolled to survive new content. Rows that
    lack one of `words` are hidden; a `<button data-choose="...">` in a row calls `chosen` with what it holds.
    """

    html = param.String(default="", doc="Already escaped.")
    words = param.String(default="", doc="Rows that hold all of these words are shown, whatever the case.")

    def __init__(self, chosen: Callable[[str], Any] | None = None, **params: Any) -> None:
        super().__init__(**params)
        self._chosen = chosen

    def _handle_msg(self, msg: Any) -> None:
        if self._chosen is not None and isinstance(msg, dict) and isinstance(msg.get("chosen"), str):
            self._chosen(msg["chosen"])

    _stylesheets: ClassVar[list[str]] = [SHEET, _SORTING]

    _esm = r"""
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
  const search = () => {
    const words = model.words.toLowerCase().split(/\s+/).filter(Boolean)
    place.querySelectorAll("tbody tr").forEach((row) => {
      const text = row.textContent.toLowerCase()
      row.hidden = !words.every((word) => text.includes(word))
    })
  }
  const draw = () => {
    const focused = place.getRootNode().activeElement?.dataset?.choose
    const before = place.querySelector(".scroll")
    const [top, left] = before ? [before.scrollTop, before.scrollLeft] : [0, 0]
    place.innerHTML = model.html
    place.querySelectorAll("thead th").forEach((head, index) => {
      head.querySelector("button")?.addEventListener("click", () => {
        sign = index === column ? -sign : 1
        column = index
        sort()
      })
    })
    place.querySelectorAll("[data-choose]").forEach((button) => {
      button.addEventListener("click", () => model.send_msg({ chosen: button.dataset.choose }))
      if (button.dataset.choose === focused) button.focus({ preventScroll: true })
    })
    sort()
    search()
    place.querySelector(".scroll")?.scrollTo(left, top)
  }
  model.on("html", draw)
  model.on("words", search)
  draw()
  return place
}
"""
