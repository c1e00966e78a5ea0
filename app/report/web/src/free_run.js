// The free run: a run predicted from its first samples and its inputs, by the bank and by its best competitor.
import {h, legend} from './elements.js';
import {shortNames} from './filters.js';
import {INK, palette} from './look.js';
import {freeRunTable} from './run_scores.js';
import {stateRow} from './time_rows.js';
import {timePlot} from './timeview.js';

const colours = [
  {band: palette.band, line: palette.prediction, opacity: 0.33},
  {band: palette.modes[4], line: palette.modes[4], opacity: 0.16},
];

// The bank, and the competitor with the smallest error in free runs. Held-out runs decide, if there are any.
function drawn(filter) {
  const judged = filter.free_runs.some((row) => row.role === 'test') ? 'test' : 'train';
  const error = (row) => [].concat(row.nrmse.v).reduce((sum, value) => (value === null ? Infinity : sum + value), 0);
  const others = filter.free_runs.filter((row) => row.role === judged && row.filter !== 'bank');
  const [best] = others.filter((row) => Number.isFinite(error(row))).sort((a, b) => error(a) - error(b));
  return ['bank', ...(best ? [best.filter] : [])];
}

export function drawFreeRun(filter, runs, state) {
  if (!filter.free_runs.length) return [];
  const names = drawn(filter);
  const layers = names.map((name, k) => ({
                             prefix: `${shortNames[name]}: `,
                             ...colours[k],
                             of: (run) => run.free_runs && run.free_runs[name],
                           }));
  const rows = () => runs.states.map((_, i) => stateRow(runs, i, layers));
  const plot = timePlot(
      state, 'Free run of one run over time: measured, and predicted from its first samples and the inputs alone', rows,
      `Bands: ${100 * runs.level} %. Nothing measured after the first samples is used.`);
  const keys = layers.map((layer, k) => [layer.line, `${shortNames[names[k]]}, with band`]);
  return [h('h3', {}, 'Free run'), legend([[INK, 'measured'], ...keys]), plot, freeRunTable(filter)];
}
