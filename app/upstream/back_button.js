// Panel writes each address that came from the browser, or from a followed link, into its history once more: Back led
// to the same place, and Forward to nowhere. An address that the browser shows already is kept out.
//
// Written for: Panel 1.9.4
// Upstream: none found, searched 2026-11-22
// Needless when: tests/browser/test_as_shipped.py::test_a_followed_link_is_written_into_the_history_twice fails
const push = history.pushState.bind(history)
history.pushState = (state, title, url) => {
  if (!url || new URL(url, location.href).href !== location.href) push(state, title, url)
}
