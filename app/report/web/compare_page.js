// Two runs on one page: A and B have one colour each in every plot.
import { array, choice, copyButton, data, draw, facts, h, head, note, section, table, value } from './common.js';
import { roleNames, shortNames } from './filters.js';
import { figure, ink, palette, plain, translucent } from './plots.js';
import { inputRows, probabilityRow } from './run_rows.js';
import { band, line } from './signals.js';
import { TimeState, timeControls, timePlot } from './timeview.js';

const letters = ['A', 'B'], colours = [palette.modes[0], palette.modes[3]], dashes = ['solid', 'dash'];
const names = data.runs.map((run) => run.name);
const legend = (extra = []) => h('ul', { class: 'legend', 'aria-label': 'Colours' }, [...letters.map((letter, i) => [colours[i], `${letter}: ${names[i]}`]), ...extra]
  .map(([colour, text]) => h('li', {}, h('span', { class: 'swatch', style: `background:${colour}` }), text)));

function drawDifferences() {
  const rows = data.differences, deciding = rows.filter((row) => row.decides), others = rows.filter((row) => !row.decides);
  const columns = [{ name: 'Setting', text: true, of: (row) => row.key }, ...letters.map((letter, i) => ({ name: letter, text: true, of: (row) => row.values[i] }))];
  section('differences', 'What differs', legend(),
    deciding.length ? table(columns, deciding, { caption: 'Settings that differ and decide the numbers' }) : note('No setting that decides a number differs.'),
    others.length ? h('details', {}, h('summary', {}, `${others.length} differing settings that decide no number`), table(columns, others, { caption: 'Other settings' })) : null,
    data.same_data ? null : note('The data differ: their hashes are not the same.', true),
    letters.map((letter, i) => h('details', {}, h('summary', {}, `Where ${letter} comes from`), facts([['File', names[i]], ['Command', h('code', {}, data.runs[i].origin.command)],
      ['Made', `${data.runs[i].origin.created} by modebank ${data.runs[i].origin.version}`], ['Data', h('code', {}, data.runs[i].origin.data_hash)]]),
    copyButton(`Copy the configuration of ${letter}`, data.runs[i].origin.config))));
}

function drawScores() {
  const columns = [{ name: 'Filter', text: true, of: (row) => shortNames[row.filter] }, { name: 'Runs', text: true, of: (row) => roleNames[row.role] }, { name: 'Score', text: true, of: (row) => row.score },
    { name: 'A', of: (row) => row.values[0], swatch: () => colours[0] }, { name: 'B', of: (row) => row.values[1], swatch: () => colours[1] }, { name: 'B − A', of: (row) => row.difference },
    { name: 'Better', text: true, of: (row) => (row.better === null ? 'equal' : letters[row.better]) }];
  section('verdict', 'Verdict', h('p', { class: 'verdict' }, data.verdict),
    data.scores.length ? table(columns, data.scores, { caption: 'Scores side by side, all runs of a role together', sortable: true }) : note('Not both hold scores.'));
}

// Runs that both hold, with as many samples: the data are A's.
function commonRuns() {
  const [a, b] = data.runs.map((run) => (run.data ? run.data.runs : []));
  return a.flatMap((run) => {
    const other = b.find((candidate) => candidate.name === run.name && candidate.time.samples === run.time.samples && candidate.state.length === run.state.length);
    return other ? [{ ...run, pair: [run.filters.bank, other.filters.bank] }] : [];
  });
}
const stroke = (i, width = 1.4) => ({ color: colours[i], width, dash: dashes[i], simplify: true });
const titleOf = (channel) => plain(channel.unit ? `${channel.name} [${channel.unit}]` : channel.name);

function stateRow(channels, i) {
  return { title: titleOf(channels[i]), height: 240, draw: async ({ run, clock, shown }) => {
    const traces = [];
    for (const [k, filter] of run.pair.entries()) {
      if (!filter) continue;
      const outline = await band(filter.prediction[i], filter.half_width[i], filter.lower[i], filter.upper[i], clock, shown);
      traces.push({ ...outline, type: 'scatter', mode: 'lines', fill: 'toself', fillcolor: translucent(colours[k], 0.2), line: { width: 0 }, hoverinfo: 'skip', name: `${letters[k]} band` });
      traces.push({ ...(await line(filter.prediction[i], clock, shown)), type: 'scatter', mode: 'lines', line: stroke(k), name: `${letters[k]} predicted` });
    }
    traces.push({ ...(await line(run.state[i], clock, shown)), type: 'scatter', mode: 'lines', line: { color: ink(), width: 1, simplify: true }, name: 'measured' });
    return traces;
  } };
}

function nisRow(bounds) {
  return { title: 'NIS', height: 150, axis: { type: 'log', exponentformat: 'power', dtick: 2, range: [-4, 2.5] },
    shapes: () => bounds.map((bound) => ({ type: 'line', y0: bound, y1: bound, line: { color: ink(), width: 1, dash: 'dash' } })),
    draw: async ({ run, clock, shown }) => (await Promise.all(run.pair.map(async (filter, k) => {
      if (!filter) return null;
      const curve = await line(filter.nis, clock, shown), dots = curve.per === 1 && curve.y.length < 3000;
      return { ...curve, type: 'scatter', mode: dots ? 'markers' : 'lines', marker: { size: 4, color: colours[k], symbol: k ? 'diamond' : 'circle', opacity: 0.7 }, line: stroke(k, 0.8), name: `${letters[k]} NIS` };
    }))).filter(Boolean) };
}

function modesRow(k) {
  const row = probabilityRow({ filter: () => 'bank' });
  return { ...row, title: `P(mode) ${letters[k]}`, draw: (view) => row.draw({ ...view, run: { filters: { bank: view.run.pair[k] } } }) };
}

function drawData() {
  const runs = commonRuns();
  if (!runs.length) { section('data', 'Data and predictions', note('No run is in both archives with the same samples.')); return; }
  const place = data.runs[0].data, state = new TimeState(runs);
  const rows = () => [...place.states.map((_, i) => stateRow(place.states, i)), nisRow(place.nis_bounds), ...[0, 1].filter((k) => state.current.pair[k]?.probability).map(modesRow), ...inputRows(place)];
  const plot = timePlot(state, 'State with the predictions of both banks, their NIS and their mode probabilities over time', rows,
    `Bands: ${100 * place.level} % of each bank's prediction. Dashed lines at the NIS: both bounds of a true filter.`);
  section('data', 'Data and predictions', legend([[ink(), 'measured']]), h('div', { class: 'controls' },
    choice('Run', runs.map((run) => `${run.name} (${run.role === 'test' ? 'held out' : 'training'})`), state.run, (i) => state.select(i)), timeControls(state)), plot);
}

async function drawWindows() {
  const both = data.runs.map((run) => run.windows);
  if (!both[0] || !both[1]) { section('windows', 'Local models', note('Not both hold windows.')); return; }
  const shared = both[0].axes.map((axis) => axis.name).filter((name) => both[1].axes.some((axis) => axis.name === name));
  if (shared.length < 2) { section('windows', 'Local models', note('Their models share fewer than two parameters.')); return; }
  const axisOf = (k, name) => both[k].axes.findIndex((axis) => axis.name === name);
  const begin = both[0].default_axes.map((a) => both[0].axes[a].name).filter((name) => shared.includes(name));
  let x = begin[0] || shared[0], y = begin.find((name) => name !== x) || shared.find((name) => name !== x);
  const usual = (lists) => {
    const sorted = lists.flatMap((list) => Array.from(list)).filter(Number.isFinite).sort((a, b) => a - b), at = (share) => sorted[Math.round(share * (sorted.length - 1))];
    const low = at(0.01), high = at(0.99), pad = 0.12 * (high - low) || 1e-9;
    return [low - pad, high + pad];
  };
  const element = figure('Local models of both runs in two parameters', async () => {
    const values = async (name) => Promise.all([0, 1].map((k) => array(both[k].values[axisOf(k, name)])));
    const [xs, ys] = [await values(x), await values(y)];
    const traces = [0, 1].map((k) => ({ type: 'scattergl', mode: 'markers', x: xs[k], y: ys[k], name: letters[k], marker: { size: 4, color: colours[k], symbol: k ? 'diamond' : 'circle', opacity: 0.35 }, hovertemplate: `${letters[k]}: %{x:.4g}, %{y:.4g}<extra></extra>` }));
    [0, 1].forEach((k) => {
      const bank = both[k].bank, at = [axisOf(k, x), axisOf(k, y)];
      if (!bank || !bank.length || at.some((a) => a >= both[k].parameters)) return;
      traces.push({ type: 'scatter', mode: 'markers', x: bank.map((theta) => theta[at[0]]), y: bank.map((theta) => theta[at[1]]), text: bank.map((_, mode) => `mode ${mode} of ${letters[k]}`), hoverinfo: 'text',
        marker: { symbol: k ? 'square' : 'star', size: 12, color: colours[k], line: { color: ink(), width: 1.5 } } });
    });
    const unit = (name) => { const axis = both[0].axes[axisOf(0, name)]; return plain(axis.unit ? `${name} [${axis.unit}]` : name); };
    return { traces, layout: { height: 460, showlegend: false, xaxis: { title: { text: unit(x) }, range: usual(xs) }, yaxis: { title: { text: unit(y) }, range: usual(ys) } } };
  }, 'Small: windows. Large with an outline: modes of the bank.');
  section('windows', 'Local models', legend(), h('div', { class: 'controls' }, choice('Across', shared, shared.indexOf(x), (i) => { x = shared[i]; element.redraw(); }), choice('Up', shared, shared.indexOf(y), (i) => { y = shared[i]; element.redraw(); })), element);
}

function drawSelection() {
  const both = data.runs.map((run) => run.selection);
  const kinds = [['bic', 'BIC'], ['icl', 'ICL'], ['aic', 'AIC'], ['heldout', 'held out [nats]']].filter(([key]) => both.some((one) => one && one.candidates.some((row) => row[key] && row[key].v !== null)));
  if (!kinds.length) { section('selection', 'How many components', note('Neither holds a mixture.')); return; }
  let kind = 0;
  const element = figure('A criterion over the number of components, for both runs', () => {
    const [key, name] = kinds[kind], traces = [];
    both.forEach((one, k) => {
      if (!one) return;
      const rows = one.candidates.filter((row) => row.status === 'fitted' && row[key].v !== null);
      traces.push({ type: 'scatter', mode: 'lines+markers', name: letters[k], x: rows.map((row) => row.components), y: rows.map((row) => row[key].v), text: rows.map((row) => `${letters[k]}, K = ${row.components}: ${row[key].t}`), hoverinfo: 'text', line: stroke(k), marker: { size: rows.map((row) => (row.selected ? 13 : 6)), color: colours[k], symbol: k ? 'diamond' : 'circle' } });
    });
    return { traces, layout: { height: 320, showlegend: false, xaxis: { title: { text: 'components K' }, dtick: 1 }, yaxis: { title: { text: name } } } };
  }, 'Large: the chosen one. Values compare only where windows and features are the same.');
  section('selection', 'How many components', legend(), h('div', { class: 'controls' }, choice('Criterion', kinds.map(([, name]) => name), 0, (i) => { kind = i; element.redraw(); })), element);
}

function drawBanks() {
  const place = section('bank', 'The banks');
  data.runs.forEach((run, k) => {
    const bank = run.bank;
    place.append(h('h3', {}, `${letters[k]}: ${names[k]}`));
    if (!bank) { place.append(note('It holds no bank.')); return; }
    place.append(table([{ name: 'Mode', of: (row) => row.mode }, { name: 'Weight', of: (row) => row.weight }, ...bank.parameter_names.map((name, i) => ({ name, of: (row) => row.parameters[i] })), { name: bank.noise_name, of: (row) => row.noise_sd },
      { name: 'Time constants', text: true, of: (row) => row.decays }], bank.modes, { caption: `Modes of ${letters[k]}`, sortable: true }));
  });
}

function drawFilter() {
  const both = data.runs.map((run) => run.filter);
  if (!both[0] || !both[1]) { section('filter', 'The filters', note('Not both were evaluated.')); return; }
  const roles = ['test', 'train'].filter((role) => both.every((one) => one.histograms.some((row) => row.role === role)));
  if (!roles.length) { section('filter', 'The filters', note('They have no kind of runs in common.')); return; }
  let role = roles[0];
  const of = (one, list, key, name) => one[list].find((row) => row.role === role && row[key] === name);
  const histogram = figure('Histogram of probability integral transforms of both banks', () => {
    const traces = both.map((one, k) => { const row = of(one, 'histograms', 'filter', 'bank'), bins = row.counts.length; return { type: 'scatter', mode: 'lines', name: letters[k], x: Array.from({ length: bins + 1 }, (_, i) => i / bins), y: [...row.counts, row.counts[bins - 1]].map((count) => count / row.expected), line: { ...stroke(k, 2), shape: 'hv' } }; });
    const row = of(both[0], 'histograms', 'filter', 'bank');
    return { traces, layout: { height: 300, showlegend: false, xaxis: { title: { text: 'PIT' }, range: [0, 1] }, yaxis: { title: { text: 'density' }, rangemode: 'tozero' },
      shapes: [{ type: 'rect', xref: 'paper', x0: 0, x1: 1, y0: row.band[0] / row.expected, y1: row.band[1] / row.expected, fillcolor: ink(), opacity: 0.12, line: { width: 0 } }] } };
  }, 'Grey: where 95 % of a true filter’s bars lie (for A’s number of samples).');
  const correlation = figure('Residual autocorrelation of both banks', () => {
    const rows = both.map((one) => of(one, 'autocorrelations', 'model', 'bank')), shapes = rows[0] ? [{ type: 'rect', xref: 'paper', x0: 0, x1: 1, y0: -rows[0].band, y1: rows[0].band, fillcolor: ink(), opacity: 0.12, line: { width: 0 } }] : [];
    const traces = rows.flatMap((row, k) => { if (!row) return []; const y = row.states[0].slice(1); return [{ type: 'scatter', mode: 'lines+markers', name: letters[k], x: y.map((_, lag) => lag + 1), y, line: stroke(k), marker: { size: 5, color: colours[k], symbol: k ? 'diamond' : 'circle' } }]; });
    return { traces, layout: { height: 300, showlegend: false, xaxis: { title: { text: 'lag [samples]' } }, yaxis: { title: { text: 'autocorrelation' } }, shapes } };
  });
  const outside = figure('Shares of samples whose NIS lies outside its 95 % interval, for both banks', () => {
    const sides = ['above', 'below'], traces = both.map((one, k) => { const row = one.scores.find((score) => score.run === '*' && score.filter === 'bank' && score.role === role); return { type: 'bar', name: letters[k], x: sides, y: sides.map((side) => 100 * row[`nis_${side}`].v), text: sides.map((side) => `${letters[k]} ${side}: ${row[`nis_${side}`].t}`), textposition: 'none', hoverinfo: 'text', marker: { color: colours[k] } }; });
    return { traces, layout: { height: 300, barmode: 'group', showlegend: false, xaxis: { type: 'category' }, yaxis: { title: { text: 'NIS outside [%]' }, rangemode: 'tozero' }, shapes: [{ type: 'line', xref: 'paper', x0: 0, x1: 1, y0: 100 * both[0].tail, y1: 100 * both[0].tail, line: { color: ink(), width: 1.2, dash: 'dash' } }] } };
  }, 'Dashed: a true filter.');
  const redraw = () => [histogram, correlation, outside].forEach((element) => element.plot.on && element.redraw());
  section('filter', 'The filters', legend(), roles.length > 1 ? h('div', { class: 'controls' }, choice('Runs', roles.map((one) => roleNames[one]), 0, (i) => { role = roles[i]; redraw(); })) : null, h('div', { class: 'pair' }, histogram, correlation, outside));
}

draw(async () => {
  head(`${names[0]} and ${names[1]}`, 'Two runs compared');
  drawDifferences();
  drawScores();
  drawData();
  await drawWindows();
  drawSelection();
  drawBanks();
  drawFilter();
});
