// Heat map of a study: what each pair of values of two keys reaches.
import {choice, controls, h} from './elements.js';
import {section} from './page.js';
import {figure, plain} from './plots.js';
import {bestCell, cellsOver, interaction, repeatSpread, settingsOf} from './settings.js';
import {isNumber} from './statistics.js';
import {axisOf, follow, levelTicks, namesOf, scoreChoice, sideTitle, wayChoice, wayWords} from './study_axes.js';

const most_labels = 150;

// The numbers in the cells, dark on light and light on dark.
function labelsOf(cells, goal) {
  const known = cells.flat().filter(isNumber), middle = (Math.min(...known) + Math.max(...known)) / 2;
  const light = !(goal && goal.kind === 'lower');
  const label = (cell, x, y) => ({
    x,
    y,
    text: cell.toPrecision(4),
    showarrow: false,
    font: {size: 11, color: cell > middle === light ? '#111111' : '#ffffff'}
  });
  return cells.flatMap((line, b) => line.flatMap((cell, a) => (cell === null ? [] : [label(cell, a, b)])));
}

// A frame around the best cell.
const frameOf = ({a, b}) => [['#000000', 5], ['#ffffff', 2]].map(
    ([color, width]) => ({type: 'rect', x0: a - 0.46, x1: a + 0.46, y0: b - 0.46, y1: b + 0.46, line: {color, width}}));

function heatDrawing(x, y, z, rows, by) {
  const cells = cellsOver(x, y, settingsOf(rows, z), z.goal, by), best = bestCell(cells, z.goal);
  const said = (cell, a, b) => `${x.label} = ${plain(x.levels[a])}<br>${y.label} = ${plain(y.levels[b])}<br>` +
      `${wayWords[by]} ${cell === null ? '–' : cell.toPrecision(4)}`;
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
    reversescale: Boolean(z.goal && z.goal.kind === 'lower'),
    colorbar: {title: {...sideTitle(z), side: 'right'}, thickness: 12},
  };
  const axis = (of) => ({...levelTicks(of), title: {text: of.label}, showgrid: false});
  const layout = {
    annotations: x.levels.length * y.levels.length <= most_labels ? labelsOf(cells, z.goal) : [],
    height: Math.max(320, Math.min(700, 140 + 42 * y.levels.length)),
    margin: {l: 90, r: 10, t: 10, b: 60},
    shapes: best ? frameOf(best) : [],
    xaxis: axis(x),
    yaxis: axis(y),
  };
  return {traces: [trace], layout};
}

// Pairs of keys of which the best value of one depends on the other, the costliest first: [x, y, what interaction
// says].
export function interactionsOf(study, rows, score) {
  const keys = namesOf(study, 'varied').map((key) => axisOf(study, key)).filter(({levels}) => levels.length > 1);
  const settings = settingsOf(rows, score), spread = repeatSpread(settings);
  const found = keys.flatMap((x) => keys.filter((y) => y !== x).map((y) => {
    return [x, y, interaction(cellsOver(x, y, settings, score.goal, 'best'), score.goal, spread)];
  }));
  return found.filter(([, , what]) => what).sort((p, q) => q[2].cost - p[2].cost);
}

const most_interactions = 3;

function interactionNotes(study, rows, score) {
  const said = ([x, y, {level, best, kept, cost}]) =>
      h('li', {},
        `With ${y.name} = ${y.levels[level]} the best ${x.name} is ${x.levels[best]}, not ${x.levels[kept]} as ` +
            `overall: keeping it costs ${cost.toPrecision(2)}.`);
  const found = interactionsOf(study, rows, score).slice(0, most_interactions);
  if (!found.length) return ['No key’s best value depends on another’s by more than chance or a tenth of the range.'];
  return [h('strong', {}, 'Keys that interact: '), 'look at them in pairs.', h('ul', {}, found.map(said))];
}

export function drawHeatMap(context) {
  const {study, shown} = context;
  const keys = namesOf(study, 'varied').filter((key) => axisOf(study, key).levels.length > 1);
  if (keys.length < 2) {
    section('heatmap', 'Two keys', h('p', {}, 'The study varies one key only.'));
    return;
  }
  const chosen = {across: keys[0], down: keys[1], score: study.standard_score, by: 'best'};
  const axis = (which) => axisOf(study, chosen[which]);
  const notes = h('div', {class: 'note', id: 'interactions'});
  const element = figure(
      'Heat map: what each pair of values of two keys reaches',
      () => heatDrawing(axis('across'), axis('down'), axis('score'), shown.rows, chosen.by),
      'The best setting with the pair of values over all other keys (or, if chosen, the mean of its runs). Framed: ' +
          'the best pair.');
  const say = () => notes.replaceChildren(...interactionNotes(study, shown.rows, axis('score')));
  const choose = (which, name) => {
    chosen[which] = name;
    element.redraw();
    say();
  };
  say();
  context.shown.listeners.push(say);
  section(
      'heatmap', 'Two keys',
      controls(
          choice('Across', keys, 0, (i) => choose('across', keys[i])),
          choice('Up', keys, 1, (i) => choose('down', keys[i])),
          scoreChoice(study, chosen.score, (name) => choose('score', name)), wayChoice((by) => choose('by', by))),
      notes, element);
  follow(context, element);
}
