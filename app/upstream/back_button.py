"""The browser's Back: one press for one step."""

from __future__ import annotations

from panel.custom import JSComponent


class BackButton(JSComponent):
    """Invisible; keeps an address out of the browser's history that stands there already.

    As shipped, Panel (1.9) writes each address in once more that came from there or from a followed link, so Back led
    to the same place, and Forward to nowhere.
    """

    _esm = """
    const push = history.pushState.bind(history)
    history.pushState = (state, title, url) => {
      if (!url || new URL(url, location.href).href !== location.href) push(state, title, url)
    }

    export function render() { return document.createElement("span") }
    """
