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
    const focused = place.getRootNode().activeElement?.value // of a box or a button
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
    tick()
    place.querySelector(".scroll")?.scrollTo(scrollLeft, scrollTop)
    const again = [...place.querySelectorAll("tbody input, tbody button")].find(({ value }) => value === focused)
    again?.focus({ preventScroll: true })
  }
  const tick = () => place.querySelectorAll("input").forEach((box) => { box.checked = model.ticked.includes(box.value) })
  place.addEventListener("change", ({ target: { value, checked } }) => {
    model.ticked = checked ? [...model.ticked, value] : model.ticked.filter((each) => each !== value)
    tick() // a row may be there twice
  })
  place.addEventListener("click", (event) => {
    const button = event.target.closest("tbody button")
    if (button) model.send_msg(button.value)
  })
  if (model.over) document.addEventListener("keydown", ({ key }) => {
    if (key === "Escape" && place.getClientRects().length) model.send_msg("")
  })
  model.on("html", draw)
  model.on("ticked", tick)
  draw()
  return place
}
