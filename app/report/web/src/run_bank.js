// The bank: its modes, how they follow each other, how long they last.
import {details, facts, h, note} from './elements.js';
import {roleNames} from './filters.js';
import {transitionGraph} from './graph.js';
import {guardFigure} from './guard.js';
import {modeCell, modeTitle} from './mode_names.js';
import {section} from './page.js';
import {figure, filterColour, modeColour, plain} from './plots.js';
import {table} from './table.js';

function modeColumns(bank) {
  const list = (key, names) => names.map((name, i) => ({name, of: (row) => row[key] && row[key][i]}));
  const seen = [
    {name: 'Usage', of: (row) => row.usage},
    {name: 'Stay [s]', of: (row) => row.stay},
    {name: 'too far', of: (row) => row.too_far},
    {name: 'too close', of: (row) => row.too_close},
    {name: 'Verdict', text: true, of: (row) => row.verdict},
  ];
  return [
    {name: 'Mode', text: true, of: (row) => row.name, swatch: (row) => row.colour},
    {name: 'Weight', of: (row) => row.weight},
    ...list('motion', bank.motion_names),
    ...list('parameters', bank.parameter_names),
    {name: bank.noise_name, of: (row) => row.noise_sd},
    {name: 'Decay per sample', of: (row) => row.per_sample},
    {name: 'Time constants', of: (row) => row.decays},
    ...list('gains', bank.gain_names.map((name) => `steady gain ${name}`)),
    ...(bank.modes.some((row) => row.usage) ? seen : []),
  ];
}

// Mean stays of all modes as bars: `cells` in the rows' order.
function dwellBars(bank, cells, name, hatched) {
  return {
    type: 'bar',
    name,
    x: bank.modes.map((row) => plain(modeTitle(row.mode))),
    y: cells.map((cell) => (cell ? cell.v : null)),
    text: cells.map((cell) => `${name}: ${cell ? cell.t : '–'} samples`),
    textposition: 'none',
    hoverinfo: 'text+x',
    marker: {
      color: bank.modes.map((row) => modeColour(row.mode)),
      opacity: hatched ? 0.55 : 1,
      pattern: {shape: hatched ? '/' : ''},
    },
  };
}

function dwellFigure(bank) {
  const seen = bank.modes.map((row) => row.dwell), modelled = bank.modes.map((row) => row.dwell_model);
  const stays = [...seen, ...modelled].map((cell) => cell && cell.v).filter((v) => v > 0);
  const wide = Math.max(...stays) > 20 * Math.min(...stays);
  const scale = wide ? {type: 'log', dtick: 'D2'} : {type: 'linear'};
  return figure(
      'Mean stay in each mode; the table below holds the same numbers',
      () => ({
        traces: [dwellBars(bank, seen, 'seen', false), dwellBars(bank, modelled, 'by T', true)],
        layout: {
          height: 300,
          barmode: 'group',
          showlegend: false,
          xaxis: {type: 'category'},
          yaxis: {title: {text: 'mean stay [samples]'}, ...scale},
        },
      }),
      `Full: mean stay along the most probable sequence, ${
          roleNames[bank.role]}. Hatched: what the transition matrix ` +
          'says, 1 / (1 − T).');
}

function dwellTable(bank) {
  return table(
      [
        {name: 'Mode', text: true, of: (row) => modeCell(row.mode), swatch: (row) => modeColour(row.mode)},
        {name: 'Seen [samples]', of: (row) => row.dwell},
        {name: 'By T [samples]', of: (row) => row.dwell_model},
      ],
      bank.modes, {caption: 'Mean stay'});
}

function transitionTable(transition) {
  const first = {name: 'from \\ to', text: true, of: (row) => modeTitle(row.k), swatch: (row) => modeColour(row.k)};
  const columns = [first, ...transition.map((_, j) => ({name: modeCell(j), of: (row) => row.cells[j]}))];
  const rows = transition.map((cells, k) => ({cells, k}));
  return table(columns, rows, {caption: 'Transition probabilities per sample'});
}

function transitionMap(transition) {
  const names = transition.map((_, k) => plain(modeTitle(k))), least = -4;
  const trace = {
    type: 'heatmap',
    x: names,
    y: names,
    colorscale: 'Cividis',
    reversescale: false,
    xgap: 1,
    ygap: 1,
    hoverinfo: 'text',
    z: transition.map((row) => row.map((cell) => Math.log10(Math.max(cell.v, 10 ** least)))),
    zmin: least,
    zmax: 0,
    text: transition.map((row, i) => row.map((cell, j) => `from ${i} to ${j}: ${cell.t}`)),
    colorbar: {
      title: {text: 'probability', side: 'right'},
      thickness: 12,
      tickvals: [-4, -3, -2, -1, 0],
      ticktext: ['≤ 0.0001', '0.001', '0.01', '0.1', '1'],
    },
  };
  const layout = {
    height: 400,
    margin: {l: 70, r: 10, t: 32, b: 56},
    xaxis: {title: {text: 'to'}, type: 'category', tickangle: transition.length > 6 ? -90 : 0},
    yaxis: {title: {text: 'from'}, type: 'category', autorange: 'reversed'},
  };
  return figure(
      'Transition probabilities as a map; the matrix in numbers stands below', () => ({traces: [trace], layout}));
}

/** The weights of switches that see state and input. */
function switchWeights(weights) {
  const first = {name: 'to', text: true, of: (row) => modeTitle(row.k), swatch: (row) => modeColour(row.k)};
  const columns = [first, ...weights.names.map((name, i) => ({name, of: (row) => row.cells[i]}))];
  return [
    note(
        'State and input move these switches: the matrix holds where they are at their training mean, and each unit ' +
        'more adds the weights to the log odds of a mode. Where no error stands, data say that a weight is large and ' +
        'no more: a hard border.'),
    table(columns, weights.rows.map((cells, k) => ({cells, k})), {caption: 'Log odds per unit of state and input'}),
  ];
}

function switching(bank) {
  if (bank.modes.length < 2) return note('One mode: it has nothing to switch to.');
  const matrix = details('The matrix in numbers', transitionTable(bank.transition));
  matrix.open = bank.modes.length <= 6;
  const graph = transitionGraph(bank.transition, bank.modes.map((row) => row.weight.v));
  const map = h('div', {style: 'min-width:0'}, transitionMap(bank.transition));
  const pair = h('div', {class: 'pair'}, h('div', {}, graph), map);
  const stays = bank.modes.some((row) => row.dwell);
  return [
    h('h3', {}, 'How modes follow each other'),
    pair,
    bank.switch_weights ? switchWeights(bank.switch_weights) : null,
    bank.guard ?
        [h('h3', {}, 'Which states and inputs belong to which mode'), guardFigure(bank.guard, bank.modes.length)] :
        null,
    matrix,
    stays ? [h('h3', {}, 'How long they last'), dwellFigure(bank), dwellTable(bank)] : null,
  ];
}

function bankFacts(bank) {
  const {merged} = bank;
  const refined = 'refined by expectation-maximisation: they are no longer the mixture’s components';
  const limit = merged &&
      `${merged.components} components merged; log score on ${roleNames[bank.role]} ` +
          `${merged.log_score.t}, without the limit (${merged.modes_unlimited} modes) ${
              merged.log_score_unlimited.t}: ` +
          `a loss of ${merged.loss.t} nats per sample`;
  return facts([
    ['Model', bank.model],
    ['Sample period', `${bank.dt_s.t} s`],
    ['Measurement noise variance R', bank.R.t],
    ['Modes are', bank.refined ? refined : 'the mixture’s components'],
    ['Limit on modes', limit],
  ]);
}

function screenedTable(screened) {
  if (!screened.length) return null;
  return table(
      [
        {name: 'Component', of: (row) => row.component},
        {name: 'Weight', of: (row) => row.weight},
        {name: 'Spectral radius', of: (row) => row.radius},
        {name: 'Left out because', prose: true, of: (row) => row.reason},
      ],
      screened, {caption: 'Components that were left out of the bank'});
}

// Which modes each label's samples were taken for.
function confusionTable(bank) {
  const {confusion} = bank;
  if (!confusion) return null;
  const columns = [
    {name: 'Label', text: true, of: (row) => row.label},
    {name: 'Samples', of: (row) => row.samples},
    ...bank.modes.map(({mode}) => ({name: modeTitle(mode), of: (row) => row.shares[mode]})),
  ];
  const caption = `Most probable mode of each label’s samples (${roleNames[confusion.role]})`;
  return [h('h3', {}, 'Modes and labels'), table(columns, confusion.rows, {caption})];
}

export function drawBank(bank) {
  if (!bank) return section('bank', 'The bank', note('This archive holds no bank: no modes were learned.'));
  const rows = bank.modes.map((row) => ({...row, name: modeCell(row.mode), colour: modeColour(row.mode)}));
  if (bank.baseline) rows.push({...bank.baseline, name: 'baseline', colour: filterColour('baseline')});
  const caption = `Modes (± one standard error; usage and samples too far and too close on ${roleNames[bank.role]})`;
  return section(
      'bank', 'The bank', bankFacts(bank), table(modeColumns(bank), rows, {caption, sortable: true}),
      confusionTable(bank), screenedTable(bank.screened), switching(bank));
}
