// Columns of a study as axes of its plots, and what the plots share. `context` of a plot: {study, shown: {rows, base,
// listeners}, showRun(row), restrict(test)}.
import {choice} from './elements.js';
import {plainValue} from './ordering.js';
import {plain} from './plots.js';
import {isNumber} from './statistics.js';

// Values of a column over the study, in the order the study gave them; numbers in theirs where all are.
export function axisOf(study, name) {
  const i = study.columns.findIndex((column) => column.name === name);
  const of = (row) => plainValue(row.cells[i]);
  const numeric = study.rows.every((row) => of(row) === null || isNumber(of(row)));
  const levels = [...new Set(study.rows.map(of).filter((v) => v !== null))];
  if (numeric) levels.sort((a, b) => a - b);
  const position = new Map(levels.map((level, k) => [level, k]));
  return {name, of, numeric, levels, position, label: plain(name)};
}

// An axis whose levels stand at equal distances.
export const levelTicks = (axis) =>
    ({tickvals: axis.levels.map((_, k) => k), ticktext: axis.levels.map((level) => plain(level))});

// Names of the columns of a kind: varied, score, cost.
export const namesOf = (study, kind) => study.columns.filter((column) => column.kind === kind).map(({name}) => name);
export const positionOf = (list, wanted) => Math.max(0, list.indexOf(wanted));

export function scoreChoice(study, begin, onchange) {
  const scores = namesOf(study, 'score');
  return choice('Score', scores, positionOf(scores, begin), (i) => onchange(scores[i]));
}

export const isDrawn = (element) => element.plot.querySelector('.main-svg') !== null;

// The figure is drawn anew when the runs that are shown change.
export function follow(context, element) {
  context.shown.listeners.push(() => {
    if (isDrawn(element)) element.redraw();
  });
}
