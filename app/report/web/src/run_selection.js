// The section on the number of components K: criteria over K, agreement of restarts, table.
import {figure} from './chart.js';
import {note} from './elements.js';
import {palette} from './look.js';
import {section} from './page.js';
import {table} from './table.js';

const panelKinds = [
  ['bic', 'BIC'],
  ['aic', 'AIC'],
  ['agreeing', 'restarts that agree [%]'],
];
const shapes = [['full', palette.modes[0], undefined, 'circle'], ['diagonal', palette.modes[1], 'dot', 'square']];

const valueOf = (row, key) => {
  if (key !== 'agreeing') return row[key].v;
  return row.restarts ? (100 * row.agreeing.v) / row.restarts : null;
};

// One line through the candidates for each covariance shape.
function curves(candidates, key) {
  return shapes.flatMap(([covariance, colour, dash, symbol]) => {
    const rows = candidates.filter(
        (row) => row.covariance === covariance && row.status === 'fitted' && valueOf(row, key) !== null);
    if (!rows.length) return [];
    const x = rows.map((row) => row.components), y = rows.map((row) => valueOf(row, key));
    return [{kind: 'line', x, y, colour, dash}, {kind: 'points', name: covariance, x, y, colour, symbol, size: 6}];
  });
}

function panels(candidates) {
  const list = panelKinds.filter(([key]) => curves(candidates, key).length);
  const chosen = candidates.find((row) => row.selected);
  const panelOf = ([key, name]) => ({
    x: {title: 'components K', whole: true},
    y: {title: name, range: key === 'agreeing' ? [0, 104] : null},
    marks: [...curves(candidates, key), ...(chosen ? [{kind: 'rule', x: chosen.components}] : [])],
  });
  const names = new Set(candidates.map((row) => row.covariance));
  const keys = shapes.filter(([name]) => names.has(name)).map(([name, colour]) => [colour, name]);
  const drawing = {panels: list.map(panelOf), height: 150, wide: 330, legend: keys.length > 1 ? keys : null};
  return figure(
      'Criteria over the number of components; the table below has the same numbers', () => drawing,
      `Lower is better.${chosen ? ` Dashed: the chosen K = ${chosen.components}.` : ''}`);
}

const number = (name, key) => ({name, of: (row) => row[key]});
const word = (name, key) => ({name, text: true, of: (row) => row[key]});
const statusText = (row) => [row.selected ? 'chosen' : row.status, row.failed, row.floor_active && 'rests on the floor']
                                .filter(Boolean)
                                .join(', ');
const columns = [
  number('K', 'components'),
  word('Shape', 'covariance'),
  number('log likelihood', 'log_likelihood'),
  number('q', 'parameters'),
  number('N_eff', 'effective_samples'),
  number('BIC', 'bic'),
  number('AIC', 'aic'),
  number('naive BIC', 'bic_naive'),
  number('Iterations', 'iterations'),
  word('Converged', 'converged'),
  number('Restarts agree', 'agreeing'),
  {name: 'Status', text: true, of: statusText},
];

export function drawSelection(selection) {
  const title = 'How many components';
  if (!selection) return section('selection', title, note('This archive has no mixture: nothing was clustered.'));
  const rows = selection.candidates;
  const one = 'Only one number of components was configured, so there was no choice.';
  return section(
      'selection', title, rows.length > 1 ? panels(rows) : note(one),
      selection.warnings.map((text) => note(text, true)),
      table(columns, rows, {caption: 'Candidates', sortable: true, chosen: (row) => row.selected}));
}
