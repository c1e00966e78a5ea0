// Tables of the scores of a run.
import {details, h} from './elements.js';
import {roleNames, roleOf, shortNames} from './filters.js';
import {filterColour} from './look.js';
import {naturally, shortName} from './run_names.js';
import {table} from './table.js';

const whose = {
  name: 'Filter',
  text: true,
  of: (row) => shortNames[row.filter],
  swatch: (row) => filterColour(row.filter)
};
const whichRuns = {
  name: 'Runs',
  text: true,
  of: (row) => roleNames[row.role]
};
const number = (name, key) => ({name, of: (row) => row[key]});

const scoreColumns = (filter) =>
    [whose,
     {name: 'Runs', text: true, of: (row) => roleOf(row.role)},
     {name: 'Run', text: true, of: (row) => (row.run === '*' ? 'all' : {t: shortName(row.run), v: row.run})},
     number('Samples', 'samples'),
     number('Log score [nats]', 'log_score'),
     number(filter.rmse_name, 'rmse'),
     number('in 50 % band', 'coverage_50'),
     number('in 90 %', 'coverage_90'),
     number('in 95 %', 'coverage_95'),
     number('in 99 %', 'coverage_99'),
     number('too far', 'too_far'),
     number('too close', 'too_close'),
     number('NIS above', 'nis_above'),
     number('NIS below', 'nis_below'),
     number('mean NIS', 'nis_mean'),
     number('PIT distance', 'pit_distance'),
     number('white p', 'whiteness_p'),
];

const verdictColumns = [
  whose,
  whichRuns,
  {name: 'Uncertainty', text: true, of: (row) => row.verdict},
  {name: 'Stands out', prose: true, of: (row) => row.flags},
  number('in 50 % band', 'coverage_50'),
  number('in 90 %', 'coverage_90'),
  number('in 95 %', 'coverage_95'),
  number('in 99 %', 'coverage_99'),
  number('too far', 'too_far'),
  number('too close', 'too_close'),
  number('mean NIS', 'nis_mean'),
];

const horizonColumns = (filter) =>
    [whose,
     whichRuns,
     number('Ahead [samples]', 'horizon'),
     number('Samples', 'samples'),
     number('Log score [nats]', 'log_score'),
     number(filter.rmse_name, 'rmse'),
];

const freeRunColumns = (filter) =>
    [whose,
     whichRuns,
     number('Measured first', 'start'),
     number('Samples', 'samples'),
     number('Log score [nats]', 'log_score'),
     number(filter.rmse_name, 'rmse'),
     number('NRMSE', 'nrmse'),
     number('FIT [%]', 'fit'),
     number('in 50 % band', 'coverage_50'),
     number('in 95 %', 'coverage_95'),
];

export const freeRunTable = (filter) =>
    table(freeRunColumns(filter), filter.free_runs, {caption: 'Free run, all runs together', sortable: true});

// Filters and roles are in the order of C++; runs are in natural order.
function inOrder(scores) {
  const groups = [...new Set(scores.map(({filter, role}) => `${filter} ${role}`))];
  const place = ({filter, role}) => groups.indexOf(`${filter} ${role}`);
  return [...scores].sort((a, b) => place(a) - place(b) || naturally(a.run, b.run));
}

export function drawScores(filter) {
  const of = (wanted) => inOrder(filter.scores.filter((row) => (row.run === '*') === wanted));
  const scores = (wanted, caption) => table(scoreColumns(filter), of(wanted), {caption, sortable: true});
  const trueOnes = 'Is the stated uncertainty true (95 % intervals in brackets)';
  const ahead = {caption: 'Predictions several samples ahead', sortable: true};
  return [
    h('h3', {}, 'Scores'),
    scores(true, 'Scores, all runs together'),
    details('Scores run by run', scores(false, 'Scores run by run')),
    filter.verdicts.length ? table(verdictColumns, filter.verdicts, {caption: trueOnes}) : null,
    filter.horizons.length ? table(horizonColumns(filter), filter.horizons, ahead) : null,
  ];
}
