// Calibration of all banks in one figure.
import {figure} from './chart.js';
import {choiceIfAny, controls, h, note} from './elements.js';
import {autocorrelationPanel, pitSteps} from './filter_drawings.js';
import {roleNames} from './filters.js';
import {section} from './page.js';
import {colours, dashes, letters, pairLegend, symbols} from './pair.js';

// `rows`: one row for each of A, B, ...
function pitDrawing(rows) {
  const [{band, expected}] = rows;
  const marks = rows.map(
      (row, k) => ({kind: 'line', ...pitSteps(row), colour: colours[k], dash: dashes[k], width: 2, step: true}));
  const grey = {kind: 'band', low: band[0] / expected, high: band[1] / expected};
  const panel = {x: {title: 'PIT', range: [0, 1]}, y: {title: 'density', zero: true}, marks: [grey, ...marks]};
  return {panels: [panel]};
}

function correlationDrawing(rows) {
  const one = (row, k) =>
      ({series: row.states[0], name: letters[k], colour: colours[k], dash: dashes[k], symbol: symbols[k]});
  const present = rows.flatMap((row, k) => (row ? [one(row, k)] : []));
  return {panels: [autocorrelationPanel(present, (rows[0] || {}).band)]};
}

export function drawFilter(data) {
  const title = 'The filters', both = data.runs.map((run) => run.filter);
  if (!both.every(Boolean)) {
    section('filter', title, note('Not all were evaluated.'));
    return;
  }
  const holds = (one, name) => one.histograms.some((row) => row.role === name);
  const roles = ['test', 'train'].filter((name) => both.every((one) => holds(one, name)));
  if (!roles.length) {
    section('filter', title, note('They have no held-out or training runs in common.'));
    return;
  }
  let [role] = roles;
  const banks = (list, key) => both.map((one) => one[list].find((row) => row.role === role && row[key] === 'bank'));
  const figures = [
    figure(
        'Histogram of probability integral transforms of all banks', () => pitDrawing(banks('histograms', 'filter')),
        'Grey: contains 95 % of a true filter’s bars (for A’s number of samples).'),
    figure('Residual autocorrelation of all banks', () => correlationDrawing(banks('autocorrelations', 'model'))),
  ];
  const pick = choiceIfAny('Runs', roles.map((name) => roleNames[name]), 0, (i) => {
    role = roles[i];
    figures.forEach((element) => element.update());
  });
  section('filter', title, pairLegend(data.runs), pick ? controls(pick) : null, h('div', {class: 'pair'}, figures));
}
