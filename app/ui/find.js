// The first element in view that a selector names, wherever it is: the page's parts have roots that a selector does not
// enter.
function find(selector, root = document) {
  for (const found of root.querySelectorAll(selector)) if (found.getClientRects().length) return found
  for (const element of root.querySelectorAll("*")) {
    const found = element.shadowRoot && find(selector, element.shadowRoot)
    if (found) return found
  }
  return null
}

