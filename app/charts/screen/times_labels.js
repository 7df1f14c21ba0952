// The label of a ratio: 1/4 rather than 0.25.
return tick < 1 ? "1/" + Math.round(1 / tick) : String(tick)
