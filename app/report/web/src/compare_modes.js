// The modes of A and of B, side by side.
import {h, note} from './elements.js';
import {section} from './page.js';
import {table} from './table.js';

function modeTable(bank, letter) {
  if (!bank) return note(`${letter} has no bank.`);
  const [key, names] = bank.motion_names.length ? ['motion', bank.motion_names] : ['parameters', bank.parameter_names];
  const columns = [
    {name: 'Mode', text: true, of: (k) => (bank.modes[k].name ? `${k} ${bank.modes[k].name}` : String(k))},
    {name: 'Used', of: (k) => bank.modes[k].use},
    ...names.map((name, i) => ({name, of: (k) => bank.modes[k][key][i]})),
  ];
  return table(columns, bank.order, {caption: `Modes of ${letter}, most used first`, sortable: true});
}

export const drawModes = ({runs: [{bank: a}, {bank: b}]}) =>
    section('modes', 'Modes side by side', h('div', {class: 'pair'}, modeTable(a, 'A'), modeTable(b, 'B')));
