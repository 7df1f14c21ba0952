// The label of a tick: 10ⁿ at a power of ten, a plain number near 1, a·10ⁿ elsewhere.
const n = Math.log10(tick)
const sup = {"-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹"}
const power = (k) => "10" + String(k).split("").map(c => sup[c]).join("")
if (Math.abs(n - Math.round(n)) < 1e-6) return power(Math.round(n))
if (tick >= 1e-3 && tick < 1e4) return String(Number(tick.toPrecision(3)))
return Number((tick / 10 ** Math.floor(n)).toPrecision(3)) + "·" + power(Math.floor(n))
