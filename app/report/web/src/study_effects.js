// Main effects of a study: scores for each value of each varied key.
import {figure} from './chart.js';
import {choice, controls, h} from './elements.js';
import {palette} from './look.js';
import {plainValue} from './ordering.js';
import {section} from './page.js';
import {columnTitle} from './score_names.js';
import {bestCell, bestSetting, levelOf, reached, settingsOf} from './settings.js';
import {isNumber} from './statistics.js';

// Values of a column over the study. They are increasing numbers if all values are numbers, else they have the study's
// order.
function axisOf(study, name) {
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
const namesOf = (study, kind) => study.columns.filter((column) => column.kind === kind).map(({name}) => name);
const positionOf = (list, wanted) => Math.max(0, list.indexOf(wanted));

function scoreChoice(study, begin, onchange) {
  const scores = namesOf(study, 'score');
  return choice('Score', scores.map(columnTitle), positionOf(scores, begin), (i) => onchange(scores[i]));
}

const spread = 0.16;  // width over which the runs of a level are scattered, relative to the width of the level

// Runs as dots, a line at the summary of each level, and a star at the best level.
function effectMarks(axis, score, rows) {
  const level = (row) => axis.position.get(axis.of(row));
  const strewn = (row) => level(row) + spread * (((row.number * 0.618) % 1) - 0.5);
  const points = rows.filter((row) => isNumber(score.of(row)) && axis.of(row) !== null);
  const settings = settingsOf(points, score), x = axis.levels.map((_, k) => k);
  const y = axis.levels.map((value) => reached(settings.filter((one) => levelOf(axis, one) === value), score.goal));
  const best = bestCell([y], score.goal), colour = palette.modes[0];
  const there = x.filter((k) => y[k] !== null);
  return [
    {
      kind: 'points',
      x: points.map(strewn),
      y: points.map(score.of),
      colour: palette.unclustered,
      size: 5,
      opacity: 0.7,
    },
    {kind: 'line', x: there, y: there.map((k) => y[k]), colour, width: 2.5},
    {kind: 'points', name: 'main effect', x, y, colour, size: 8},
    ...(best ? [{kind: 'points', x: [best.a], y: [best.value], colour, size: 14, symbol: 'star'}] : []),
  ];
}

// The range in which levels differ. Without it, one bad level of another key would flatten the lines. Null: all values.
function usefulRange(axes, score, rows) {
  const settings = settingsOf(rows, score);
  const values = axes.flatMap(
                         (axis) => axis.levels.map(
                             (value) => reached(settings.filter((one) => levelOf(axis, one) === value), score.goal)))
                     .filter(isNumber);
  if (!values.length) return null;
  const low = Math.min(...values), high = Math.max(...values), room = 0.5 * (high - low) || 0.1 * Math.abs(high) || 1;
  const all = settings.map((one) => one.mean);
  return [Math.max(low - room, Math.min(...all) - 0.1 * room), Math.min(high + room, Math.max(...all) + 0.2 * room)];
}

function effectsDrawing(axes, score, rows) {
  const range = usefulRange(axes, score, rows), best = bestSetting(settingsOf(rows, score), score.goal);
  const line = best ? [{kind: 'rule', y: best.mean, dash: 'dot'}] : [];
  const panels = axes.map((axis) => ({
                            x: {title: axis.label, levels: axis.levels.map(String)},
                            y: {title: score.label, range},
                            marks: [...effectMarks(axis, score, rows), ...line],
                          }));
  return {panels, height: 210, wide: 280};
}

export function drawEffects(study) {
  const axes = namesOf(study, 'varied').map((key) => axisOf(study, key)).filter((axis) => axis.levels.length > 1);
  let score = study.standard_score;
  const element = figure(
      'Main effects: scores by the values of each varied key',
      () => effectsDrawing(axes, axisOf(study, score), study.rows),
      'Line: the best setting with that value over all other keys; star: ' +
          'the best value; dotted: the best setting of all; dots: the runs, those far below outside the frame.');
  const pick = scoreChoice(study, score, (name) => {
    score = name;
    element.update();
  });
  const content = axes.length ? element : h('p', {}, 'No key has more than one value.');
  section('effects', 'Main effects', controls(pick), content);
}
