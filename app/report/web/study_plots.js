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
  const { study, shown, restrict } = context;
  const keys = names(study, 'varied'), kept = new Map();  // ranges dragged along an axis, by its name
  let score = study.standard_score, axes = [];
  const element = figure('Parallel coordinates: every run is a line through its varied keys and its score', () => {
    axes = [...keys, score].map((key) => axisOf(study, key));
    const last = axes[axes.length - 1], rows = shown.base.filter((row) => isNumber(last.of(row)));
    // Levels stand at equal distances: keys such as 1, 10, 100 or words would otherwise crowd.
    const dimensions = axes.map((axis) => (axis === last ? { label: axis.label, values: rows.map(axis.of) }
      : { label: axis.label, range: [0, Math.max(1, axis.levels.length - 1)], tickvals: axis.levels.map((l, k) => k), ticktext: axis.levels.map((level) => plain(level)), values: rows.map((row) => axis.position.get(axis.of(row))) }));
    dimensions.forEach((dimension, i) => { if (kept.has(axes[i].name)) dimension.constraintrange = kept.get(axes[i].name); });
    return { traces: [{ type: 'parcoords', dimensions, labelangle: -12, labelfont: { color: ink() }, tickfont: { color: ink() }, rangefont: { color: ink() },
      line: { color: rows.map(last.of), colorscale: 'Cividis', showscale: true, colorbar: { title: { text: last.label, side: 'right' }, thickness: 12 } } }],
    layout: { height: 440, margin: { l: 70, r: 30, t: 90, b: 30 } } };
  }, 'Drag along an axis to keep the runs that pass there; click the axis to keep all again.');
  // What was dragged filters the table and the plots below.
  const dragged = () => {
    kept.clear();
    element.plot.data[0].dimensions.forEach((dimension, i) => { if (dimension.constraintrange && dimension.constraintrange.length) kept.set(axes[i].name, dimension.constraintrange); });
    const tests = axes.filter((axis) => kept.has(axis.name)).map((axis, i, list) => {
      const ranges = Array.isArray(kept.get(axis.name)[0]) ? kept.get(axis.name) : [kept.get(axis.name)];
      const of = axis.name === score ? axis.of : (row) => axis.position.get(axis.of(row));
      return (row) => ranges.some(([low, high]) => of(row) >= low && of(row) <= high);
    });
    restrict(tests.length ? (row) => tests.every((test) => test(row)) : null);
  };
  element.ready.then(() => element.plot.on('plotly_restyle', dragged));
  const { control } = scoreChoice(study, score, (name) => { kept.delete(score); score = name; element.redraw(); });
  section('parallel', 'Parallel coordinates', h('div', { class: 'controls' }, control), element);
  shown.listeners.push((own) => { if (!own && element.plot.querySelector('.main-svg')) element.redraw(); });
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
    const small = x.levels.length * y.levels.length <= 150, known = cells.flat().filter(isNumber), middle = (Math.min(...known) + Math.max(...known)) / 2;
    const labels = cells.flatMap((line, b) => line.flatMap((cell, a) => (cell === null ? [] : [{ x: a, y: b, text: cell.toPrecision(4), showarrow: false, font: { size: 11, color: cell > middle ? '#111111' : '#ffffff' } }])));
    return { traces: [{ type: 'heatmap', z: cells, x: x.levels.map((l, k) => k), y: y.levels.map((l, k) => k), colorscale: 'Cividis', xgap: 1, ygap: 1, hoverongaps: false,
      text: cells.map((line, b) => line.map((cell, a) => `${x.label} = ${plain(x.levels[a])}<br>${y.label} = ${plain(y.levels[b])}<br>mean ${cell === null ? '–' : cell.toPrecision(4)}`)), hoverinfo: 'text',
      colorbar: { title: { text: z.label, side: 'right' }, thickness: 12 } }],
    layout: { annotations: small ? labels : [], height: Math.min(700, 140 + 42 * y.levels.length), margin: { l: 90, r: 10, t: 10, b: 60 },
      xaxis: { tickvals: x.levels.map((l, k) => k), ticktext: x.levels.map((l) => plain(l)), title: { text: x.label }, showgrid: false },
      yaxis: { tickvals: y.levels.map((l, k) => k), ticktext: y.levels.map((l) => plain(l)), title: { text: y.label }, showgrid: false } } };
  }, 'Mean over the runs shown that have the pair of values, whatever their other keys.');
  const { control } = scoreChoice(study, score, (name) => { score = name; element.redraw(); });
  section('heatmap', 'Two keys', h('div', { class: 'controls' }, choice('Across', keys, 0, (i) => { across = keys[i]; element.redraw(); }),
    choice('Up', keys, 1, (i) => { down = keys[i]; element.redraw(); }), control), element);
  follow(context, element);
}

// How bad a score is by its goal (study_page.cpp): the smaller the better.
const lossOf = (goal, score) => (!goal || goal.kind === 'higher' ? -score : goal.kind === 'lower' ? score : Math.abs(score - goal.nominal));

// Points {x, loss} that no other point beats in both.
export function paretoFront(points) {
  const front = [];
  for (const point of [...points].sort((a, b) => a.x - b.x || a.loss - b.loss)) if (!front.length || point.loss < front[front.length - 1].loss) front.push(point);
  return front;
}

export function drawPareto(context) {
  const { study, shown, showRun } = context;
  const costs = names(study, 'cost').concat(names(study, 'varied').filter((key) => axisOf(study, key).numeric), names(study, 'score'));
  let cost = costs[0], score = study.standard_score;
  const element = figure('Pareto plot: score against number of modes, the front marked', () => {
    const x = axisOf(study, cost), y = axisOf(study, score), goal = study.columns.find((column) => column.name === score).goal;
    const points = shown.rows.filter((row) => isNumber(x.of(row)) && isNumber(y.of(row))).map((row) => ({ x: x.of(row), y: y.of(row), loss: lossOf(goal, y.of(row)), row }));
    const front = paretoFront(points);
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

// The paper's figure 5: samples outside the interval, above and below, training and held out, over the values of a key.
export function drawCoverage(context) {
  const { study, shown } = context;
  const scores = names(study, 'score'), measures = [['nis', 'NIS'], ['tail', 'PIT']].filter(([key]) => scores.includes(`bank_test_${key}_above`) || scores.includes(`bank_train_${key}_above`));
  const keys = names(study, 'varied');
  if (!measures.length || !keys.length) { section('coverage', 'Samples outside the interval', h('p', {}, 'The study has no such scores.')); return; }
  let key = keys[first(keys, 'mixture.components')], measure = measures[0];
  const element = figure('Shares of samples outside the 95 % interval, above and below, training and held out, for the baseline, noise only and each value of a key', () => {
    const axis = axisOf(study, key), runs = shown.rows, traces = [];
    const average = (rows, score) => { const of = axisOf(study, score).of, values = scores.includes(score) ? rows.map(of).filter(isNumber) : []; return values.length ? 100 * mean(values) : null; };
    const groups = [['baseline', 'baseline', runs], ['noise only', 'noise_only', runs], ...axis.levels.map((level) => [String(level), 'bank', runs.filter((row) => axis.of(row) === level)])];
    for (const [side, sign] of [['above', 1], ['below', -1]])
      for (const [role, title, colour] of [['train', 'training', palette.modes[0]], ['test', 'held out', palette.modes[1]]]) {
        const y = groups.map(([, filter, rows]) => average(rows, `${filter}_${role}_${measure[0]}_${side}`));
        traces.push({ type: 'bar', name: title, legendgroup: title, showlegend: sign > 0, offsetgroup: role, x: groups.map(([name], i) => i), y: y.map((v) => (v === null ? null : sign * v)), meta: `${role} ${side}`,
          text: y.map((v, i) => `${plain(groups[i][0])}, ${title}, ${side}: ${v === null ? '–' : v.toPrecision(4)} %`), textposition: 'none', hoverinfo: 'text', marker: { color: colour } });
      }
    const line = (y) => ({ type: 'line', xref: 'paper', x0: 0, x1: 1, y0: y, y1: y, line: { color: ink(), width: 1, dash: 'dash' } });
    return { traces, layout: { height: 380, barmode: 'group', legend: { orientation: 'h', y: 1.1 }, shapes: [line(2.5), line(-2.5)], margin: { l: 60, r: 10, t: 30, b: 60 },
      xaxis: { tickvals: groups.map((g, i) => i), ticktext: groups.map(([name]) => plain(name)), title: { text: `filter, then the bank by ${axis.label}` } }, yaxis: { title: { text: `${measure[1]} below | above [%]` }, zeroline: true, zerolinewidth: 2 } } };
  }, 'Means over the runs shown. Dashed: 2.5 % on either side, as a true filter has.');
  section('coverage', 'Samples outside the interval', h('div', { class: 'controls' }, choice('Over', keys, keys.indexOf(key), (i) => { key = keys[i]; element.redraw(); }),
    choice('By', measures.map(([, name]) => name), 0, (i) => { measure = measures[i]; element.redraw(); })), element);
  follow(context, element);
}
