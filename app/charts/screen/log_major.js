// Ticks with labels: over many decades every k-th power; over few 1-2-5; when zoomed in further, equal steps.
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
