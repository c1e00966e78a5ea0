// Pareto plot of a study: a score against a cost. The Pareto front is marked.
import {figure} from './chart.js';
import {choice, controls} from './elements.js';
import {palette} from './look.js';
import {section} from './page.js';
import {columnTitle} from './score_names.js';
import {isNumber, lossOf, paretoFront} from './statistics.js';
import {axisOf, follow, namesOf, scoreChoice} from './study_axes.js';

const shown = (v) => Number(v.toPrecision(5));

// `points`: {x, y, row}. `look`: other properties of the mark.
function runsMark({study, showRun}, points, look) {
  const varied = (row) => study.varied.map(({key}, i) => `${key} = ${row.varied[i]}`);
  const tip = (i) => {
    const {x, y, row} = points[i];
    return [`run ${row.number}`, ...varied(row), `${shown(x)}, ${shown(y)}`];
  };
  const at = (key) => points.map((p) => p[key]);
  return {
    kind: 'points',
    x: at('x'),
    y: at('y'),
    which: points.map((p) => p.row.number),
    ...look,
    tip,
    pick: (i) => showRun(points[i].row)
  };
}

// The range of the front, extended downwards by its own height. Runs far below the front would flatten it.
function rangeAround(points, front) {
  const values = front.map((p) => p.y), all = points.map((p) => p.y);
  const low = Math.min(...values), high = Math.max(...values), room = high - low;
  if (!(room > 0)) return null;
  return [Math.max(low - room, Math.min(...all) - 0.1 * room), Math.min(high + room, Math.max(...all) + 0.1 * room)];
}

function paretoDrawing(context, x, y) {
  const {goal} = y, colour = palette.modes[3];
  const points = context.shown.rows.filter((row) => isNumber(x.of(row)) && isNumber(y.of(row)))
                     .map((row) => ({x: x.of(row), y: y.of(row), loss: lossOf(goal, y.of(row)), row}));
  const front = paretoFront(points);
  const steps = {kind: 'line', x: front.map((p) => p.x), y: front.map((p) => p.y), colour, width: 2, step: true};
  const marks = [
    runsMark(context, points, {name: 'runs', colour: palette.unclustered, size: 7, opacity: 0.6}),
    steps,
    runsMark(context, front, {name: 'front', colour, size: 10}),
  ];
  const panel = {
    x: {title: x.label, whole: x.numeric && x.levels.every(Number.isInteger)},
    y: {title: y.label, range: rangeAround(points, front)},
    marks,
  };
  return {panels: [panel], height: 340, legend: [[palette.unclustered, 'runs'], [colour, 'front']]};
}

export function drawPareto(context) {
  const {study} = context;
  const numeric = namesOf(study, 'varied').filter((key) => axisOf(study, key).numeric);
  const costs = [...namesOf(study, 'cost'), ...numeric, ...namesOf(study, 'score')];
  let [cost] = costs, score = study.standard_score;
  const element = figure(
      'Pareto plot: score against number of modes, the front marked',
      () => paretoDrawing(context, axisOf(study, cost), axisOf(study, score)),
      'Front: runs that no other run beats in the score with as few or fewer. Runs far from it lie outside the ' +
          'frame. Click a run to see it.');
  const pickCost = choice('Cost', costs.map(columnTitle), 0, (i) => {
    cost = costs[i];
    element.update();
  });
  const pickScore = scoreChoice(study, score, (name) => {
    score = name;
    element.update();
  });
  section('pareto', 'Pareto plot', controls(pickCost, pickScore), element);
  follow(context, element);
}
