// Computations for the first picture of a page. They need no canvas.

/** Runs of equal values: {from, to, value}, without `to`. */
export function segments(values) {
  const list = [];
  values.forEach((value, i) => {
    const last = list[list.length - 1];
    if (last && last.value === value) {
      last.to = i + 1;
    } else {
      list.push({from: i, to: i + 1, value});
    }
  });
  return list;
}

/** About `wanted` round numbers in [low, high]. */
export function ticks([low, high], wanted) {
  const rough = (high - low) / wanted, size = 10 ** Math.floor(Math.log10(rough));
  const step = size * [1, 2, 5, 10].find((factor) => factor * size >= rough);
  const digits = Math.max(0, -Math.floor(Math.log10(step)));
  const list = [];
  for (let k = Math.ceil(low / step); k * step <= high; ++k) list.push(Number((k * step).toFixed(digits)));
  return list;
}
