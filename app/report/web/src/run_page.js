// The page of one run. From top to bottom it shows verdict, data, modes, filter, local models, selection,
// configuration.
import {drawCloud} from './cloud.js';
import {choiceIfAny, controls, h, legend, note} from './elements.js';
import {filterNames} from './filters.js';
import {INK, palette} from './look.js';
import {nameModes} from './mode_names.js';
import {modeLegend} from './modes.js';
import {draw, head, section} from './page.js';
import {pageData} from './page_data.js';
import {drawBank} from './run_bank.js';
import {dataPlot} from './run_data.js';
import {drawFilter} from './run_filter.js';
import {inNaturalOrder} from './run_names.js';
import {drawOrigin} from './run_origin.js';
import {drawSelection} from './run_selection.js';
import {drawVerdict} from './run_verdict.js';
import {runChoice, timeControls, TimeState} from './timeview.js';

// Drop-down lists of runs and filters. They are in several places of the page, and all have the same state.
function pickers(state, filters, options) {
  const all = [];
  const showChosen = () => all.forEach(([run, filter]) => {
    run.selectedIndex = state.run;
    if (filter) filter.selectedIndex = options.chosen;
  });
  const listen = state.changed.bind(state);
  state.changed = () => {
    showChosen();
    return listen();
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
    [INK, 'measured'],
    ...(filtered ?
            [
              [palette.prediction, 'predicted one sample ahead'],
              [palette.band, `${100 * runs.level} % band`],
              [palette.outlier, outliers],
            ] :
            []),
    ...(runs.runs.some((run) => run.truth) ? [[palette.truth, 'truth']] : []),
  ]);
}

// A separate legend is needed only for many modes. With few modes, the plot has its own legend.
const legendOfMany = (bank) => (bank && bank.modes.length > 8 ? modeLegend(bank) : null);

function drawData(runs, state, options, picker) {
  const filters = Object.keys(runs.runs[0].filters), filtered = filters.length > 0;
  section(
      'data', 'The data', filtered ? null : note('No filter was run, so there is no prediction to compare with.'),
      controls(picker(), timeControls(state)), dataLegend(runs, filtered), legendOfMany(data.bank),
      dataPlot(runs, state, filters, options));
}

async function drawWindows(windows) {
  if (!windows) {
    section('windows', 'Local models', note('This archive has no windows.'));
    return;
  }
  const place = section('windows', 'Local models');
  place.append(...await drawCloud(windows));
  const all = `${windows.count.t} windows of ${windows.length} transitions`;
  const text = windows.step > 1 ? `${all}; every ${windows.step}th is drawn.` : `${all}.`;
  place.querySelector('h2').after(h('p', {}, windows.noise ? `${text} Here ${windows.noise}.` : text));
}

// State that all sections with a filter share: the index of the filter, and the index of the state.
function filterOptions(filters) {
  const options = {chosen: Math.max(0, filters.indexOf('bank')), state: 0};
  options.layer = {
    prefix: '',
    band: palette.band,
    opacity: 0.33,
    line: palette.prediction,
    of: (run) => run.filters[filters[options.chosen]],
  };
  return options;
}

const data = pageData();

function drawFirst() {
  const {bank} = data;
  if (bank) nameModes(bank.modes.map((mode) => mode.name), bank.order, bank.told, bank.motions);
  head(data.file, `Run of ${data.origin.created}`);
  drawVerdict(data.verdict);
}

async function drawRest() {
  const runs = data.data;
  if (!runs || !runs.runs.length) {
    section('data', 'The data', note('This archive has no data.'));
    drawOrigin(data.origin);
    return;
  }
  runs.runs = inNaturalOrder(runs.runs);
  const filters = Object.keys(runs.runs[0].filters), state = new TimeState(runs.runs), options = filterOptions(filters);
  const picker = pickers(state, filters, options);
  drawData(runs, state, options, picker);
  drawBank(data.bank);
  drawFilter(data.filter, runs, state);
  await drawWindows(data.windows);
  drawSelection(data.selection);
  drawOrigin(data.origin);
}

draw(drawRest, drawFirst);
