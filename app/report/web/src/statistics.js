// Statistics that the pages compute from the numbers of C++.

export const isNumber = (v) => typeof v === 'number' && Number.isFinite(v);
export const mean = (values) => values.reduce((a, b) => a + b, 0) / values.length;

const enough = 20000;  // number of values that is enough to estimate the quantiles of a list

// The range of nearly all values. Windows that determine the parameters badly give outliers. These are
// excluded, because they would hide the other windows.
export function usualRange(values) {
  const step = Math.max(1, Math.floor(values.length / enough));
  const some = Array.from(values).filter((v, i) => i % step === 0 && Number.isFinite(v));
  if (!some.length) return [-1, 1];
  some.sort((a, b) => a - b);
  const at = (share) => some[Math.round(share * (some.length - 1))];
  const low = at(0.01), high = at(0.99), pad = 0.12 * (high - low) || 1e-9;
  return [low - pad, high + pad];
}

// Converts a score to a loss according to its goal (study_page.cpp). A smaller loss is better.
export function lossOf(goal, score) {
  if (!goal || goal.kind === 'higher') return -score;
  return goal.kind === 'lower' ? score : Math.abs(score - goal.nominal);
}
