// Two runs, A and B: one colour, dash and symbol each in every plot.
import {legend} from './elements.js';
import {palette} from './plots.js';

export const letters = ['A', 'B'];
export const colours = [palette.modes[0], palette.modes[3]];
export const symbols = ['circle', 'diamond'];
const dashes = ['solid', 'dash'];

export const stroke = (k, width = 1.4) => ({color: colours[k], width, dash: dashes[k], simplify: true});

// `runs`: of the page's data; `extra`: more entries.
export function pairLegend(runs, extra = []) {
  return legend([...letters.map((letter, k) => [colours[k], `${letter}: ${runs[k].name}`]), ...extra]);
}
