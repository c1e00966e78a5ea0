// The bank: its modes, how they follow each other, how long they last.
import { facts, h, note, section, table } from './common.js';
import { filterColour, figure, modeColour } from './plots.js';
import { transitionGraph } from './graph.js';
import { roleNames } from './filters.js';

function modeColumns(bank) {
  const list = (key, names) => names.map((name, i) => ({ name, of: (row) => row[key] && row[key][i] }));
  const seen = bank.modes.some((row) => row.usage);
  return [{ name: 'Mode', text: true, of: (row) => row.name, swatch: (row) => row.colour }, { name: 'Weight', of: (row) => row.weight },
    ...list('motion', bank.motion_names), ...list('parameters', bank.parameter_names), { name: bank.noise_name, of: (row) => row.noise_sd },
    { name: 'Time constants', of: (row) => row.decays }, ...list('gains', bank.gain_names.map((name) => `steady gain ${name}`)),
    ...(seen ? [{ name: 'Usage', of: (row) => row.usage }, { name: 'PIT above', of: (row) => row.tail_above }, { name: 'PIT below', of: (row) => row.tail_below }, { name: 'Verdict', text: true, of: (row) => row.verdict }] : [])];
}

function dwellFigure(bank) {
  const stays = bank.modes.flatMap((row) => [row.dwell?.v, row.dwell_model?.v]).filter((v) => v > 0);
  const wide = Math.max(...stays) > 20 * Math.min(...stays);
  return figure('Mean stay in each mode; the table below holds the same numbers', () => {
    const x = bank.modes.map((row) => `mode ${row.mode}`), bar = (key, name, opacity) => ({ type: 'bar', name, x, y: bank.modes.map((row) => row[key]?.v ?? null), text: bank.modes.map((row) => `${name}: ${row[key]?.t ?? '–'} samples`), textposition: 'none', hoverinfo: 'text+x',
      marker: { color: bank.modes.map((row) => modeColour(row.mode)), opacity, pattern: { shape: opacity < 1 ? '/' : '' } } });
    return { traces: [bar('dwell', 'seen', 1), bar('dwell_model', 'by T', 0.55)], layout: { height: 300, barmode: 'group', showlegend: false, yaxis: { title: { text: 'mean stay [samples]' }, type: wide ? 'log' : 'linear', dtick: wide ? 'D2' : undefined }, xaxis: { type: 'category' } } };
  }, `Full: mean stay along the most probable sequence, ${roleNames[bank.role]}. Hatched: what the transition matrix says, 1 / (1 − T).`);
}

function transitionTable(transition) {
  const columns = [{ name: 'from \\ to', text: true, of: (row) => `mode ${row.k}`, swatch: (row) => modeColour(row.k) }, ...transition.map((_, j) => ({ name: String(j), of: (row) => row.cells[j] }))];
  return table(columns, transition.map((cells, k) => ({ cells, k })), { caption: 'Transition probabilities per sample' });
}

function transitionMap(transition) {
  const names = transition.map((_, k) => `mode ${k}`);
  return figure('Transition probabilities as a map; the matrix in numbers stands below', () => ({
    traces: [{ type: 'heatmap', x: names, y: names, z: transition.map((row) => row.map((cell) => Math.log10(Math.max(cell.v, 1e-4)))), zmin: -4, zmax: 0, colorscale: 'Cividis', reversescale: false, xgap: 1, ygap: 1,
      text: transition.map((row, i) => row.map((cell, j) => `from ${i} to ${j}: ${cell.t}`)), hoverinfo: 'text', colorbar: { title: { text: 'probability', side: 'right' }, tickvals: [-4, -3, -2, -1, 0], ticktext: ['≤ 0.0001', '0.001', '0.01', '0.1', '1'], thickness: 12 } }],
    layout: { height: 400, margin: { l: 70, r: 10, t: 32, b: 56 }, xaxis: { title: { text: 'to' }, type: 'category', tickangle: transition.length > 6 ? -90 : 0 }, yaxis: { title: { text: 'from' }, type: 'category', autorange: 'reversed' } } }));
}

export function drawBank(bank) {
  if (!bank) return section('bank', 'The bank', note('This archive holds no bank: no modes were learned.'));
  const rows = bank.modes.map((row) => ({ ...row, name: String(row.mode), colour: modeColour(row.mode) }));
  if (bank.baseline) rows.push({ ...bank.baseline, name: 'baseline', colour: filterColour('baseline') });
  return section('bank', 'The bank',
    facts([['Model', bank.model], ['Sample period', `${bank.dt_s.t} s`], ['Measurement noise variance R', bank.R.t], ['Modes are', bank.refined ? 'refined by expectation-maximisation: they are no longer the mixture’s components' : 'the mixture’s components'],
      ...(bank.merged ? [['Limit on modes', `${bank.merged.components} components merged; log score on ${roleNames[bank.role]} ${bank.merged.log_score.t}, without the limit (${bank.merged.modes_unlimited} modes) ${bank.merged.log_score_unlimited.t}: a loss of ${bank.merged.loss.t} nats per sample`]] : [])]),
    table(modeColumns(bank), rows, { caption: `Modes (± one standard error; usage and PIT tails on ${roleNames[bank.role]})`, sortable: true }),
    bank.screened.length ? table([{ name: 'Component', of: (row) => row.component }, { name: 'Weight', of: (row) => row.weight }, { name: 'Spectral radius', of: (row) => row.radius }, { name: 'Left out because', prose: true, of: (row) => row.reason }], bank.screened, { caption: 'Components that were left out of the bank' }) : null,
    bank.modes.length > 1 ? [h('h3', {}, 'How modes follow each other'), h('div', { class: 'pair' }, h('div', {}, transitionGraph(bank.transition, bank.modes.map((row) => row.weight.v))), h('div', { style: 'min-width:0' }, transitionMap(bank.transition))),
      h('details', { open: bank.modes.length <= 6 }, h('summary', {}, 'The matrix in numbers'), transitionTable(bank.transition)),
      bank.modes.some((row) => row.dwell) ? [h('h3', {}, 'How long they last'), dwellFigure(bank), table([{ name: 'Mode', text: true, of: (row) => String(row.mode), swatch: (row) => modeColour(row.mode) }, { name: 'Seen [samples]', of: (row) => row.dwell }, { name: 'By T [samples]', of: (row) => row.dwell_model }], bank.modes, { caption: 'Mean stay' })] : null] : note('One mode: it has nothing to switch to.'));
}
