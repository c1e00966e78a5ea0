// How many components: the criteria over K, what the restarts agree on, the table.
import { h, note, section, table } from './common.js';
import { figure, ink, palette } from './plots.js';

const criteria = [['bic', 'BIC'], ['icl', 'ICL'], ['aic', 'AIC'], ['heldout', 'held out [nats]'], ['agreeing', 'restarts that agree [%]']];

function curves(candidates, key) {
  const fitted = candidates.filter((row) => row.status === 'fitted');
  const y = (row) => (key === 'agreeing' ? (row.restarts ? (100 * row.agreeing.v) / row.restarts : null) : row[key].v);
  return ['full', 'diagonal'].map((covariance, i) => {
    const rows = fitted.filter((row) => row.covariance === covariance && y(row) !== null);
    return { x: rows.map((row) => row.components), y: rows.map(y), text: rows.map((row) => `${covariance}, K = ${row.components}: ${row[key].t}`), hoverinfo: 'text', type: 'scatter', mode: 'lines+markers', name: covariance,
      line: { color: palette.modes[i], dash: i ? 'dot' : 'solid', width: 1.6 }, marker: { size: 6, symbol: i ? 'square' : 'circle', color: palette.modes[i] } };
  }).filter((trace) => trace.x.length);
}

function panels(candidates) {
  const list = criteria.filter(([key]) => curves(candidates, key).length), chosen = candidates.find((row) => row.selected);
  const make = () => {
    const columns = window.innerWidth < 700 ? 1 : Math.min(3, list.length), lines = Math.ceil(list.length / columns);
    const layout = { height: 230 * lines + 40, margin: { l: 64, r: 12, t: 36, b: 44 }, showlegend: list.some(([key]) => curves(candidates, key).length > 1), legend: { orientation: 'h', y: 1.02, yanchor: 'bottom' }, shapes: [] };
    const traces = [];
    list.forEach(([key, name], i) => {
      const n = i ? i + 1 : '', column = i % columns, row = Math.floor(i / columns), wide = 1 / columns, high = 1 / lines;
      layout[`xaxis${n}`] = { title: { text: 'components K', standoff: 3 }, domain: [column * wide + (column ? 0.05 : 0), (column + 1) * wide - 0.02], anchor: `y${n}`, dtick: candidates.length > 24 ? 4 : candidates.length > 12 ? 2 : 1 };
      layout[`yaxis${n}`] = { title: { text: name, standoff: 4 }, domain: [1 - (row + 1) * high + 0.32 / lines * 0.6, 1 - row * high - 0.03], anchor: `x${n}`, nticks: 5, ...(key === 'agreeing' ? { range: [0, 104] } : {}) };
      for (const trace of curves(candidates, key)) traces.push({ ...trace, xaxis: `x${n}`, yaxis: `y${n}`, showlegend: i === 0 });
      if (chosen) layout.shapes.push({ type: 'line', xref: `x${n}`, yref: `y${n} domain`, x0: chosen.components, x1: chosen.components, y0: 0, y1: 1, line: { color: ink(), width: 1, dash: 'dash' } });
    });
    return { traces, layout };
  };
  return figure('Criteria over the number of components; the table below holds the same numbers', make,
    `Lower is better for BIC, ICL and AIC, higher for held out.${chosen ? ` Dashed: the chosen K = ${chosen.components}.` : ''}`);
}

export function drawSelection(selection) {
  if (!selection) return section('selection', 'How many components', note('This archive holds no mixture: nothing was clustered.'));
  const rows = selection.candidates, cell = (key) => (row) => row[key];
  const columns = [{ name: 'K', of: cell('components') }, { name: 'Shape', text: true, of: cell('covariance') }, { name: 'log likelihood', of: cell('log_likelihood') }, { name: 'q', of: cell('parameters') },
    { name: 'N_eff', of: cell('effective_samples') }, { name: 'BIC', of: cell('bic') }, { name: 'ICL', of: cell('icl') }, { name: 'AIC', of: cell('aic') }, { name: 'naive BIC', of: cell('bic_naive') },
    { name: 'held out', of: cell('heldout') }, { name: 'Iterations', of: cell('iterations') }, { name: 'Converged', text: true, of: cell('converged') }, { name: 'Restarts agree', of: cell('agreeing') },
    { name: 'Status', text: true, of: (row) => (row.selected ? 'chosen' : row.status) }];
  return section('selection', 'How many components', rows.length > 1 ? panels(rows) : note('One number of components was asked for, so there was nothing to choose.'),
    selection.warnings.map((text) => note(text, true)), table(columns, rows, { caption: 'Candidates', sortable: true, chosen: (row) => row.selected }));
}
