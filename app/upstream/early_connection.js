// The page connects while it still loads the libraries: the server makes the session meanwhile. Bokeh connects when all
// are loaded and run, and each side waits for the other in turn. What comes before Bokeh asks is kept and handed on.
//
// Written for: Bokeh 3.9.2
// Upstream: none found, searched 2026-11-23
// Needless when: tests/browser/test_as_shipped.py::test_a_page_connects_when_all_is_loaded fails
{
  const token = "TOKEN"
  const Shipped = WebSocket
  const path = location.pathname.replace(/\/+$/, "")
  void document.cookie // read back, as it is set in its own time: what this page says of itself goes with the connection
  const early = new Shipped(`${location.protocol.replace("http", "ws")}//${location.host}${path}/ws${location.search}`, ["bokeh", token])
  early.binaryType = "arraybuffer"
  const kept = []
  for (const on of ["onopen", "onmessage", "onclose", "onerror"]) early[on] = (event) => kept.push([on, event])
  window.WebSocket = new Proxy(Shipped, {
    construct(shipped, [url, protocols]) {
      if (protocols?.[1] !== token || early.readyState > Shipped.OPEN) return new shipped(url, protocols)
      window.WebSocket = Shipped
      queueMicrotask(() => kept.forEach(([on, event]) => early[on](event)))
      return early
    },
  })
}
