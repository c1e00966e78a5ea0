// Main effects of a study: the mean score for each value of each varied key.
import {controls, h} from './elements.js';
import {section} from './page.js';
import {dashedLine, figure, ink, palette} from './plots.js';
import {isNumber, mean} from './statistics.js';
import {axisOf, follow, levelTicks, namesOf, scoreChoice} from './study_axes.js';

const spread = 0.16;  // of a level's width, over which runs of one level are strewn

// The runs as dots and their mean at each level, on the axes numbered n.
function effectTraces(axis, score, rows, n) {
  const level = (row) => axis.position.get(axis.of(row)), on = {xaxis: `x${n}`, yaxis: `y${n}`};
  const strewn = (row) => level(row) + spread * (((row.number * 0.618) % 1) - 0.5);
  const points = rows.filter((row) => isNumber(score.of(row)) && axis.of(row) !== null);
  const means = axis.levels.map((_, k) => {
    const here = points.filter((row) => level(row) === k).map(score.of);
    return here.length ? mean(here) : null;
  });
  return [
    {
      type: 'scattergl',
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
      y: means,
      line: {color: palette.modes[0], width: 2.5},
      marker: {size: 8},
      meta: 'main effect',
      hovertemplate: 'mean %{y:.5g}<extra></extra>',
      connectgaps: true,
    },
  ];
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
      range: [-0.5, axis.levels.length - 0.5],
    },
    [`yaxis${n}`]: {
      domain: [1 - (line + 1) * height + 0.14 * height, 1 - line * height],
      anchor: `x${n}`,
      matches: j ? 'y' : undefined,
      showticklabels: column === 0,
      title: column === 0 ? {text: score.label} : undefined,
    },
  };
}

function effectsDrawing(axes, score, rows, wide) {
  const columns = Math.max(1, Math.min(axes.length, Math.floor(wide / 260)));
  const lines = Math.max(1, Math.ceil(axes.length / columns));
  const all = rows.map(score.of).filter(isNumber);
  const layout = {
    showlegend: false,
    annotations: [],
    height: 60 + 290 * lines,
    margin: {l: 70, r: 10, t: 10, b: 60},
  };
  axes.forEach((axis, j) => Object.assign(layout, panelAxes(axis, score, j, columns, lines)));
  if (all.length) layout.shapes = [dashedLine(mean(all), {line: {color: ink(), width: 1, dash: 'dot'}})];
  return {traces: axes.flatMap((axis, j) => effectTraces(axis, score, rows, j === 0 ? '' : j + 1)), layout};
}

export function drawEffects(context) {
  const {study, shown} = context;
  const axes = namesOf(study, 'varied').map((key) => axisOf(study, key)).filter((axis) => axis.levels.length > 1);
  let score = study.standard_score;
  const element = figure(
      'Main effects: the mean score for each value of each varied key',
      () => effectsDrawing(axes, axisOf(study, score), shown.rows, element.clientWidth || 900),
      'Line: mean over the runs shown, whatever their other keys; dots: the runs; dotted: mean of all.');
  const pick = scoreChoice(study, score, (name) => {
    score = name;
    element.redraw();
  });
  const content = axes.length ? element : h('p', {}, 'No key has more than one value.');
  section('effects', 'Main effects', controls(pick), content);
  follow(context, element);
}
