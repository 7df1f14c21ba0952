// The page connects while it runs the libraries: the server makes the session meanwhile. Bokeh connects when all have
// run, and each side waits for the other in turn. What comes before Bokeh asks is kept and handed on. The last library
// comes first: the server cannot send it while it makes the session.
//
// Report to send upstream, version and end: docs/upstream/opening.md
{
  const token = "TOKEN"
  const Shipped = WebSocket
  const kept = []
  let early = null
  const connect = () => {
    void document.cookie // read back, as it is set in its own time: what this page says of itself goes with the connection
    const path = location.pathname.replace(/\/+$/, "")
    const url = `${location.protocol.replace("http", "ws")}//${location.host}${path}/ws${location.search}`
    early = new Shipped(url, ["bokeh", token])
    early.binaryType = "arraybuffer"
    for (const on of ["onopen", "onmessage", "onclose", "onerror"]) early[on] = (event) => kept.push([on, event])
  }
  const arrivals = new PerformanceObserver((list) => {
    if (!list.getEntries().some(({ name }) => name.includes("/panel.min.js"))) return
    arrivals.disconnect()
    connect()
  })
  arrivals.observe({ type: "resource", buffered: true })
  window.WebSocket = new Proxy(Shipped, {
    construct(shipped, [url, protocols]) {
      if (protocols?.[1] !== token) return new shipped(url, protocols)
      window.WebSocket = Shipped
      arrivals.disconnect()
      if (early === null || early.readyState > Shipped.OPEN) return new shipped(url, protocols)
      queueMicrotask(() => kept.forEach(([on, event]) => early[on](event)))
      return early
    },
  })
}
