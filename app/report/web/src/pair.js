// Runs that are compared, A, B, ...: one colour, dash and symbol each in every plot.
import {legend} from './elements.js';
import {palette} from './plots.js';

export const letters = ['A', 'B', 'C', 'D', 'E', 'F'];
export const colours = [0, 3, 2, 4, 1, 5].map((k) => palette.modes[k]);
export const symbols = ['circle', 'diamond', 'square', 'triangle-up', 'cross', 'x'];
const dashes = ['solid', 'dash', 'dot', 'dashdot', 'longdash', 'longdashdot'];

export const stroke = (k, width = 1.4) => ({color: colours[k], width, dash: dashes[k], simplify: true});

// `runs`: of the page's data; `extra`: more entries.
export function pairLegend(runs, extra = []) {
  return legend([...runs.map((run, k) => [colours[k], `${letters[k]}: ${run.name}`]), ...extra]);
}
