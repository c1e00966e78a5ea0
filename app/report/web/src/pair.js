// Colours of the compared runs A, B, ... Each run has the same colour, dash and symbol in all plots.
import {legend} from './elements.js';
import {palette, rankColour} from './look.js';
import {matchedRanks} from './mode_pairs.js';

export const letters = ['A', 'B', 'C', 'D', 'E', 'F'];
export const colours = [0, 3, 2, 4, 1, 5].map((k) => palette.modes[k]);
export const symbols = ['circle', 'diamond', 'square', 'triangle-up', 'cross', 'x'];
export const dashes = [undefined, 'dash', 'dot', 'dashdot', 'longdash', 'longdashdot'];


/** For each run of the page's data the colours of its modes; matched modes have equal colours. */
export function modeColours(data) {
  const ranks = matchedRanks(data.runs.map((run) => run.bank), data.matches);
  return ranks.map((of) => (mode) => rankColour(of[mode]));
}

// `runs`: the runs in the page's data. `extra`: more entries for the legend.
export function pairLegend(runs, extra = []) {
  return legend([...runs.map((run, k) => [colours[k], `${letters[k]}: ${run.name}`]), ...extra]);
}
