// What the filter said of every sample, and whether to believe it.
import { choice, h, note, section, table } from './common.js';
import { figure, filterColour, ink, palette } from './plots.js';
import { filterNames, roleNames, shortNames } from './filters.js';
import { innovationRow, nisRow, probabilityRow, stateRow } from './run_rows.js';
import { timeControls, timePlot } from './timeview.js';

const present = (list, key) => [...new Set(list.map((row) => row[key]))];

function histogram(filter) {
  const roles = present(filter.histograms, 'role'), state = { role: roles[0] };
  const list = () => filter.histograms.filter((row) => row.role === state.role);
  const plot = figure('Histogram of probability integral transforms for each filter; equal bars mean true uncertainty', () => {
    const rows = list(), layout = { height: 200 * rows.length + 40, margin: { l: 64, r: 12, t: 40, b: 44 }, showlegend: false, shapes: [], annotations: [], bargap: 0.06 }, traces = [];
    rows.forEach((row, i) => {
      const n = i ? i + 1 : '', bins = row.counts.length, top = 1 - i / rows.length, bottom = 1 - (i + 1) / rows.length;
      layout[`yaxis${n}`] = { title: { text: 'samples' }, domain: [bottom + (i < rows.length - 1 ? 0.1 : 0), top - 0.02], rangemode: 'tozero', nticks: 4 };
      layout[`xaxis${n}`] = { range: [0, 1], anchor: `y${n}`, title: i === rows.length - 1 ? { text: 'PIT' } : undefined, nticks: 6 };
      traces.push({ type: 'bar', x: row.counts.map((_, b) => (b + 0.5) / bins), y: row.counts, width: 0.94 / bins, marker: { color: filterColour(row.filter) }, xaxis: `x${n}`, yaxis: `y${n}`, text: row.counts.map((c, b) => `${b / bins} to ${(b + 1) / bins}: ${c} samples`), textposition: 'none', hoverinfo: 'text' });
      layout.shapes.push({ type: 'rect', xref: `x${n}`, yref: `y${n}`, x0: 0, x1: 1, y0: row.band[0], y1: row.band[1], fillcolor: ink(), opacity: 0.16, line: { width: 0 } },
        { type: 'line', xref: `x${n}`, yref: `y${n}`, x0: 0, x1: 1, y0: row.expected, y1: row.expected, line: { color: ink(), width: 1, dash: 'dash' } });
      layout.annotations.push({ text: filterNames[row.filter], xref: `x${n} domain`, yref: `y${n} domain`, x: 0, y: 1, xanchor: 'left', yanchor: 'bottom', showarrow: false, font: { size: 12 } });
    });
    return { traces, layout };
  }, 'Grey: where 95 % of a true filter’s bars lie. High ends: overconfident; high middle: underconfident.');
  return [h('h3', {}, 'Probability transforms (PIT)'), roles.length > 1 ? h('div', { class: 'controls' }, choice('Runs', roles.map((role) => roleNames[role]), 0, (i) => { state.role = roles[i]; plot.redraw(); })) : null, plot];
}

function autocorrelation(filter, states) {
  if (!filter.autocorrelations.length) return [];
  const roles = present(filter.autocorrelations, 'role'), state = { role: roles[0], i: 0 };
  const plot = figure('Autocorrelation of the residuals for each model; within the band they are white', () => {
    const rows = filter.autocorrelations.filter((row) => row.role === state.role), traces = rows.map((row) => {
      const y = row.states[state.i].slice(1);
      return { type: 'scatter', mode: 'lines+markers', name: shortNames[row.model] || row.model, x: y.map((_, lag) => lag + 1), y, line: { color: filterColour(row.model), width: 1.5 }, marker: { size: 5 }, hovertemplate: 'lag %{x}: %{y:.3f}' };
    });
    const band = rows[0].band;
    const layout = { height: 350, margin: { l: 64, r: 12, t: 60, b: 44 }, legend: { orientation: 'h', y: 1.02, yanchor: 'bottom' }, showlegend: true, xaxis: { title: { text: 'lag [samples]' } }, yaxis: { title: { text: 'autocorrelation' } },
      shapes: [{ type: 'rect', xref: 'paper', x0: 0, x1: 1, y0: -band, y1: band, fillcolor: ink(), opacity: 0.14, line: { width: 0 }, layer: 'below' }] };
    return { traces, layout };
  }, `Grey: ${100 * filter.autocorrelations[0].level} % band of white residuals. Filters: normal scores of the PIT; global model: its one-step residuals.`);
  return [h('h3', {}, 'Residual autocorrelation'), h('div', { class: 'controls' }, roles.length > 1 ? choice('Runs', roles.map((role) => roleNames[role]), 0, (i) => { state.role = roles[i]; plot.redraw(); }) : null,
    states.length > 1 ? choice('State', states.map((channel) => channel.name), 0, (i) => { state.i = i; plot.redraw(); }) : null), plot];
}

// The paper's figure 5: how many samples lie outside the interval, above and below, training and held out.
function outside(filter) {
  const measures = [['tail', 'PIT'], ['nis', 'NIS']], state = { measure: 0 }, pooled = filter.scores.filter((row) => row.run === '*'), roles = present(pooled, 'role'), filters = present(pooled, 'filter');
  const plot = figure('Shares of samples outside the 95 % interval, above and below, for each filter; the table of scores holds the same numbers', () => {
    const [key] = measures[state.measure], traces = [];
    for (const side of ['above', 'below'])
      for (const role of roles) {
        const rows = filters.map((name) => pooled.find((row) => row.filter === name && row.role === role)).filter(Boolean);
        traces.push({ type: 'bar', name: `${side}, ${role === 'test' ? 'held out' : 'training'}`, x: rows.map((row) => shortNames[row.filter]), y: rows.map((row) => 100 * row[`${key}_${side}`].v), text: rows.map((row) => `${side}, ${roleNames[role]}: ${row[`${key}_${side}`].t}`), textposition: 'none', hoverinfo: 'text',
          marker: { color: palette.modes[side === 'above' ? 3 : 5], opacity: role === 'test' ? 1 : 0.65, pattern: { shape: role === 'test' ? '' : '/' } } });
      }
    return { traces, layout: { height: 380, margin: { l: 64, r: 12, t: 76, b: 40 }, barmode: 'group', showlegend: true, legend: { orientation: 'h', y: 1.02, yanchor: 'bottom' }, xaxis: { type: 'category' }, yaxis: { title: { text: 'samples outside [%]' }, rangemode: 'tozero' },
      shapes: [{ type: 'line', xref: 'paper', x0: 0, x1: 1, y0: 100 * filter.tail, y1: 100 * filter.tail, line: { color: ink(), width: 1.2, dash: 'dash' } }] } };
  }, 'Dashed: a true filter’s 2.5 % on each side.');
  return [h('h3', {}, 'Samples outside the interval'), h('div', { class: 'controls' }, choice('By', measures.map(([, name]) => name), 0, (i) => { state.measure = i; plot.redraw(); })), plot];
}

function scores(filter) {
  const rows = filter.scores, cell = (key) => (row) => row[key], columns = [{ name: 'Filter', text: true, of: (row) => shortNames[row.filter], swatch: (row) => filterColour(row.filter) }, { name: 'Runs', text: true, of: (row) => (row.role === 'test' ? 'held out' : 'training') },
    { name: 'Run', text: true, of: (row) => (row.run === '*' ? 'all' : row.run) }, { name: 'Samples', of: cell('samples') }, { name: 'Log score [nats]', of: cell('log_score') }, { name: filter.rmse_name, of: cell('rmse') }, { name: 'PIT above', of: cell('tail_above') }, { name: 'PIT below', of: cell('tail_below') },
    { name: 'NIS above', of: cell('nis_above') }, { name: 'NIS below', of: cell('nis_below') }, { name: 'mean NIS', of: cell('nis_mean') }, { name: 'PIT distance', of: cell('pit_distance') }, { name: 'white p', of: cell('whiteness_p') }];
  const shown = table(columns, rows.filter((row) => row.run === '*'), { caption: 'Scores, all runs together', sortable: true });
  const each = h('details', {}, h('summary', {}, 'Scores run by run'), table(columns, rows.filter((row) => row.run !== '*'), { caption: 'Scores run by run', sortable: true }));
  const verdicts = filter.verdicts.length ? table([{ name: 'Filter', text: true, of: (row) => shortNames[row.filter], swatch: (row) => filterColour(row.filter) }, { name: 'Runs', text: true, of: (row) => roleNames[row.role] }, { name: 'Uncertainty', text: true, of: (row) => row.verdict },
    { name: 'PIT above', of: (row) => row.tail_above }, { name: 'PIT below', of: (row) => row.tail_below }, { name: 'mean NIS [true filter]', of: (row) => row.nis_mean }, { name: 'Stands out', prose: true, of: (row) => row.flags }], filter.verdicts, { caption: 'Is the stated uncertainty true (95 % intervals in brackets)' }) : null;
  const ahead = filter.horizons.length ? table([{ name: 'Filter', text: true, of: (row) => shortNames[row.filter], swatch: (row) => filterColour(row.filter) }, { name: 'Runs', text: true, of: (row) => roleNames[row.role] }, { name: 'Ahead [samples]', of: (row) => row.horizon }, { name: 'Samples', of: (row) => row.samples }, { name: 'Log score [nats]', of: (row) => row.log_score }, { name: filter.rmse_name, of: (row) => row.rmse }],
    filter.horizons, { caption: 'Predictions several samples ahead', sortable: true }) : null;
  return [h('h3', {}, 'Scores'), shown, each, verdicts, ahead];
}

export function drawFilter(filter, runs, state, options, picker) {
  if (!filter) return section('filter', 'The filter', note('This archive holds no evaluation: no filter was run over the data.'));
  const n = runs.states.length, rows = () => [stateRow(runs, options.state, { ...options, height: 170 }), ...(state.current.filters[options.filter()]?.probability ? [probabilityRow(options)] : []), innovationRow(runs, options.state, options), nisRow(runs, options)];
  const plot = timePlot(state, 'Mode probabilities, innovations and NIS of one run over time', rows,
    `Blue lines about the innovations: ${100 * runs.level} % of a Gaussian of their variance. Dashed lines at the NIS: both bounds that a true filter’s stays between with 95 %.`);
  const controls = h('div', { class: 'controls' }, picker(), n > 1 ? choice('State', runs.states.map((channel) => channel.name), 0, (i) => { options.state = i; state.changed(); }) : null, timeControls(state));
  const modes = state.runs.map((run) => run.filters.bank?.probability?.length || 0).reduce((a, b) => Math.max(a, b), 0);
  return section('filter', 'The filter', controls, modes > 1 ? options.modeLegend(modes) : null, plot, h('div', { class: 'pair' }, h('div', {}, histogram(filter)), h('div', {}, autocorrelation(filter, runs.states), outside(filter))), scores(filter));
}
