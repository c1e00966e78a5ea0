// Statistics that the pages compute from C++'s numbers.

export const isNumber = (v) => typeof v === 'number' && Number.isFinite(v);
export const mean = (values) => values.reduce((a, b) => a + b, 0) / values.length;

const enough = 20000;  // enough values of a list to estimate its quantiles

// The range of nearly all values in the lists. Outliers of badly determined windows are excluded, because they would
// hide the other windows.
export function usualRange(...lists) {
  const some = lists.flatMap((list) => {
    const step = Math.max(1, Math.floor(list.length / enough));
    return Array.from(list).filter((v, i) => i % step === 0 && Number.isFinite(v));
  });
  if (!some.length) return [-1, 1];
  some.sort((a, b) => a - b);
  const at = (share) => some[Math.round(share * (some.length - 1))];
  const low = at(0.01), high = at(0.99), pad = 0.12 * (high - low) || 1e-9;
  return [low - pad, high + pad];
}

// A score as a loss by its goal (study_page.cpp); smaller is better.
export function lossOf(goal, score) {
  if (!goal || goal.kind === 'higher') return -score;
  return goal.kind === 'lower' ? score : Math.abs(score - goal.nominal);
}

// Points {x, loss} such that no other point is better in both.
export function paretoFront(points) {
  const front = [];
  for (const point of [...points].sort((a, b) => a.x - b.x || a.loss - b.loss)) {
    if (!front.length || point.loss < front[front.length - 1].loss) front.push(point);
  }
  return front;
}
