// How the modes of a bank follow each other, and how long they last.
import {details, h, note} from './elements.js';
import {roleNames} from './filters.js';
import {transitionGraph} from './graph.js';
import {guardFigure} from './guard.js';
import {modeCell, modeTitle} from './mode_names.js';
import {byUse, othersName} from './modes.js';
import {figure, modeColour, palette, plain} from './plots.js';
import {table} from './table.js';

// The modes told one by one, and all others as one: {title, short, colour, use}.
function nodesOf(bank) {
  const {told, others} = byUse(bank);
  const nodes = told.map((row) => ({
                           title: modeTitle(row.mode),
                           short: String(row.mode),
                           colour: modeColour(row.mode),
                           use: row.use.v,
                         }));
  if (!others.length) return nodes;
  const use = others.reduce((sum, row) => sum + row.use.v, 0);
  return [...nodes, {title: othersName(others.length), short: '…', colour: palette.unclustered, use}];
}

// Mean stays of the modes told one by one as bars.
function stayBars(rows, key, name, hatched) {
  const cells = rows.map((row) => row[key]);
  return {
    type: 'bar',
    name,
    x: rows.map((row) => plain(modeTitle(row.mode))),
    y: cells.map((cell) => (cell ? cell.v : null)),
    text: cells.map((cell) => `${name}: ${cell ? cell.t : '–'} s`),
    textposition: 'none',
    hoverinfo: 'text+x',
    marker: {
      color: rows.map((row) => modeColour(row.mode)),
      opacity: hatched ? 0.55 : 1,
      pattern: {shape: hatched ? '/' : ''},
    },
  };
}

const logTicks = [-3, -2, -1, 0, 1, 2, 3, 4].flatMap((power) => [1, 2, 5].map((k) => Number(`${k}e${power}`)));

function stayFigure(bank) {
  const {told} = byUse(bank);
  const stays = told.flatMap((row) => [row.stay, row.stay_model]).map((cell) => cell && cell.v).filter((v) => v > 0);
  const wide = Math.max(...stays) > 20 * Math.min(...stays);
  const scale = wide ? {type: 'log', tickvals: logTicks, ticktext: logTicks.map(String)} : {type: 'linear'};
  return figure(
      'Mean stay in each mode; the table below holds the same numbers',
      () => ({
        traces: [stayBars(told, 'stay', 'seen', false), stayBars(told, 'stay_model', 'by the transition matrix', true)],
        layout: {
          height: 300,
          barmode: 'group',
          showlegend: false,
          xaxis: {type: 'category'},
          yaxis: {title: {text: 'mean stay [s]'}, ...scale},
        },
      }),
      `Full: mean stay along the most probable sequence, ${
          roleNames[bank.role]}. Hatched: what the transition matrix says.`);
}

function stayTable(bank) {
  return table(
      [
        {name: 'Mode', text: true, of: (row) => modeCell(row.mode), swatch: (row) => modeColour(row.mode)},
        {name: 'Stay seen [s]', of: (row) => row.stay},
        {name: 'Stay by the matrix [s]', of: (row) => row.stay_model},
      ],
      bank.order.map((k) => bank.modes[k]), {caption: 'Mean stay'});
}

function transitionTable(bank) {
  const {transition, order} = bank;
  const first = {name: 'from \\ to', text: true, of: (k) => modeTitle(k), swatch: (k) => modeColour(k)};
  const columns = [first, ...order.map((j) => ({name: modeCell(j), of: (k) => transition[k][j]}))];
  return table(columns, order, {caption: 'Transition probabilities per sample'});
}

function transitionMap(nodes, folded) {
  const names = nodes.map((node) => plain(node.title)), least = -4;
  const trace = {
    type: 'heatmap',
    x: names,
    y: names,
    colorscale: 'Cividis',
    reversescale: false,
    xgap: 1,
    ygap: 1,
    hoverinfo: 'text',
    z: folded.map((row) => row.map((cell) => Math.log10(Math.max(cell.v, 10 ** least)))),
    zmin: least,
    zmax: 0,
    text: folded.map((row, i) => row.map((cell, j) => `from ${names[i]} to ${names[j]}: ${cell.t}`)),
    colorbar: {
      title: {text: 'probability per sample', side: 'right'},
      thickness: 12,
      tickvals: [-4, -3, -2, -1, 0],
      ticktext: ['≤ 0.0001', '0.001', '0.01', '0.1', '1'],
    },
  };
  const layout = {
    height: 400,
    margin: {l: 70, r: 10, t: 32, b: 56},
    xaxis: {title: {text: 'to', standoff: 8}, type: 'category', tickangle: nodes.length > 4 ? -90 : 0},
    yaxis: {title: {text: 'from'}, type: 'category', autorange: 'reversed'},
  };
  return figure(
      'Transition probabilities as a map; the matrix in numbers stands below', () => ({traces: [trace], layout}));
}

// Said before what is drawn: a switch that never happens at the mean may happen all the time elsewhere.
const movedSwitches = () => note(
    'State and input move these switches: graph, map and matrix hold where they are at their training mean, and ' +
    'each unit more adds the weights in the table to the log odds of a mode. Where no error stands, data say that a ' +
    'weight is large and no more: a hard border.');

/** The weights of switches that see state and input. */
function switchWeights(weights) {
  const first = {name: 'to', text: true, of: (row) => modeTitle(row.k), swatch: (row) => modeColour(row.k)};
  const columns = [first, ...weights.names.map((name, i) => ({name, of: (row) => row.cells[i]}))];
  const rows = weights.rows.map((cells, k) => ({cells, k}));
  return table(columns, rows, {caption: 'Log odds per unit of state and input'});
}

function guard(bank) {
  if (!bank.guard) return null;
  return [h('h3', {}, 'Which states and inputs belong to which mode'), guardFigure(bank)];
}

export function switching(bank) {
  if (bank.modes.length < 2) return note('One mode: it has nothing to switch to.');
  const nodes = nodesOf(bank), stays = bank.modes.some((row) => row.stay);
  const map = h('div', {style: 'min-width:0'}, transitionMap(nodes, bank.folded));
  const pair = h('div', {class: 'pair'}, h('div', {}, transitionGraph(bank.folded, nodes)), map);
  const folded = bank.order.length > bank.told;
  return [
    guard(bank),
    h('h3', {}, 'How modes follow each other'),
    folded ? h('p', {class: 'caption'}, 'Modes that are hardly used are taken as one; the matrix has each.') : null,
    bank.switch_weights ? movedSwitches() : null,
    pair,
    bank.switch_weights ? switchWeights(bank.switch_weights) : null,
    details('The transition matrix in numbers', transitionTable(bank)),
    stays ? [h('h3', {}, 'How long they last'), stayFigure(bank), details('Mean stays in numbers', stayTable(bank))] :
            null,
  ];
}
