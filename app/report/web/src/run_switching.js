// The section on the transitions between the modes of a bank, and on the stays in a mode.
import {details, h, note} from './elements.js';
import {roleNames} from './filters.js';
import {modeColour} from './look.js';
import {modeCell, modeTitle} from './mode_names.js';
import {table} from './table.js';

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

// A note above the table. A switch that is rare at the mean of states and inputs may be frequent elsewhere.
const movedSwitches = () => note(
    'These transitions depend on state and input. The matrix is for their training mean, and ' +
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
  return [
    h('h3', {}, 'How modes follow each other'),
    bank.switch_weights ? movedSwitches() : null,
    bank.modes.some((row) => row.stay_seen) ? stayTable(bank) : null,
    bank.switch_weights ? switchWeights(bank.switch_weights) : null,
    details('The transition matrix in numbers', transitionTable(bank)),
  ];
}
