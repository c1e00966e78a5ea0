// Pareto plot of a study: a score against a cost, the front marked.
import {choice, controls} from './elements.js';
import {section} from './page.js';
import {figure, palette, plain} from './plots.js';
import {columnTitle} from './score_names.js';
import {isNumber, lossOf, paretoFront} from './statistics.js';
import {axisOf, follow, namesOf, numberTicks, scoreChoice, sideTitle} from './study_axes.js';

// `points`: {x, y, row}; `look`: more of the trace.
function runsTrace(study, points, look) {
  const said = (row) => study.varied.map(({key}, i) => `${plain(key)} = ${plain(row.varied[i])}`).join('<br>');
  return {
    type: 'scattergl',
    x: points.map((p) => p.x),
    y: points.map((p) => p.y),
    customdata: points.map((p) => p.row.number),
    text: points.map((p) => said(p.row)),
    hovertemplate: 'run %{customdata}<br>%{text}<br>%{x:.5g}, %{y:.5g}<extra></extra>',
    ...look,
  };
}

// Where the front lies and as much again below: runs far below would press it flat.
function rangeAround(points, front) {
  const values = front.map((p) => p.y), all = points.map((p) => p.y);
  const low = Math.min(...values), high = Math.max(...values), room = high - low;
  if (!(room > 0)) return {};
  return {
    range: [Math.max(low - room, Math.min(...all) - 0.1 * room), Math.min(high + room, Math.max(...all) + 0.1 * room)]
  };
}

function paretoDrawing(study, x, y, rows) {
  const {goal} = y;
  const points = rows.filter((row) => isNumber(x.of(row)) && isNumber(y.of(row)))
                     .map((row) => ({x: x.of(row), y: y.of(row), loss: lossOf(goal, y.of(row)), row}));
  const grey = {name: 'runs', mode: 'markers', marker: {size: 7, color: palette.unclustered, opacity: 0.6}};
  const front = {
    name: 'front',
    mode: 'lines+markers',
    line: {shape: 'hv', color: palette.modes[3], width: 2},
    marker: {size: 10, color: palette.modes[3]},
  };
  const layout = {
    height: 420,
    uirevision: `${x.name} ${y.name}`,
    xaxis: {title: {text: x.label}, ...numberTicks(x)},
    yaxis: {title: sideTitle(y), ...rangeAround(points, paretoFront(points))},
    legend: {orientation: 'h', y: 1.08},
  };
  return {traces: [runsTrace(study, points, grey), runsTrace(study, paretoFront(points), front)], layout};
}

export function drawPareto(context) {
  const {study, shown, showRun} = context;
  const numeric = namesOf(study, 'varied').filter((key) => axisOf(study, key).numeric);
  const costs = [...namesOf(study, 'cost'), ...numeric, ...namesOf(study, 'score')];
  let [cost] = costs, score = study.standard_score;
  const element = figure(
      'Pareto plot: score against number of modes, the front marked',
      () => paretoDrawing(study, axisOf(study, cost), axisOf(study, score), shown.rows),
      'Front: runs that no other run beats in the score with as few or fewer. Runs far from it lie outside the ' +
          'frame. Click a run to see it.');
  element.ready.then(() => element.plot.on('plotly_click', (event) => showRun(study.rows[event.points[0].customdata])));
  const pickCost = choice('Cost', costs.map(columnTitle), 0, (i) => {
    cost = costs[i];
    element.redraw();
  });
  const pickScore = scoreChoice(study, score, (name) => {
    score = name;
    element.redraw();
  });
  section('pareto', 'Pareto plot', controls(pickCost, pickScore), element);
  follow(context, element);
}
