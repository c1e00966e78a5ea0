// The page of two runs, A and B, side by side.
import {drawData} from './compare_data.js';
import {drawFilter} from './compare_filter.js';
import {drawWindows} from './compare_windows.js';
import {criteria, criterionTrace} from './criteria.js';
import {choice, controls, copyButton, details, facts, h, note} from './elements.js';
import {roleNames, shortNames} from './filters.js';
import {draw, head, section} from './page.js';
import {pageData} from './page_data.js';
import {colours, letters, pairLegend, stroke, symbols} from './pair.js';
import {figure} from './plots.js';
import {table} from './table.js';

const settingColumns = [
  {name: 'Setting', text: true, of: (row) => row.key},
  ...letters.map((name, k) => ({name, text: true, of: (row) => row.values[k]})),
];

function originOf(run, letter) {
  const {origin} = run;
  return details(
      `Where ${letter} comes from`, facts([
        ['File', run.name],
        ['Command', h('code', {}, origin.command)],
        ['Made', `${origin.created} by modebank ${origin.version}`],
        ['Data', h('code', {}, origin.data_hash)],
      ]),
      copyButton(`Copy the configuration of ${letter}`, origin.config));
}

function drawDifferences(data) {
  const rows = data.differences, deciding = rows.filter((row) => row.decides),
        others = rows.filter((row) => !row.decides);
  const caption = 'Settings that differ and decide the numbers';
  section(
      'differences', 'What differs', pairLegend(data.runs),
      deciding.length ? table(settingColumns, deciding, {caption}) : note('No setting that decides a number differs.'),
      others.length ? details(
                          `${others.length} differing settings that decide no number`,
                          table(settingColumns, others, {caption: 'Other settings'})) :
                      null,
      data.same_data ? null : note('The data differ: their hashes are not the same.', true),
      data.runs.map((run, k) => originOf(run, letters[k])));
}

const scoreColumns = [
  {name: 'Filter', text: true, of: (row) => shortNames[row.filter]},
  {name: 'Runs', text: true, of: (row) => roleNames[row.role]},
  {name: 'Score', text: true, of: (row) => row.score},
  ...letters.map((name, k) => ({name, of: (row) => row.values[k], swatch: () => colours[k]})),
  {name: 'B − A', of: (row) => row.difference},
  {name: 'Better', text: true, of: (row) => (row.better === null ? 'equal' : letters[row.better])},
];

function drawScores(data) {
  const options = {caption: 'Scores side by side, all runs of a role together', sortable: true};
  section(
      'verdict', 'Verdict', h('p', {class: 'verdict'}, data.verdict),
      data.scores.length ? table(scoreColumns, data.scores, options) : note('Not both hold scores.'));
}

/** @param {any[]} both @param {string[]} criterion */
function selectionDrawing(both, [key, name]) {
  const traces = both.flatMap((one, k) => {
    if (!one) return [];
    const trace = criterionTrace(one.candidates, key, letters[k]);
    const size = trace.customdata.map((selected) => (selected ? 13 : 6));
    return [{...trace, line: stroke(k), marker: {size, color: colours[k], symbol: symbols[k]}}];
  });
  const layout = {
    height: 320,
    showlegend: false,
    xaxis: {title: {text: 'components K'}, dtick: 1},
    yaxis: {title: {text: name}},
  };
  return {traces, layout};
}

function drawSelection(data) {
  const title = 'How many components', both = data.runs.map((run) => run.selection);
  const known = (key) => both.some((one) => one && one.candidates.some((row) => row[key] && row[key].v !== null));
  const kinds = criteria.filter(([key]) => known(key));
  if (!kinds.length) {
    section('selection', title, note('Neither holds a mixture.'));
    return;
  }
  let [kind] = kinds;
  const element = figure(
      'A criterion over the number of components, for both runs', () => selectionDrawing(both, kind),
      'Large: the chosen one. Values compare only where windows and features are the same.');
  const pick = choice('Criterion', kinds.map(([, name]) => name), 0, (i) => {
    kind = kinds[i];
    element.redraw();
  });
  section('selection', title, pairLegend(data.runs), controls(pick), element);
}

function bankTable(bank, letter) {
  const columns = [
    {name: 'Mode', of: (row) => row.mode},
    {name: 'Weight', of: (row) => row.weight},
    ...bank.parameter_names.map((name, i) => ({name, of: (row) => row.parameters[i]})),
    {name: bank.noise_name, of: (row) => row.noise_sd},
    {name: 'Decay per sample', of: (row) => row.per_sample},
    {name: 'Time constants', text: true, of: (row) => row.decays},
    ...bank.gain_names.map((name, i) => ({name: `steady gain ${name}`, of: (row) => row.gains[i]})),
  ];
  return table(columns, bank.modes, {caption: `Modes of ${letter}`, sortable: true});
}

function drawBanks(data) {
  section(
      'bank', 'The banks',
      data.runs.map(
          (run, k) =>
              [h('h3', {}, `${letters[k]}: ${run.name}`),
               run.bank ? bankTable(run.bank, letters[k]) : note('It holds no bank.'),
  ]));
}

draw(async () => {
  const data = pageData();
  head(`${data.runs[0].name} and ${data.runs[1].name}`, 'Two runs compared');
  drawDifferences(data);
  drawScores(data);
  drawData(data);
  await drawWindows(data);
  drawSelection(data);
  drawBanks(data);
  drawFilter(data);
});
