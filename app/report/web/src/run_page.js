// The page of one run, top to bottom: what was run, verdict, data, local models, selection, bank, filter.
import {drawCloud} from './cloud.js';
import {choiceIfAny, controls, copyButton, details, facts, h, legend, note, value} from './elements.js';
import {filterNames} from './filters.js';
import {modeTitle, nameModes} from './mode_names.js';
import {draw, head, section} from './page.js';
import {pageData} from './page_data.js';
import {ink, lineColour, modeColour, palette} from './plots.js';
import {drawBank} from './run_bank.js';
import {dataPlot} from './run_data.js';
import {drawFilter} from './run_filter.js';
import {drawSelection} from './run_selection.js';
import {table} from './table.js';
import {runChoice, timeControls, TimeState} from './timeview.js';

const changedColumns = [
  {name: 'Setting', text: true, of: (row) => row.key},
  {name: 'Value', text: true, of: (row) => row.value},
  {name: 'Default', text: true, of: (row) => row.standard},
];
const fileColumns = [
  {name: 'File', text: true, of: (row) => row.path},
  {name: 'Bytes', of: (row) => row.bytes},
  {name: 'SHA-256', text: true, of: (row) => row.sha256},
];

function drawOrigin(origin) {
  const code = (text) => h('code', {}, text), listing = (text) => h('pre', {tabindex: 0}, text);
  const changed = {caption: 'Settings that are not the defaults'};
  section(
      'origin', 'What was run', facts([
        ['Command', code(origin.command)],
        ['Made', `${origin.created} by modebank ${origin.version}`],
        ['Hash of settings', code(origin.config_hash)],
        ['Hash of data', code(origin.data_hash)],
        ...origin.facts,
      ]),
      controls(copyButton('Copy the configuration', origin.config)),
      origin.changed.length ? table(changedColumns, origin.changed, changed) : note('All settings are the defaults.'),
      details('The whole configuration', listing(origin.config)),
      details(`${origin.inputs.length} input files`, table(fileColumns, origin.inputs, {caption: 'Input files'})),
      details('Versions', facts(origin.versions)),
      details('The summary as the program prints it', listing(origin.summary)));
}

function verdictCard(row) {
  const others = Object.keys(row.values).filter((name) => name !== 'bank');
  return h(
      'li', {}, h('div', {class: 'name'}, row.name),
      h('div', {class: 'soft'}, [row.unit, row.better].filter(Boolean).join(', ')),
      h('div', {class: 'big'}, value(row.values.bank)),
      others.map((name) => h('div', {}, `${filterNames[name]}: `, value(row.values[name]))));
}

function drawVerdict(verdict) {
  const sort = verdict.good === true ? 'good' : verdict.good === false ? 'bad' : '';
  const known = Object.keys(verdict.numbers[0].values).length > 0;
  section(
      'verdict', 'Verdict', h('p', {class: `verdict ${sort}`}, verdict.text),
      known ? h('ul', {class: 'numbers'}, verdict.numbers.map(verdictCard)) : null);
}

function modeLegend(count) {
  return legend(Array.from({length: count}, (_, k) => [modeColour(k), modeTitle(k)]), 'Colours of modes');
}

// Drop-downs of run and filter, one pair per place, all of them of the same state.
function pickers(state, filters, options) {
  const all = [];
  const showChosen = () => all.forEach(([run, filter]) => {
    run.selectedIndex = state.run;
    if (filter) filter.selectedIndex = options.chosen;
  });
  const listen = state.changed.bind(state);
  state.changed = (except) => {
    showChosen();
    return listen(except);
  };
  const select = (label) => label && label.querySelector('select');
  return () => {
    const run = runChoice(state);
    const filter = choiceIfAny('Filter', filters.map((name) => filterNames[name]), options.chosen, (i) => {
      options.chosen = i;
      return state.changed();
    });
    all.push([select(run), select(filter)]);
    return [run, filter];
  };
}

function dataLegend(runs, filtered) {
  const outliers = `outliers (1 in ${Math.round(1 / (1 - runs.outlier_level))} of a true filter)`;
  return legend([
    [ink(), 'measured'],
    ...(filtered ?
            [
              [lineColour(palette.prediction), 'predicted one sample ahead'],
              [palette.band, `${100 * runs.level} % band`],
              [palette.outlier, outliers],
            ] :
            []),
    ...(runs.runs.some((run) => run.truth) ? [[lineColour(palette.truth), 'truth']] : []),
  ]);
}

function drawData(runs, state, options, picker) {
  const filters = Object.keys(runs.runs[0].filters), filtered = filters.length > 0;
  section(
      'data', 'The data', filtered ? null : note('No filter was run, so there is no prediction to compare with.'),
      controls(picker(), timeControls(state)), dataLegend(runs, filtered), dataPlot(runs, state, filters, options));
}

async function drawWindows(windows, runs, goTo) {
  if (!windows) {
    section('windows', 'Local models', note('This archive holds no windows.'));
    return;
  }
  const place = section('windows', 'Local models');
  place.append(...await drawCloud(windows, runs.runs.map((run) => run.name), goTo));
  const all = `${windows.count.t} windows of ${windows.length} transitions`;
  const text = windows.step > 1 ? `${all}; every ${windows.step}th is drawn.` : `${all}.`;
  place.querySelector('h2').after(h('p', {}, text));
}

// What all sections with a filter share: which filter and which state are shown.
function filterOptions(filters) {
  const options = {chosen: Math.max(0, filters.indexOf('bank')), state: 0, modeLegend};
  options.layer = {
    prefix: '',
    band: palette.band,
    opacity: 0.33,
    line: palette.prediction,
    of: (run) => run.filters[filters[options.chosen]],
  };
  return options;
}

draw(async () => {
  const data = pageData(), runs = data.data;
  nameModes(data.bank ? data.bank.modes.map((mode) => mode.name) : []);
  head(data.file, `Run of ${data.origin.created}`);
  drawOrigin(data.origin);
  drawVerdict(data.verdict);
  if (!runs || !runs.runs.length) {
    section('data', 'The data', note('This archive holds no data.'));
    return;
  }
  const filters = Object.keys(runs.runs[0].filters), state = new TimeState(runs.runs), options = filterOptions(filters);
  const picker = pickers(state, filters, options);
  drawData(runs, state, options, picker);
  await drawWindows(data.windows, runs, (run, begin, end) => {
    const around = 3 * (end - begin), {time} = runs.runs[run];
    state.select(run, [Math.max(time.start, begin - around), Math.min(time.end, end + around)], [begin, end]);
    document.getElementById('data').scrollIntoView();
  });
  drawSelection(data.selection);
  drawBank(data.bank);
  drawFilter(data.filter, runs, state);
});
