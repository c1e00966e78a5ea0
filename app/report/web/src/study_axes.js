// Columns of a study as axes of plots, and state that the plots share. `context` of a plot: {study, shown: {rows,
// listeners}}.
import {choice} from './elements.js';
import {plainValue} from './ordering.js';
import {columnTitle} from './score_names.js';
import {isNumber} from './statistics.js';

// Values of a column over the study. They are increasing numbers if all values are numbers, else they have the study's
// order.
export function axisOf(study, name) {
  const i = study.columns.findIndex((column) => column.name === name);
  const of = (row) => plainValue(row.cells[i]);
  const numeric = study.rows.every((row) => of(row) === null || isNumber(of(row)));
  const levels = [...new Set(study.rows.map(of).filter((v) => v !== null))];
  if (numeric) levels.sort((a, b) => a - b);
  const position = new Map(levels.map((level, k) => [level, k]));
  const {goal} = study.columns[i];
  return {name, of, numeric, levels, position, goal, label: columnTitle(name)};
}

// Names of the columns of one kind (varied, score or cost).
export const namesOf = (study, kind) => study.columns.filter((column) => column.kind === kind).map(({name}) => name);
const positionOf = (list, wanted) => Math.max(0, list.indexOf(wanted));

export function scoreChoice(study, begin, onchange) {
  const scores = namesOf(study, 'score');
  return choice('Score', scores.map(columnTitle), positionOf(scores, begin), (i) => onchange(scores[i]));
}
