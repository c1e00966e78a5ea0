// Plots of a study: parallel coordinates, main effects, heat map of two keys, Pareto plot. All follow the table's filters.
import { choice, h, section } from './common.js';
import { figure, ink, palette, plain } from './plots.js';

const cellValue = (cell) => (cell && typeof cell === 'object' ? cell.v : cell);
const mean = (values) => values.reduce((a, b) => a + b, 0) / values.length;
const isNumber = (v) => typeof v === 'number' && Number.isFinite(v);

// Values of a column over the study, in the order the study gave them; numbers where all are.
function axisOf(study, name) {
  const i = study.columns.findIndex((column) => column.name === name);
  const of = (row) => cellValue(row.cells[i]);
  const numeric = study.rows.every((row) => of(row) === null || isNumber(of(row)));
  const levels = [...new Set(study.rows.map(of).filter((v) => v !== null))];
  if (numeric) levels.sort((a, b) => a - b);
  const position = new Map(levels.map((level, k) => [level, k]));
  return { name, of, numeric, levels, position, label: plain(name) };
}

const names = (study, kind) => study.columns.filter((column) => column.kind === kind).map((column) => column.name);
const first = (list, wanted) => Math.max(0, list.indexOf(wanted));

function scoreChoice(study, begin, onchange) {
  const scores = names(study, 'score');
  return { scores, control: choice('Score', scores, first(scores, begin), (i) => onchange(scores[i])) };
}

function follow(context, element) { context.shown.listeners.push(() => { if (element.plot.querySelector('.main-svg')) element.redraw(); }); }

export function drawParallel(context) {
  const { study, shown } = context;
  const keys = names(study, 'varied');
  let score = study.standard_score;
  const element = figure('Parallel coordinates: every run is a line through its varied keys and its score', () => {
    const axes = keys.map((key) => axisOf(study, key)), last = axisOf(study, score);
    const rows = shown.rows.filter((row) => isNumber(last.of(row)));
    // Levels stand at equal distances: keys such as 1, 10, 100 or words would otherwise crowd.
    const dimensions = axes.map((axis) => ({ label: axis.label, range: [0, Math.max(1, axis.levels.length - 1)], tickvals: axis.levels.map((l, k) => k),
      ticktext: axis.levels.map((level) => plain(level)), values: rows.map((row) => axis.position.get(axis.of(row))) }));
    dimensions.push({ label: last.label, values: rows.map(last.of) });
    const values = rows.map(last.of);
    return { traces: [{ type: 'parcoords', dimensions, labelangle: -12, labelfont: { color: ink() }, tickfont: { color: ink() }, rangefont: { color: ink() },
      line: { color: values, colorscale: 'Cividis', reversescale: false, showscale: true, colorbar: { title: { text: last.label, side: 'right' }, thickness: 12 } } }],
    layout: { height: 440, margin: { l: 70, r: 30, t: 90, b: 30 } } };
  }, 'Drag along an axis to keep the runs that pass there.');
  const { control } = scoreChoice(study, score, (name) => { score = name; element.redraw(); });
  section('parallel', 'Parallel coordinates', h('div', { class: 'controls' }, control), element);
  follow(context, element);
}

export function drawEffects(context) {
  const { study, shown } = context;
  const keys = names(study, 'varied').filter((key) => axisOf(study, key).levels.length > 1);
  let score = study.standard_score;
  const element = figure('Main effects: the mean score for each value of each varied key', () => {
    const score_axis = axisOf(study, score), traces = [], layout = { showlegend: false, annotations: [] };
    const columns = Math.max(1, Math.min(keys.length, Math.floor((element.clientWidth || 900) / 260))), lines = Math.max(1, Math.ceil(keys.length / columns));
    const all = shown.rows.map(score_axis.of).filter(isNumber);
    keys.forEach((key, j) => {
      const axis = axisOf(study, key), at = j === 0 ? '' : j + 1, column = j % columns, line = Math.floor(j / columns);
      const points = shown.rows.filter((row) => isNumber(score_axis.of(row)) && axis.of(row) !== null);
      const level = (row) => axis.position.get(axis.of(row));
      const spread = (row) => level(row) + 0.16 * (((row.number * 0.618) % 1) - 0.5);
      traces.push({ type: 'scattergl', mode: 'markers', xaxis: `x${at}`, yaxis: `y${at}`, x: points.map(spread), y: points.map(score_axis.of), marker: { size: 4, color: palette.unclustered, opacity: 0.5 },
        customdata: points.map((row) => row.number), hovertemplate: 'run %{customdata}: %{y:.4g}<extra></extra>' });
      const means = axis.levels.map((l, k) => { const here = points.filter((row) => level(row) === k).map(score_axis.of); return here.length ? mean(here) : null; });
      traces.push({ type: 'scatter', mode: 'lines+markers', xaxis: `x${at}`, yaxis: `y${at}`, x: axis.levels.map((l, k) => k), y: means, line: { color: palette.modes[0], width: 2.5 }, marker: { size: 8 },
        meta: 'main effect', hovertemplate: `mean %{y:.5g}<extra></extra>`, connectgaps: true });
      const width = 1 / columns, height = 1 / lines;
      layout[`xaxis${at}`] = { domain: [column * width + 0.02, (column + 1) * width - 0.02], anchor: `y${at}`, tickvals: axis.levels.map((l, k) => k), ticktext: axis.levels.map((l) => plain(l)),
        title: { text: axis.label }, range: [-0.5, axis.levels.length - 0.5] };
      layout[`yaxis${at}`] = { domain: [1 - (line + 1) * height + 0.14 * height, 1 - line * height], anchor: `x${at}`, matches: j ? 'y' : undefined, showticklabels: column === 0,
        title: column === 0 ? { text: score_axis.label } : undefined };
    });
    if (all.length) layout.shapes = [{ type: 'line', xref: 'paper', x0: 0, x1: 1, y0: mean(all), y1: mean(all), line: { color: ink(), width: 1, dash: 'dot' } }];
    return { traces, layout: { ...layout, height: 60 + 290 * lines, margin: { l: 70, r: 10, t: 10, b: 60 } } };
  }, 'Line: mean over the runs shown, whatever their other keys; dots: the runs; dotted: mean of all.');
  const { control } = scoreChoice(study, score, (name) => { score = name; element.redraw(); });
  section('effects', 'Main effects', h('div', { class: 'controls' }, control), keys.length ? element : h('p', {}, 'No key has more than one value.'));
  follow(context, element);
}

export function drawHeatMap(context) {
  const { study, shown } = context;
  const keys = names(study, 'varied');
  if (keys.length < 2) { section('heatmap', 'Two keys', h('p', {}, 'The study varies one key only.')); return; }
  let across = keys[0], down = keys[1], score = study.standard_score;
  const element = figure('Heat map: the mean score for each pair of values of two keys', () => {
    const x = axisOf(study, across), y = axisOf(study, down), z = axisOf(study, score);
    const cells = y.levels.map((b) => x.levels.map((a) => {
      const here = shown.rows.filter((row) => x.of(row) === a && y.of(row) === b).map(z.of).filter(isNumber);
      return here.length ? mean(here) : null;
    }));
    const small = x.levels.length * y.levels.length <= 150;
    return { traces: [{ type: 'heatmap', z: cells, x: x.levels.map((l, k) => k), y: y.levels.map((l, k) => k), colorscale: 'Cividis', xgap: 1, ygap: 1, hoverongaps: false,
      text: cells.map((line, b) => line.map((cell, a) => `${x.label} = ${plain(x.levels[a])}<br>${y.label} = ${plain(y.levels[b])}<br>mean ${cell === null ? '–' : cell.toPrecision(4)}`)), hoverinfo: 'text',
      texttemplate: small ? '%{z:.3g}' : undefined, colorbar: { title: { text: z.label, side: 'right' }, thickness: 12 } }],
    layout: { height: Math.min(700, 140 + 42 * y.levels.length), margin: { l: 90, r: 10, t: 10, b: 60 },
      xaxis: { tickvals: x.levels.map((l, k) => k), ticktext: x.levels.map((l) => plain(l)), title: { text: x.label }, showgrid: false },
      yaxis: { tickvals: y.levels.map((l, k) => k), ticktext: y.levels.map((l) => plain(l)), title: { text: y.label }, showgrid: false } } };
  }, 'Mean over the runs shown that have the pair of values, whatever their other keys.');
  const { control } = scoreChoice(study, score, (name) => { score = name; element.redraw(); });
  section('heatmap', 'Two keys', h('div', { class: 'controls' }, choice('Across', keys, 0, (i) => { across = keys[i]; element.redraw(); }),
    choice('Up', keys, 1, (i) => { down = keys[i]; element.redraw(); }), control), element);
  follow(context, element);
}

// Runs that no other run beats in both: fewer (or equal) of x, a better (or equal) score.
export function paretoFront(points, higherIsBetter) {
  const sign = higherIsBetter ? 1 : -1;
  const sorted = [...points].sort((a, b) => a.x - b.x || sign * (b.y - a.y));
  const front = [];
  for (const point of sorted) if (!front.length || sign * point.y > sign * front[front.length - 1].y) front.push(point);
  return front;
}

export function drawPareto(context) {
  const { study, shown, showRun } = context;
  const costs = names(study, 'cost').concat(names(study, 'varied').filter((key) => axisOf(study, key).numeric), names(study, 'score'));
  let cost = costs[0], score = study.standard_score;
  const element = figure('Pareto plot: score against number of modes, the front marked', () => {
    const x = axisOf(study, cost), y = axisOf(study, score), higher = study.columns.find((column) => column.name === score).higher;
    const points = shown.rows.filter((row) => isNumber(x.of(row)) && isNumber(y.of(row))).map((row) => ({ x: x.of(row), y: y.of(row), row }));
    const front = paretoFront(points, higher);
    const hover = (row) => study.varied.map(({ key }, i) => `${plain(key)} = ${plain(row.varied[i])}`).join('<br>');
    const trace = (list, more) => ({ type: 'scattergl', x: list.map((p) => p.x), y: list.map((p) => p.y), customdata: list.map((p) => p.row.number), text: list.map((p) => hover(p.row)),
      hovertemplate: 'run %{customdata}<br>%{text}<br>%{x:.5g}, %{y:.5g}<extra></extra>', ...more });
    return { traces: [trace(points, { name: 'runs', mode: 'markers', marker: { size: 7, color: palette.unclustered, opacity: 0.6 } }),
      trace(front, { name: 'front', mode: 'lines+markers', line: { shape: 'hv', color: palette.modes[3], width: 2 }, marker: { size: 10, color: palette.modes[3] } })],
    layout: { height: 420, xaxis: { title: { text: x.label } }, yaxis: { title: { text: y.label } }, legend: { orientation: 'h', y: 1.08 } } };
  }, 'Front: runs that no other run beats in the score with as few or fewer. Click a run to see it.');
  element.ready.then(() => element.plot.on('plotly_click', (event) => showRun(study.rows[event.points[0].customdata])));
  const { control } = scoreChoice(study, score, (name) => { score = name; element.redraw(); });
  section('pareto', 'Pareto plot', h('div', { class: 'controls' }, choice('Cost', costs, 0, (i) => { cost = costs[i]; element.redraw(); }), control), element);
  follow(context, element);
}
