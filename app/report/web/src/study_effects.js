// Main effects of a study: what each value of each varied key reaches.
import {controls, h} from './elements.js';
import {section} from './page.js';
import {dashedLine, figure, ink, lineColour, palette, plain} from './plots.js';
import {bestCell, bestSetting, levelOf, reached, settingsOf} from './settings.js';
import {isNumber} from './statistics.js';
import {axisOf, follow, levelTicks, namesOf, scoreChoice, sideTitle, wayChoice, wayWords} from './study_axes.js';

const many = 4000;    // points
const spread = 0.16;  // of a level's width, over which runs of one level are strewn

// The runs as dots, what each level comes to, and a star at the best, on the axes numbered n.
function effectTraces(axis, score, rows, by, n) {
  const level = (row) => axis.position.get(axis.of(row)), on = {xaxis: `x${n}`, yaxis: `y${n}`};
  const strewn = (row) => level(row) + spread * (((row.number * 0.618) % 1) - 0.5);
  const points = rows.filter((row) => isNumber(score.of(row)) && axis.of(row) !== null);
  const settings = settingsOf(points, score);
  const values =
      axis.levels.map((value) => reached(settings.filter((one) => levelOf(axis, one) === value), score.goal, by));
  const best = bestCell([values], score.goal);
  return [
    {
      type: points.length > many ? 'scattergl' : 'scatter',  // WebGL would lie over the line
      mode: 'markers',
      ...on,
      x: points.map(strewn),
      y: points.map(score.of),
      marker: {size: 4, color: palette.unclustered, opacity: 0.5},
      customdata: points.map((row) => row.number),
      hovertemplate: 'run %{customdata}: %{y:.4g}<extra></extra>',
    },
    {
      type: 'scatter',
      mode: 'lines+markers',
      ...on,
      x: axis.levels.map((_, k) => k),
      y: values,
      line: {color: lineColour(palette.modes[0]), width: 2.5},
      marker: {
        size: axis.levels.map((_, k) => (best && k === best.a ? 15 : 8)),
        symbol: axis.levels.map((_, k) => (best && k === best.a ? 'star' : 'circle')),
      },
      meta: 'main effect',
      text: axis.levels.map(plain),
      hovertemplate: `${axis.label} = %{text}: ${wayWords[by]} %{y:.5g}<extra></extra>`,
      connectgaps: true,
    },
  ];
}

// The range in which the levels differ: one bad level of another key must not press all lines together. Null: all.
function usefulRange(axes, score, rows, by) {
  const settings = settingsOf(rows, score);
  const values =
      axes.flatMap(
              (axis) => axis.levels.map(
                  (value) => reached(settings.filter((one) => levelOf(axis, one) === value), score.goal, by)))
          .filter(isNumber);
  if (!values.length) return null;
  const low = Math.min(...values), high = Math.max(...values), room = 0.5 * (high - low) || 0.1 * Math.abs(high) || 1;
  const all = settings.map((one) => one.mean);
  return [Math.max(low - room, Math.min(...all) - 0.1 * room), Math.min(high + room, Math.max(...all) + 0.2 * room)];
}

// Axes of panel j of columns times lines.
function panelAxes(axis, score, j, columns, lines) {
  const n = j === 0 ? '' : j + 1, column = j % columns, line = Math.floor(j / columns);
  const width = 1 / columns, height = 1 / lines;
  return {
    [`xaxis${n}`]: {
      ...levelTicks(axis),
      domain: [column * width + 0.02, (column + 1) * width - 0.02],
      anchor: `y${n}`,
      title: {text: axis.label},
      tickangle: axis.levels.length > 8 ? -45 : 0,
      range: [-0.5, axis.levels.length - 0.5],
    },
    [`yaxis${n}`]: {
      domain: [1 - (line + 1) * height + 0.14 * height, 1 - line * height],
      anchor: `x${n}`,
      matches: j ? 'y' : undefined,
      showticklabels: column === 0,
      title: column === 0 ? sideTitle(score) : undefined,
    },
  };
}

function effectsDrawing(axes, score, rows, by, wide) {
  const columns = Math.max(1, Math.min(axes.length, Math.floor(wide / 260)));
  const lines = Math.max(1, Math.ceil(axes.length / columns));
  const layout = {
    showlegend: false,
    annotations: [],
    height: 60 + 290 * lines,
    margin: {l: 70, r: 10, t: 10, b: 60},
    uirevision: `${score.name} ${by}`,
  };
  axes.forEach((axis, j) => Object.assign(layout, panelAxes(axis, score, j, columns, lines)));
  const range = usefulRange(axes, score, rows, by), best = bestSetting(settingsOf(rows, score), score.goal);
  if (range) layout.yaxis.range = range;
  if (best) layout.shapes = [dashedLine(best.mean, {line: {color: ink(), width: 1, dash: 'dot'}})];
  return {traces: axes.flatMap((axis, j) => effectTraces(axis, score, rows, by, j === 0 ? '' : j + 1)), layout};
}

export function drawEffects(context) {
  const {study, shown} = context;
  const axes = namesOf(study, 'varied').map((key) => axisOf(study, key)).filter((axis) => axis.levels.length > 1);
  let score = study.standard_score, by = 'best';
  const element = figure(
      'Main effects: what each value of each varied key reaches',
      () => effectsDrawing(axes, axisOf(study, score), shown.rows, by, element.clientWidth || 900),
      'Line: the best setting with that value over all other keys (or, if chosen, the mean of its runs); star: ' +
          'the best value; dotted: the best setting of all; dots: the runs, those far below outside the frame.');
  const pick = scoreChoice(study, score, (name) => {
    score = name;
    element.redraw();
  });
  const way = wayChoice((chosen) => {
    by = chosen;
    element.redraw();
  });
  const content = axes.length ? element : h('p', {}, 'No key has more than one value.');
  section('effects', 'Main effects', controls(pick, way), content);
  follow(context, element);
}
