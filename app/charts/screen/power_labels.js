// The label of a tick, in one notation for the whole axis: plain numbers near 1; far from it 10ⁿ where all ticks are
// powers of ten, else a·10ⁿ.
const n = Math.log10(tick)
const sup = {"-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹"}
const power = (k) => "10" + String(k).split("").map(c => sup[c]).join("")
const whole = (k) => Math.abs(k - Math.round(k)) < 1e-6
if (ticks.every(each => each >= 9.99e-5 && each < 1e5)) return String(Number(tick.toPrecision(3)))
if (ticks.every(each => whole(Math.log10(each)))) return power(Math.round(n))
const floor = Math.floor(n + 1e-9)
return Number((tick / 10 ** floor).toPrecision(3)) + "·" + power(floor)
