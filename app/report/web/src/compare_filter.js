// How true the uncertainty of all banks is.
import {choiceIfAny, controls, h, note} from './elements.js';
import {autocorrelationLayout, autocorrelationTrace, outsideBars, outsideLayout, pitSteps} from './filter_drawings.js';
import {roleNames} from './filters.js';
import {section} from './page.js';
import {colours, letters, pairLegend, stroke, symbols} from './pair.js';
import {figure, greyBand} from './plots.js';

const height = 300;

// `rows`: of A, B, ...
function pitDrawing(rows) {
  const traces = rows.map(
      (row, k) =>
          ({type: 'scatter', mode: 'lines', name: letters[k], ...pitSteps(row), line: {...stroke(k, 2), shape: 'hv'}}));
  const [{band, expected}] = rows;
  const layout = {
    height,
    showlegend: false,
    xaxis: {title: {text: 'PIT'}, range: [0, 1]},
    yaxis: {title: {text: 'density'}, rangemode: 'tozero'},
    shapes: [greyBand(band[0] / expected, band[1] / expected)],
  };
  return {traces, layout};
}

function correlationDrawing(rows) {
  const traces = rows.flatMap(
      (row, k) =>
          (row ? [autocorrelationTrace(row.states[0], {
            name: letters[k],
            line: stroke(k),
            marker: {size: 5, color: colours[k], symbol: symbols[k]},
          })] :
                 []));
  return {traces, layout: autocorrelationLayout((rows[0] || {}).band, {height, showlegend: false})};
}

function outsideDrawing(rows, tail) {
  const sides = ['above', 'below'];
  const traces =
      rows.map((row, k) => ({
                 ...outsideBars(sides.map((side) => row[`nis_${side}`]), sides.map((side) => `${letters[k]} ${side}`)),
                 name: letters[k],
                 x: sides,
                 marker: {color: colours[k]},
               }));
  return {traces, layout: outsideLayout(tail, 'NIS outside [%]', {height, showlegend: false})};
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
    section('filter', title, note('They have no kind of runs in common.'));
    return;
  }
  let [role] = roles;
  const banks = (list, key) => both.map((one) => one[list].find((row) => row.role === role && row[key] === 'bank'));
  const pooled = () =>
      both.map((one) => one.scores.find((row) => row.run === '*' && row.filter === 'bank' && row.role === role));
  const figures = [
    figure(
        'Histogram of probability integral transforms of all banks', () => pitDrawing(banks('histograms', 'filter')),
        'Grey: where 95 % of a true filter’s bars lie (for A’s number of samples).'),
    figure('Residual autocorrelation of all banks', () => correlationDrawing(banks('autocorrelations', 'model'))),
    figure(
        'Shares of samples whose NIS lies outside its 95 % interval, for all banks',
        () => outsideDrawing(pooled(), both[0].tail), 'Dashed: a true filter.'),
  ];
  const pick = choiceIfAny('Runs', roles.map((name) => roleNames[name]), 0, (i) => {
    role = roles[i];
    figures.forEach((element) => element.update());
  });
  section('filter', title, pairLegend(data.runs), pick ? controls(pick) : null, h('div', {class: 'pair'}, figures));
}
