// What a study's settings reach: a setting is one combination of varied values; its runs differ in seed alone. Draws
// nothing.
import {isNumber, lossOf, mean} from './statistics.js';

// {rows, mean, sd} of each setting with a score, in the rows' order; sd is null of one run.
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

// What settings come to: the best of them, so that the best of all levels is the study's best, or the mean of their
// runs.
export function reached(settings, goal, by) {
  if (!settings.length) return null;
  if (by === 'best') return bestSetting(settings, goal).mean;
  return mean(settings.flatMap((one) => one.rows.map(() => one.mean)));
}

// Settings by level of an axis.
export const levelOf = (axis, setting) => axis.of(setting.rows[0]);

// cells[b][a]: what settings at level b of y and level a of x come to; null where no run has both.
export function cellsOver(x, y, settings, goal, by) {
  return y.levels.map(
      (b) => x.levels.map(
          (a) => reached(settings.filter((one) => levelOf(x, one) === a && levelOf(y, one) === b), goal, by)));
}

// {a, b, value}: the best cell; null where there is none.
export function bestCell(cells, goal) {
  let best = null;
  cells.forEach((line, b) => line.forEach((value, a) => {
    if (value !== null && (!best || lossOf(goal, value) < lossOf(goal, best.value))) best = {a, b, value};
  }));
  return best;
}

const worth = 0.1;  // of the way from the best cell to the median one: less is no interaction to act on

// Whether the best level of x depends on y: the level of y at which going on with the overall best level of x costs
// most, {level, best, kept, cost}; null where it costs nothing that matters. The cost is in the score's unit. `spread`:
// standard deviation of one setting's repeats.
export function interaction(cells, goal, spread = 0) {
  const best = bestCell(cells, goal);
  if (!best) return null;
  const loss = (value) => lossOf(goal, value);
  const bests = cells.map((line) => bestCell([line], goal)).filter(Boolean).map(({value}) => value);
  const losses = cells.flat().filter((value) => value !== null).map(loss).sort((p, q) => p - q);
  const range = losses[Math.floor(losses.length / 2)] - losses[0];
  const costs = cells.flatMap((line, level) => {
    const own = bestCell([line], goal), kept = line[best.a];
    if (!own || kept === null || own.a === best.a) return [];
    return [{level, best: own.a, kept: best.a, cost: loss(kept) - loss(own.value)}];
  });
  const worst = costs.sort((p, q) => q.cost - p.cost)[0];
  return worst && bests.length > 1 && worst.cost > Math.max(worth * range, 2 * spread) ? worst : null;
}

// Root of the mean variance of repeats; 0 without.
export function repeatSpread(settings) {
  const variances = settings.filter(({sd}) => sd !== null).map(({sd}) => sd ** 2);
  return variances.length ? Math.sqrt(mean(variances)) : 0;
}
