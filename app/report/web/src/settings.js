// Scores of a study's settings, without drawing. A setting is one combination of varied values; its runs differ only in
// the seed.
import {isNumber, lossOf, mean} from './statistics.js';

// {rows, mean, sd} of each setting with a score, in the order of rows; sd is null for one run.
export function settingsOf(rows, score) {
  const groups = new Map();
  for (const row of rows) {
    if (!isNumber(score.of(row))) continue;
    const key = JSON.stringify(row.varied);
    if (!groups.has(key)) groups.set(key, []);
    groups.get(key).push(row);
  }
  return [...groups.values()].map((list) => {
    const values = list.map(score.of), middle = mean(values);
    const squares = values.reduce((sum, v) => sum + (v - middle) ** 2, 0);
    return {rows: list, mean: middle, sd: list.length > 1 ? Math.sqrt(squares / (list.length - 1)) : null};
  });
}

export function bestSetting(settings, goal) {
  return settings.reduce(
      (best, one) => (best === null || lossOf(goal, one.mean) < lossOf(goal, best.mean) ? one : best), null);
}

// Summary of settings: the best one, so that the best of all levels is the study's best, or the mean over their runs.
export function reached(settings, goal, by) {
  if (!settings.length) return null;
  if (by === 'best') return bestSetting(settings, goal).mean;
  return mean(settings.flatMap((one) => one.rows.map(() => one.mean)));
}

// The level of a setting along an axis.
export const levelOf = (axis, setting) => axis.of(setting.rows[0]);

// The best cell as {a, b, value}; null if there is none.
export function bestCell(cells, goal) {
  let best = null;
  cells.forEach((line, b) => line.forEach((value, a) => {
    if (value !== null && (!best || lossOf(goal, value) < lossOf(goal, best.value))) best = {a, b, value};
  }));
  return best;
}
