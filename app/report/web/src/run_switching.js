// The section on the transitions between the modes of a bank, and on the stays in a mode.
import {details, h, note} from './elements.js';
import {roleNames} from './filters.js';
import {transitionGraph} from './graph.js';
import {modeColour, palette} from './look.js';
import {modeCell, modeTitle} from './mode_names.js';
import {familiesOf, othersName} from './modes.js';
import {table} from './table.js';

// The families that have their own row, and all other families as one node: {title, short, colour, use}.
function nodesOf(bank) {
  const {told, others} = familiesOf(bank);
  const nodes = told.map((row) => ({
                           title: row.title,
                           short: row.modes.length > 1 ? `${row.lead}…` : String(row.lead),
                           colour: modeColour(row.lead),
                           use: row.use.v,
                         }));
  if (!others.length) return nodes;
  const use = others.reduce((sum, row) => sum + row.use.v, 0);
  return [...nodes, {title: othersName(others.length), short: '…', colour: palette.unclustered, use}];
}

function stayTable(bank) {
  return table(
      [
        {name: 'Mode', text: true, of: (row) => modeCell(row.mode), swatch: (row) => modeColour(row.mode)},
        {name: 'Stay seen [s]', of: (row) => row.stay_seen},
        {name: 'Stay by the matrix [s]', of: (row) => row.stay_model},
      ],
      bank.order.map((k) => bank.modes[k]),
      {caption: `Mean stay along the most probable sequence of ${roleNames[bank.role]}, and by the transition matrix`});
}

function transitionTable(bank) {
  const {transition, order} = bank;
  const first = {name: 'from \\ to', text: true, of: (k) => modeTitle(k), swatch: (k) => modeColour(k)};
  const columns = [first, ...order.map((j) => ({name: modeCell(j), of: (k) => transition[k][j]}))];
  return table(columns, order, {caption: 'Transition probabilities per sample'});
}

// A note above the drawing. A switch that is rare at the mean of states and inputs may be frequent elsewhere.
const movedSwitches = () => note(
    'These transitions depend on state and input. Graph and matrix are for their training mean, and ' +
    'each further unit adds the weights in the table to the log odds of a mode. Without an error, the data show only ' +
    'that a weight is large: a hard border.');

/** The weights of state-dependent transitions. */
function switchWeights(weights) {
  const first = {name: 'to', text: true, of: (row) => modeTitle(row.k), swatch: (row) => modeColour(row.k)};
  const columns = [first, ...weights.names.map((name, i) => ({name, of: (row) => row.cells[i]}))];
  const rows = weights.rows.map((cells, k) => ({cells, k}));
  return table(columns, rows, {caption: 'Log odds per unit of state and input'});
}

export function switching(bank) {
  if (bank.modes.length < 2) return note('There is one mode, so there are no switches.');
  const nodes = nodesOf(bank), stays = bank.modes.some((row) => row.stay_seen);
  const folded = bank.folded.length < bank.modes.length;
  return [
    h('h3', {}, 'How modes follow each other'),
    folded ? h('p', {class: 'caption'},
               'Modes of one family are one node, and so are all that are hardly used; the matrix has each mode.') :
             null,
    bank.switch_weights ? movedSwitches() : null,
    h('div', {class: 'pair'}, h('div', {}, transitionGraph(bank.folded, nodes)),
      stays ? h('div', {}, h('h3', {}, 'How long they last'), stayTable(bank)) : null),
    bank.switch_weights ? switchWeights(bank.switch_weights) : null,
    details('The transition matrix in numbers', transitionTable(bank)),
  ];
}
