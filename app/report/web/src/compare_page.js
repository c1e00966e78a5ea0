// The page that compares two or more runs: A, B, ...
import {drawData} from './compare_data.js';
import {drawFilter} from './compare_filter.js';
import {drawModes} from './compare_modes.js';
import {drawWindows} from './compare_windows.js';
import {copyButton, details, facts, h, note} from './elements.js';
import {roleNames, shortNames} from './filters.js';
import {nameOf} from './modes.js';
import {draw, head, section} from './page.js';
import {pageData} from './page_data.js';
import {colours, letters, pairLegend} from './pair.js';
import {table} from './table.js';

const settingColumns = (runs) =>
    [{name: 'Setting', text: true, of: (row) => row.key},
     ...runs.map((_, k) => ({name: letters[k], text: true, of: (row) => row.values[k]})),
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
  const caption = 'Different settings that change results', columns = settingColumns(data.runs);
  section(
      'differences', 'What differs',
      deciding.length ? table(columns, deciding, {caption}) : note('All settings that change results are equal.'),
      others.length ? details(
                          `${others.length} different settings that change no result`,
                          table(columns, others, {caption: 'Other settings'})) :
                      null,
      data.same_data ? null : note('The data differ: their hashes are not the same.', true));
}

function drawOrigins(data) {
  section('origin', 'Origin', data.runs.map((run, k) => originOf(run, letters[k])));
}

const scoreColumns = (runs) =>
    [{name: 'Filter', text: true, of: (row) => shortNames[row.filter]},
     {name: 'Runs', text: true, of: (row) => roleNames[row.role]},
     {name: 'Score', text: true, of: (row) => row.score},
     ...runs.map((_, k) => ({name: letters[k], of: (row) => row.values[k], swatch: () => colours[k]})),
     ...runs.slice(1).map((_, k) => ({name: `${letters[k + 1]} − A`, of: (row) => row.differences[k]})),
     {name: 'Better', text: true, of: (row) => (row.better === null ? 'equal' : letters[row.better])},
];

// Rows with differences come first. Equal rows appear after a click.
function scoreTables(data) {
  const columns = scoreColumns(data.runs);
  const differing = data.scores.filter((row) => row.better !== null),
        equal = data.scores.filter((row) => row.better === null);
  if (data.verdicts.some(({runs}) => runs === 0)) {
    const all = table(columns.slice(0, -1), data.scores, {caption: 'Scores of different data', sortable: true});
    return [details('Scores of each, which cannot be compared', all)];
  }
  return [
    differing.length ?
        table(columns, differing, {caption: 'Scores side by side, all runs of a role together', sortable: true}) :
        note('All scores are equal.'),
    equal.length ? details(
                       `${equal.length} scores are equal`,
                       table(columns, equal, {caption: 'Equal scores, all runs of a role together'})) :
                   null,
  ];
}

function drawScores(data) {
  section(
      'verdict', 'Verdict', pairLegend(data.runs),
      data.verdicts.map(({text, told}) => h('p', {class: told ? 'verdict good' : 'verdict'}, text)),
      data.scores.length ? scoreTables(data) : note('Not all hold scores.'));
}

function bankTable(bank, letter) {
  const columns = [
    {name: 'Mode', text: true, of: (row) => nameOf(bank, row.mode)},
    {name: 'Family', text: true, of: (row) => bank.families.find(({modes}) => modes.includes(row.mode)).title},
    {name: 'Used', of: (row) => row.use},
    {name: 'Weight', of: (row) => row.weight},
    ...bank.parameter_names.map((name, i) => ({name, of: (row) => row.parameters[i]})),
    {name: bank.noise_name, of: (row) => row.noise_sd},
    {name: 'Decay per sample', of: (row) => row.per_sample},
    {name: 'Time constants', text: true, of: (row) => row.decays},
    ...bank.gain_names.map((name, i) => ({name: `steady gain ${name}`, of: (row) => row.gains[i]})),
  ];
  return table(
      columns, bank.order.map((k) => bank.modes[k]), {caption: `Modes of ${letter}, most used first`, sortable: true});
}

// Shows each bank separately, because the tables of matched modes have no gains and time constants.
function drawBanks(data) {
  section(
      'bank', 'Each bank',
      data.runs.map(
          (run, k) => run.bank ? details(`Modes of ${letters[k]}: ${run.name}`, bankTable(run.bank, letters[k])) :
                                 note(`${letters[k]} has no bank.`)));
}

draw(() => {
  const data = pageData();
  head(data.runs.map(({name}) => name).join(' and '), `${data.runs.length} runs compared`);
  drawScores(data);
  drawDifferences(data);
  drawModes(data);
  drawWindows(data);
  drawData(data);
  drawFilter(data);
  drawBanks(data);
  drawOrigins(data);
});
