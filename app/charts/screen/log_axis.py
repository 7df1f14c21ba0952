"""Ticks of a logarithmic axis on screen: powers of ten as 10ⁿ, and 2 and 5 between them where there is room."""

from __future__ import annotations

from bokeh.models import CustomJSTicker, CustomJSTickFormatter, LogAxis

_LABELS = """
const n = Math.log10(tick)
const sup = {"-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹"}
const power = (k) => "10" + String(k).split("").map(c => sup[c]).join("")
if (Math.abs(n - Math.round(n)) < 1e-6) return power(Math.round(n))
if (tick >= 1e-3 && tick < 1e4) return String(Number(tick.toPrecision(3)))
return Number((tick / 10 ** Math.floor(n)).toPrecision(3)) + "·" + power(Math.floor(n))
"""
# Over many decades every k-th power; over few 1-2-5; when zoomed in further, equal steps.
_MAJOR = """
const {start, end} = cb_data
const low = Math.min(start, end), high = Math.max(start, end)
const decades = Math.log10(high / low)
const ticks = []
if (!(low > 0) || !isFinite(decades) || decades <= 0) return ticks
if (decades < 0.8) {
  const rough = (high - low) / 5, unit = 10 ** Math.floor(Math.log10(rough))
  const step = unit * [1, 2, 5, 10].find(m => m * unit >= rough * 0.999)
  for (let i = Math.ceil(low / step); i * step <= high; i++) ticks.push(i * step)
  return ticks
}
const every = Math.ceil(decades / 8)
for (let k = Math.floor(Math.log10(low)); k <= Math.ceil(Math.log10(high)); k++)
  for (const m of decades < 2.6 ? [1, 2, 5] : [1])
    if (k % every === 0 && m * 10 ** k >= low && m * 10 ** k <= high) ticks.push(m * 10 ** k)
return ticks
"""
_MINOR = """
const {start, end} = cb_data
const low = Math.min(start, end), high = Math.max(start, end)
const decades = Math.log10(high / low)
const ticks = []
if (!(low > 0) || !isFinite(decades) || decades < 0.8 || decades > 8) return ticks
for (let k = Math.floor(Math.log10(low)); k <= Math.ceil(Math.log10(high)); k++)
  for (let m = 2; m < 10; m++)
    if (m * 10 ** k >= low && m * 10 ** k <= high) ticks.push(m * 10 ** k)
return ticks
"""


def mark_in_powers(axis: LogAxis) -> None:
    """Tick and label a logarithmic axis."""
    axis.ticker = CustomJSTicker(major_code=_MAJOR, minor_code=_MINOR)
    axis.formatter = CustomJSTickFormatter(code=_LABELS)
