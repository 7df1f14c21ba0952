// Ticks without labels: 2 to 9 times each power of ten, where there is room.
const {start, end} = cb_data
const low = Math.min(start, end), high = Math.max(start, end)
const decades = Math.log10(high / low)
const ticks = []
if (!(low > 0) || !isFinite(decades) || decades < 0.8 || decades > 8) return ticks
for (let k = Math.floor(Math.log10(low)); k <= Math.ceil(Math.log10(high)); k++)
  for (let m = 2; m < 10; m++)
    if (m * 10 ** k >= low && m * 10 ** k <= high) ticks.push(m * 10 ** k)
return ticks
