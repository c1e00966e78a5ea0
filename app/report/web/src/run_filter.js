// What the filter said of every sample, and whether to believe it.
import {choice, choiceIfAny, controls, h, note} from './elements.js';
import {autocorrelationLayout, autocorrelationTrace, outsideBars, outsideLayout, pitBars} from './filter_drawings.js';
import {filterNames, kindNames, roleNames, roleOf, shortNames, sideNames, sidesOf} from './filters.js';
import {drawFreeRun} from './free_run.js';
import {section} from './page.js';
import {dashedLine, figure, filterColour, greyBand, palette} from './plots.js';
import {drawScores} from './run_scores.js';

const present = (list, key) => [...new Set(list.map((row) => row[key]))];
const legendAbove = {
  orientation: 'h',
  y: 1.02,
  yanchor: 'bottom'
};

const panel_px = 84, between_px = 58, above_px = 40, below_px = 44;  // between: numbers of one, name of the next

// Adds the histogram of row i of `count` to the drawing.
function addHistogram({traces, layout}, row, i, count) {
  const n = i ? i + 1 : '', last = i === count - 1;
  const axes = {xref: `x${n}`, yref: `y${n}`};
  const all = count * panel_px + (count - 1) * between_px, top = 1 - (i * (panel_px + between_px)) / all;
  const domain = [Math.max(0, top - panel_px / all), top];
  layout[`yaxis${n}`] = {title: {text: 'samples'}, domain, rangemode: 'tozero', nticks: 4};
  layout[`xaxis${n}`] = {range: [0, 1], anchor: `y${n}`, title: last ? {text: 'PIT'} : undefined, nticks: 6};
  traces.push({
    type: 'bar',
    ...pitBars(row),
    marker: {color: filterColour(row.filter)},
    xaxis: `x${n}`,
    yaxis: `y${n}`,
    textposition: 'none',
    hoverinfo: 'text',
  });
  layout.shapes.push(greyBand(row.band[0], row.band[1], axes), dashedLine(row.expected, axes));
  layout.annotations.push({
    text: filterNames[row.filter],
    xref: `x${n} domain`,
    yref: `y${n} domain`,
    x: 0,
    y: 1,
    xanchor: 'left',
    yanchor: 'bottom',
    showarrow: false,
    font: {size: 12},
  });
}

function histograms(filter) {
  const roles = present(filter.histograms, 'role');
  let [role] = roles;
  const label = 'Histogram of probability integral transforms for each filter; equal bars mean true uncertainty';
  const plot = figure(label, () => {
    const rows = filter.histograms.filter((row) => row.role === role);
    const layout = {
      height: above_px + rows.length * (panel_px + between_px) - between_px + below_px,
      margin: {l: 64, r: 12, t: above_px, b: below_px},
      showlegend: false,
      shapes: [],
      annotations: [],
      bargap: 0.06,
    };
    const drawing = {traces: [], layout};
    rows.forEach((row, i) => addHistogram(drawing, row, i, rows.length));
    return drawing;
  }, 'Grey: where 95 % of a true filter’s bars lie. High ends: overconfident; high middle: underconfident.');
  const pick = choiceIfAny('Runs', roles.map((name) => roleNames[name]), 0, (i) => {
    role = roles[i];
    plot.redraw();
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
        const rows = list.filter((row) => row.role === chosen.role);
        const traces = rows.map((row) => autocorrelationTrace(row.states[chosen.state], {
                                  name: shortNames[row.model] || row.model,
                                  line: {color: filterColour(row.model), width: 1.5},
                                  marker: {size: 5},
                                  hovertemplate: 'lag %{x}: %{y:.3f}',
                                }));
        const look = {margin: {l: 64, r: 12, t: 60, b: 44}, legend: legendAbove, showlegend: true};
        return {traces, layout: autocorrelationLayout(rows[0].band, look)};
      },
      `Grey: ${100 * list[0].level} % band of white residuals. Filters: normal scores of the PIT; global model: its ` +
          'one-step residuals.');
  const choose = (key, value) => {
    chosen[key] = value;
    plot.redraw();
  };
  return [
    h('h3', {}, 'Residual autocorrelation'),
    controls(
        choiceIfAny('Runs', roles.map((role) => roleNames[role]), 0, (i) => choose('role', roles[i])),
        choiceIfAny('State', states.map((channel) => channel.name), 0, (i) => choose('state', i))),
    plot
  ];
}

// The paper's figure 5: how many samples lie outside the interval, above and below, training and held out.
function outside(filter) {
  const pooled = filter.scores.filter((row) => row.run === '*');
  const roles = present(pooled, 'role'), filters = present(pooled, 'filter');
  let [[key]] = kindNames;
  const bars = (side, role) => {
    const rows = filters.map((name) => pooled.find((row) => row.filter === name && row.role === role)).filter(Boolean);
    return {
      ...outsideBars(
          rows.map((row) => row[sidesOf[key][side]]), rows.map(() => `${sideNames[side]}, ${roleNames[role]}`)),
      name: `${sideNames[side]}, ${roleOf(role)}`,
      x: rows.map((row) => shortNames[row.filter]),
      marker: {
        color: palette.modes[side === 'above' ? 3 : 5],
        opacity: role === 'test' ? 1 : 0.65,
        pattern: {shape: role === 'test' ? '' : '/'},
      },
    };
  };
  const label =
      'Shares of samples too far from the prediction and too close to it, for each filter; the table of scores ' +
      'holds the same numbers';
  const look = {height: 380, margin: {l: 64, r: 12, t: 76, b: 40}, showlegend: true, legend: legendAbove};
  const plot = figure(
      label, () => ({
               traces: ['above', 'below'].flatMap((side) => roles.map((role) => bars(side, role))),
               layout: outsideLayout(filter.tail, 'samples too close | too far [%]', look),
             }),
      'Dashed: a true filter’s 2.5 % on each side.');
  const pick = choice('By', kindNames.map(([, name]) => name), 0, (i) => {
    [key] = kindNames[i];
    plot.redraw();
  });
  return [h('h3', {}, 'Samples too far and too close'), controls(pick), plot];
}

export function drawFilter(filter, runs, state) {
  const absent = 'This archive holds no evaluation: no filter was run over the data.';
  if (!filter) return section('filter', 'The filter', note(absent));
  return section(
      'filter', 'The filter',
      h('div', {class: 'pair'}, h('div', {}, histograms(filter)),
        h('div', {}, autocorrelations(filter, runs.states), outside(filter))),
      drawScores(filter), drawFreeRun(filter, runs, state));
}
