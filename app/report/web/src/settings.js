// Scores of a study's settings. This file does not draw. A setting is one combination of varied values, and its runs
// differ only in the seed.
import {isNumber, lossOf, mean} from './statistics.js';

// {rows, mean, sd} of each setting that has a score, in the order of `rows`. sd is null for a single run.
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

// The mean of the best setting; null without settings. The best of all levels is the study's best setting.
export const reached = (settings, goal) => (settings.length ? bestSetting(settings, goal).mean : null);

// The level of the axis to which a setting belongs.
export const levelOf = (axis, setting) => axis.of(setting.rows[0]);

// The best cell as {a, b, value}; null without cells.
export function bestCell(cells, goal) {
  let best = null;
  cells.forEach((line, b) => line.forEach((value, a) => {
    if (value !== null && (!best || lossOf(goal, value) < lossOf(goal, best.value))) best = {a, b, value};
  }));
  return best;
}
