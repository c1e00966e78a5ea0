// The columns of a study in words. Example: bank_test_log_score becomes "held-out log score of the bank".
import {shortNames} from './filters.js';

const words = {
  log_score: 'log score [nats/sample]',
  coverage_50: 'in 50 % band',
  coverage_90: 'in 90 % band',
  coverage_95: 'in 95 % band',
  coverage_99: 'in 99 % band',
  too_far: 'too far',
  too_close: 'too close',
  pit_distance: 'PIT distance',
  nis_mean: 'mean NIS',
  nis_above: 'NIS above',
  nis_below: 'NIS below',
  whiteness_p: 'white p',
};
const roles = {
  test: 'held out',
  train: 'training'
};

const scoreWords = (score) => words[score] || score.replace(/^rmse_/, 'RMSE ').replace(/_/g, ' ');

// Title of a column for axes and drop-down lists. Keys and all other columns keep their names.
export function columnTitle(name) {
  const found = new RegExp(`^(${Object.keys(shortNames).join('|')})_(test|train)_(.+)$`).exec(name);
  if (!found) return name;
  const [, filter, role, score] = found;
  return `${shortNames[filter]}, ${roles[role]}: ${scoreWords(score)}`;
}
