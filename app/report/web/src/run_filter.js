// The section on a filter: its evaluation of every sample, and its reliability.
import {figure} from './chart.js';
import {choice, choiceIfAny, controls, h, note} from './elements.js';
import {autocorrelationPanel, pitPanel} from './filter_drawings.js';
import {filterNames, kindNames, roleNames, roleOf, shortNames, sideNames, sidesOf} from './filters.js';
import {drawFreeRun} from './free_run.js';
import {filterColour, palette} from './look.js';
import {section} from './page.js';
import {drawScores} from './run_scores.js';

const present = (list, key) => [...new Set(list.map((row) => row[key]))];
function histograms(filter) {
  const roles = present(filter.histograms, 'role');
  let [role] = roles;
  const label = 'Histogram of probability integral transforms for each filter; equal bars mean true uncertainty';
  const plot = figure(label, () => {
    const rows = filter.histograms.filter((row) => row.role === role);
    const panels = rows.map((row) => pitPanel(row, filterColour(row.filter), filterNames[row.filter]));
    return {panels, height: 84, wide: 240};
  }, 'Grey: contains 95 % of a true filter’s bars. High ends: overconfident; high middle: underconfident.');
  const pick = choiceIfAny('Runs', roles.map((name) => roleNames[name]), 0, (i) => {
    role = roles[i];
    plot.update();
  });
  return [h('h3', {}, 'Probability transforms (PIT)'), pick ? controls(pick) : null, plot];
}

function autocorrelations(filter, states) {
  const list = filter.autocorrelations;
  if (!list.length) return [];
  const roles = present(list, 'role'), chosen = {role: roles[0], state: 0};
  const plot = figure(
      'Autocorrelation of the residuals for each model; within the band they are white',
      () => {
        const rows = list.filter((row) => row.role === chosen.role).map((row) => ({
                                                                          series: row.states[chosen.state],
                                                                          name: shortNames[row.model] || row.model,
                                                                          colour: filterColour(row.model),
                                                                          band: row.band,
                                                                        }));
        const keys = rows.map(({colour, name}) => [colour, name]);
        return {panels: [autocorrelationPanel(rows, rows[0].band)], legend: keys};
      },
      `Grey: ${100 * list[0].level} % band of white residuals. Filters: normal scores of the PIT; global model: its ` +
          'one-step residuals.');
  const choose = (key, value) => {
    chosen[key] = value;
    plot.update();
  };
  return [
    h('h3', {}, 'Residual autocorrelation'),
    controls(
        choiceIfAny('Runs', roles.map((role) => roleNames[role]), 0, (i) => choose('role', roles[i])),
        choiceIfAny('State', states.map((channel) => channel.name), 0, (i) => choose('state', i))),
    plot
  ];
}

const sideColours = {
  above: palette.modes[3],
  below: palette.modes[5]
};
const faint = 0.5;  // opacity of training runs

// Bars for one side of the interval and one role. Each group has `count` bars; `n` is the position in the group.
function outsideMark(rows, key, {side, role}, n, count) {
  const width = 0.8 / count, cell = (row) => row[sidesOf[key][side]];
  return {
    kind: 'bars',
    name: `${sideNames[side]}, ${roleOf(role)}`,
    x: rows.map((_, i) => i + width * (n - (count - 1) / 2)),
    y: rows.map((row) => (row ? 100 * cell(row).v : null)),
    width: 0.94 * width,
    colour: sideColours[side],
    opacity: role === 'test' ? 1 : faint,
  };
}

// Figure 5 of the paper: number of samples above and below the interval, for training and held-out runs.
function outside(filter) {
  const pooled = filter.scores.filter((row) => row.run === '*');
  const roles = present(pooled, 'role'), filters = present(pooled, 'filter');
  const kinds = ['above', 'below'].flatMap((side) => roles.map((role) => ({side, role})));
  let [[key]] = kindNames;
  const rowsOf = (role) => filters.map((name) => pooled.find((row) => row.filter === name && row.role === role));
  const drawing = () => {
    const bars = kinds.map((kind, n) => outsideMark(rowsOf(kind.role), key, kind, n, kinds.length));
    return {
      panels: [{
        x: {levels: filters.map((name) => shortNames[name])},
        y: {title: 'samples too close | too far [%]', zero: true},
        marks: [...bars, {kind: 'rule', y: 100 * filter.tail}],
      }],
      legend: bars.map(({colour, name, opacity}) => [colour, name, opacity]),
    };
  };
  const label =
      'Shares of samples too far from the prediction and too close to it, for each filter; the table of scores ' +
      'holds the same numbers';
  const plot = figure(label, drawing, 'Dashed: a true filter’s 2.5 % on each side.');
  const pick = choice('By', kindNames.map(([, name]) => name), 0, (i) => {
    [key] = kindNames[i];
    plot.update();
  });
  return [h('h3', {}, 'Samples too far and too close'), controls(pick), plot];
}

export function drawFilter(filter, runs, state) {
  const absent = 'This archive has no evaluation, because no filter was run over the data.';
  if (!filter) return section('filter', 'The filter', note(absent));
  return section(
      'filter', 'The filter',
      h('div', {class: 'pair'}, h('div', {}, histograms(filter)),
        h('div', {}, autocorrelations(filter, runs.states), outside(filter))),
      drawScores(filter), drawFreeRun(filter, runs, state));
}
