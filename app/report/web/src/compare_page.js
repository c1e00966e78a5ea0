// The page that compares two runs, A and B, by tables.
import {drawModes} from './compare_modes.js';
import {copyButton, details, facts, h, note} from './elements.js';
import {roleNames, shortNames} from './filters.js';
import {draw, head, section} from './page.js';
import {pageData} from './page_data.js';
import {table} from './table.js';

const letters = ['A', 'B'];

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
  const caption = 'Different settings that change results';
  const columns = [
    {name: 'Setting', text: true, of: (row) => row.key},
    ...letters.map((name, k) => ({name, text: true, of: (row) => row.values[k]})),
  ];
  section(
      'differences', 'What differs',
      deciding.length ? table(columns, deciding, {caption}) : note('All settings that change results are equal.'),
      others.length ? details(
                          `${others.length} different settings that change no result`,
                          table(columns, others, {caption: 'Other settings'})) :
                      null,
      data.same_data ? null : note('The data differ: their hashes are not the same.', true));
}

const scoreColumns = [
  {name: 'Filter', text: true, of: (row) => shortNames[row.filter]},
  {name: 'Runs', text: true, of: (row) => roleNames[row.role]},
  {name: 'Score', text: true, of: (row) => row.score},
  ...letters.map((name, k) => ({name, of: (row) => row.values[k]})),
  {name: 'B − A', of: (row) => row.difference},
  {name: 'Better', text: true, of: (row) => (row.better === null ? 'equal' : letters[row.better])},
];

// Rows with differences come first. Equal rows appear after a click.
function scoreTables(data) {
  const differing = data.scores.filter((row) => row.better !== null),
        equal = data.scores.filter((row) => row.better === null);
  if (data.verdict.runs === 0) {
    const all = table(scoreColumns.slice(0, -1), data.scores, {caption: 'Scores of different data', sortable: true});
    return [details('Scores of each, which cannot be compared', all)];
  }
  return [
    differing.length ?
        table(scoreColumns, differing, {caption: 'Scores side by side, all runs of a role together', sortable: true}) :
        note('All scores are equal.'),
    equal.length ? details(
                       `${equal.length} scores are equal`,
                       table(scoreColumns, equal, {caption: 'Equal scores, all runs of a role together'})) :
                   null,
  ];
}

function drawVerdict(data) {
  const {text, told} = data.verdict;
  section(
      'verdict', 'Verdict', facts(data.runs.map(({name}, k) => [letters[k], name])),
      h('p', {class: told ? 'verdict good' : 'verdict'}, text),
      data.scores.length ? scoreTables(data) : note('Not both hold scores.'));
}

draw(() => {
  const data = pageData();
  head(data.runs.map(({name}) => name).join(' and '), 'Two runs compared');
  drawVerdict(data);
  drawDifferences(data);
  drawModes(data);
  section('origin', 'Origin', data.runs.map((run, k) => originOf(run, letters[k])));
});
