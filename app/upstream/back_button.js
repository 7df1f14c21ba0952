// Panel writes each address that came from the browser, or from a followed link, into its history once more: Back led
// to the same place, and Forward to nowhere. An address that the browser shows already is kept out.
//
// Report to send upstream, version and end: docs/upstream/back_button.md
const push = history.pushState.bind(history)
history.pushState = (state, title, url) => {
  if (!url || new URL(url, location.href).href !== location.href) push(state, title, url)
}
