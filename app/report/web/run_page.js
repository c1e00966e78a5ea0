// The page of one run, top to bottom: what was run, verdict, data, local models, selection, bank, filter.
import { choice, copyButton, data, draw, facts, h, head, note, section, table, value } from './common.js';
import { cloud } from './cloud.js';
import { filterNames } from './filters.js';
import { lineColour, modeColour, palette, ink } from './plots.js';
import { drawBank } from './run_bank.js';
import { drawFilter } from './run_filter.js';
import { drawSelection } from './run_selection.js';
import { inputRows, probabilityRow, stateRow } from './run_rows.js';
import { TimeState, timeControls, timePlot } from './timeview.js';

function drawOrigin(origin) {
  section('origin', 'What was run',
    facts([['Command', h('code', {}, origin.command)], ['Made', `${origin.created} by modebank ${origin.version}`],
      ['Hash of settings', h('code', {}, origin.config_hash)], ['Hash of data', h('code', {}, origin.data_hash)], ...origin.facts]),
    h('div', { class: 'controls' }, copyButton('Copy the configuration', origin.config)),
    origin.changed.length ? table([{ name: 'Setting', text: true, of: (row) => row.key }, { name: 'Value', text: true, of: (row) => row.value },
      { name: 'Default', text: true, of: (row) => row.standard }], origin.changed, { caption: 'Settings that are not the defaults' }) : note('All settings are the defaults.'),
    h('details', {}, h('summary', {}, 'The whole configuration'), h('pre', { tabindex: 0 }, origin.config)),
    h('details', {}, h('summary', {}, `${origin.inputs.length} input files`),
      table([{ name: 'File', text: true, of: (row) => row.path }, { name: 'Bytes', of: (row) => row.bytes }, { name: 'SHA-256', text: true, of: (row) => row.sha256 }], origin.inputs, { caption: 'Input files' })),
    h('details', {}, h('summary', {}, 'Versions'), facts(origin.versions)),
    h('details', {}, h('summary', {}, 'The summary as the program prints it'), h('pre', { tabindex: 0 }, origin.summary)));
}

function drawVerdict(verdict) {
  const cards = verdict.numbers.map((row) => h('li', {}, h('div', { class: 'name' }, row.name), h('div', { class: 'soft' }, [row.unit, row.better].filter(Boolean).join(', ')),
    h('div', { class: 'big' }, value(row.values.bank)),
    Object.keys(row.values).filter((name) => name !== 'bank').map((name) => h('div', {}, `${filterNames[name]}: `, value(row.values[name])))));
  section('verdict', 'Verdict', h('p', { class: `verdict ${verdict.good === true ? 'good' : verdict.good === false ? 'bad' : ''}` }, verdict.text),
    Object.keys(verdict.numbers[0].values).length ? h('ul', { class: 'numbers' }, cards) : null);
}

const swatches = (entries, label) => h('ul', { class: 'legend', 'aria-label': label }, entries.map(([colour, text]) => h('li', {}, h('span', { class: 'swatch', style: `background:${colour}` }), text)));
const modeLegend = (count) => swatches(Array.from({ length: count }, (_, k) => [modeColour(k), `mode ${k}`]), 'Colours of modes');

// One drop-down per place, all of them of the same state.
function pickers(runs, state, options) {
  const all = [], filters = Object.keys(runs.runs[0].filters);
  const fresh = () => all.forEach(([run, filter]) => { run.selectedIndex = state.run; if (filter) filter.selectedIndex = options.chosen; });
  const listen = state.changed.bind(state);
  state.changed = (except) => { fresh(); return listen(except); };
  return () => {
    const run = choice('Run', runs.runs.map((entry) => `${entry.name} (${entry.role === 'test' ? 'held out' : 'training'})`), state.run, (i) => state.select(i));
    const filter = filters.length > 1 ? choice('Filter', filters.map((name) => filterNames[name]), options.chosen, (i) => { options.chosen = i; return state.changed(); }) : null;
    all.push([run.querySelector('select'), filter && filter.querySelector('select')]);
    return [run, filter];
  };
}

function drawData(runs, state, options, picker) {
  const filtered = Object.keys(runs.runs[0].filters).length > 0, truth = runs.runs.some((run) => run.truth);
  const rows = () => [...runs.states.map((_, i) => stateRow(runs, i, options)), ...inputRows(runs), ...(state.current.filters[options.filter()]?.probability ? [probabilityRow(options)] : [])];
  const plot = timePlot(state, 'State with prediction, and inputs, of one run over time', rows, runs.note);
  const legend = () => swatches([[ink(), 'measured'], ...(filtered ? [[lineColour(palette.prediction), 'predicted one sample ahead'], [palette.band, `${100 * runs.level} % band`], [palette.outlier, `outliers (1 in ${Math.round(1 / (1 - runs.outlier_level))} of a true filter)`]] : []), ...(truth ? [[lineColour(palette.truth), 'truth']] : [])], 'Colours');
  section('data', 'The data', filtered ? null : note('No filter was run, so there is no prediction to compare with.'),
    h('div', { class: 'controls' }, picker(), timeControls(state)), legend(), plot);
}

async function drawWindows(windows, runs, goTo) {
  if (!windows) return section('windows', 'Local models', note('This archive holds no windows.'));
  const place = section('windows', 'Local models');
  const { elements } = await cloud(windows, runs.runs.map((run) => run.name), goTo);
  place.append(...elements.filter(Boolean));
  const all = `${windows.count.t} windows of ${windows.length} transitions`;
  place.querySelector('h2').after(h('p', {}, windows.step > 1 ? `${all}; every ${windows.step}th is drawn.` : `${all}.`));
  return place;
}

draw(async () => {
  const runs = data.data;
  head(data.file, `Run of ${data.origin.created}`);
  drawOrigin(data.origin);
  drawVerdict(data.verdict);
  if (!runs || !runs.runs.length) {
    section('data', 'The data', note('This archive holds no data.'));
    return;
  }
  const filters = Object.keys(runs.runs[0].filters), state = new TimeState(runs.runs);
  const options = { chosen: Math.max(0, filters.indexOf('bank')), state: 0, filter: () => filters[options.chosen], modeLegend };
  const picker = pickers(runs, state, options);
  drawData(runs, state, options, picker);
  await drawWindows(data.windows, runs, (run, begin, end) => {
    const around = 3 * (end - begin), time = runs.runs[run].time;
    state.select(run, [Math.max(time.start, begin - around), Math.min(time.end, end + around)], [begin, end]);
    document.getElementById('data').scrollIntoView();
  });
  drawSelection(data.selection);
  drawBank(data.bank);
  drawFilter(data.filter, runs, state, options, picker);
});
