// Heat map of a study: the mean score for each pair of values of two keys.
import {choice, controls, h} from './elements.js';
import {section} from './page.js';
import {figure, plain} from './plots.js';
import {isNumber, mean} from './statistics.js';
import {axisOf, follow, levelTicks, namesOf, scoreChoice} from './study_axes.js';

const most_labels = 150;

// cells[b][a]: mean at level b of y and level a of x; null where no run has both.
function meansOver(x, y, z, rows) {
  return y.levels.map((b) => x.levels.map((a) => {
    const here = rows.filter((row) => x.of(row) === a && y.of(row) === b).map(z.of).filter(isNumber);
    return here.length ? mean(here) : null;
  }));
}

// The numbers in the cells, dark on light and light on dark.
function labelsOf(cells) {
  const known = cells.flat().filter(isNumber), middle = (Math.min(...known) + Math.max(...known)) / 2;
  const label = (cell, x, y) => ({
    x,
    y,
    text: cell.toPrecision(4),
    showarrow: false,
    font: {size: 11, color: cell > middle ? '#111111' : '#ffffff'}
  });
  return cells.flatMap((line, b) => line.flatMap((cell, a) => (cell === null ? [] : [label(cell, a, b)])));
}

function heatDrawing(x, y, z, rows) {
  const cells = meansOver(x, y, z, rows);
  const said = (cell, a, b) => `${x.label} = ${plain(x.levels[a])}<br>${y.label} = ${plain(y.levels[b])}<br>` +
      `mean ${cell === null ? '–' : cell.toPrecision(4)}`;
  const trace = {
    type: 'heatmap',
    z: cells,
    x: x.levels.map((_, k) => k),
    y: y.levels.map((_, k) => k),
    colorscale: 'Cividis',
    xgap: 1,
    ygap: 1,
    hoverongaps: false,
    hoverinfo: 'text',
    text: cells.map((line, b) => line.map((cell, a) => said(cell, a, b))),
    colorbar: {title: {text: z.label, side: 'right'}, thickness: 12},
  };
  const axis = (of) => ({...levelTicks(of), title: {text: of.label}, showgrid: false});
  const layout = {
    annotations: x.levels.length * y.levels.length <= most_labels ? labelsOf(cells) : [],
    height: Math.min(700, 140 + 42 * y.levels.length),
    margin: {l: 90, r: 10, t: 10, b: 60},
    xaxis: axis(x),
    yaxis: axis(y),
  };
  return {traces: [trace], layout};
}

export function drawHeatMap(context) {
  const {study, shown} = context;
  const keys = namesOf(study, 'varied');
  if (keys.length < 2) {
    section('heatmap', 'Two keys', h('p', {}, 'The study varies one key only.'));
    return;
  }
  const chosen = {across: keys[0], down: keys[1], score: study.standard_score};
  const axis = (which) => axisOf(study, chosen[which]);
  const element = figure(
      'Heat map: the mean score for each pair of values of two keys',
      () => heatDrawing(axis('across'), axis('down'), axis('score'), shown.rows),
      'Mean over the runs shown that have the pair of values, whatever their other keys.');
  const choose = (which, name) => {
    chosen[which] = name;
    element.redraw();
  };
  section(
      'heatmap', 'Two keys',
      controls(
          choice('Across', keys, 0, (i) => choose('across', keys[i])),
          choice('Up', keys, 1, (i) => choose('down', keys[i])),
          scoreChoice(study, chosen.score, (name) => choose('score', name))),
      element);
  follow(context, element);
}
