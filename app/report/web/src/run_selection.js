// How many components: the criteria over K, what the restarts agree on, the table.
import {criteria, criterionTrace} from './criteria.js';
import {note} from './elements.js';
import {section} from './page.js';
import {dashedLine, figure, ink, palette} from './plots.js';
import {table} from './table.js';

const panelKinds = [...criteria, ['agreeing', 'restarts that agree [%]']];

// A line for each shape of covariance that was fitted.
function curves(candidates, key) {
  const share = (row) => (row.restarts ? (100 * row.agreeing.v) / row.restarts : null);
  return ['full', 'diagonal']
      .map((covariance, i) => {
        const rows = candidates.filter((row) => row.covariance === covariance), color = palette.modes[i];
        return {
          ...criterionTrace(rows, key, covariance, key === 'agreeing' ? share : undefined),
          line: {color, dash: i ? 'dot' : 'solid', width: 1.6},
          marker: {size: 6, symbol: i ? 'square' : 'circle', color},
        };
      })
      .filter((trace) => trace.x.length);
}

// Axes of panel i of columns times lines.
function panelAxes(key, name, i, columns, lines, candidates) {
  const n = i ? i + 1 : '', column = i % columns, row = Math.floor(i / columns), wide = 1 / columns, high = 1 / lines;
  const dtick = candidates > 24 ? 4 : candidates > 12 ? 2 : 1;
  const across = [column * wide + (column ? 0.05 : 0), (column + 1) * wide - 0.02];
  const up = [1 - (row + 1) * high + (0.32 / lines) * 0.6, 1 - row * high - 0.03];
  const range = key === 'agreeing' ? {range: [0, 104]} : {};
  return {
    [`xaxis${n}`]: {title: {text: 'components K', standoff: 3}, domain: across, anchor: `y${n}`, dtick},
    [`yaxis${n}`]: {title: {text: name, standoff: 4}, domain: up, anchor: `x${n}`, nticks: 5, ...range},
  };
}

function panelsDrawing(candidates, list, chosen) {
  const columns = window.innerWidth < 700 ? 1 : Math.min(3, list.length), lines = Math.ceil(list.length / columns);
  const traces = [];
  const layout = {
    height: 230 * lines + 40,
    margin: {l: 64, r: 12, t: 36, b: 44},
    shapes: [],
    showlegend: list.some(([key]) => curves(candidates, key).length > 1),
    legend: {orientation: 'h', y: 1.02, yanchor: 'bottom'},
  };
  list.forEach(([key, name], i) => {
    const n = i ? i + 1 : '';
    Object.assign(layout, panelAxes(key, name, i, columns, lines, candidates.length));
    for (const trace of curves(candidates, key)) {
      traces.push({...trace, xaxis: `x${n}`, yaxis: `y${n}`, showlegend: i === 0});
    }
    if (!chosen) return;
    const K = chosen.components, line = {color: ink(), width: 1, dash: 'dash'};
    layout.shapes.push(dashedLine(0, {xref: `x${n}`, yref: `y${n} domain`, x0: K, x1: K, y0: 0, y1: 1, line}));
  });
  return {traces, layout};
}

function panels(candidates) {
  const list = panelKinds.filter(([key]) => curves(candidates, key).length);
  const chosen = candidates.find((row) => row.selected);
  return figure(
      'Criteria over the number of components; the table below holds the same numbers',
      () => panelsDrawing(candidates, list, chosen),
      `Lower is better for BIC, ICL and AIC, higher for held out.${
          chosen ? ` Dashed: the chosen K = ${chosen.components}.` : ''}`);
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
  number('ICL', 'icl'),
  number('AIC', 'aic'),
  number('naive BIC', 'bic_naive'),
  number('held out', 'heldout'),
  number('Iterations', 'iterations'),
  word('Converged', 'converged'),
  number('Restarts agree', 'agreeing'),
  {name: 'Status', text: true, of: statusText},
];

export function drawSelection(selection) {
  const title = 'How many components';
  if (!selection) return section('selection', title, note('This archive holds no mixture: nothing was clustered.'));
  const rows = selection.candidates;
  const one = 'One number of components was asked for, so there was nothing to choose.';
  return section(
      'selection', title, rows.length > 1 ? panels(rows) : note(one),
      selection.warnings.map((text) => note(text, true)),
      table(columns, rows, {caption: 'Candidates', sortable: true, chosen: (row) => row.selected}));
}
