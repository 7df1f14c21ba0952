// What the thumb's bubble and a screen reader say: the value, not its logarithm. Below `lowest` lies zero.
if (tick < lowest) return "0 " + unit
return String(Number((10 ** tick / factor).toPrecision(3))) + " " + unit
