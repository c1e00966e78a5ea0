// The rows of a run's time plots: data with prediction, inputs, mode probabilities, innovations, NIS.
import { array } from './common.js';
import { ink, lineColour, modeColour, palette, plain, translucent } from './plots.js';
import { band, bounds, line, share } from './signals.js';

const named = (channel) => plain(channel.unit ? `${channel.name} [${channel.unit}]` : channel.name);
const stroke = (color, width = 1.2, dash) => ({ color: lineColour(color), width, dash, simplify: true });
const step = (per) => (per === 1 ? 'hv' : 'linear');

// Measured state i with the filter's band, prediction, truth and outliers.
export function stateRow(runs, i, options) {
  return { title: named(runs.states[i]), height: options.height || 230, draw: async ({ run, clock, shown, range }) => {
    const traces = [], filter = run.filters[options.filter()];
    if (filter) {
      const outline = await band(filter.prediction[i], filter.half_width[i], filter.lower[i], filter.upper[i], clock, shown);
      traces.push({ ...outline, type: 'scatter', mode: 'lines', fill: 'toself', fillcolor: translucent(palette.band, 0.33), line: { width: 0 }, hoverinfo: 'skip', name: 'band' });
      traces.push({ ...(await line(filter.prediction[i], clock, shown)), type: 'scatter', mode: 'lines', line: stroke(palette.prediction, 1.4), name: 'predicted' });
    }
    if (run.truth) traces.push({ ...(await line(run.truth[i], clock, shown)), type: 'scatter', mode: 'lines', line: stroke(palette.truth, 1.2, 'dot'), name: 'truth' });
    const measured = await line(run.state[i], clock, shown), few = measured.per === 1 && measured.y.length < 700;
    traces.push({ ...measured, type: 'scatter', mode: few ? 'lines+markers' : 'lines', marker: { size: 3, color: ink() }, line: stroke(ink(), 1), name: 'measured' });
    if (filter && filter.outliers.count) {
      const span = range[1] - range[0], all = await array(filter.outliers.time), values = await array(filter.outliers.values[i]), x = [], y = [];
      for (let k = 0; k < all.length && x.length < 3000; ++k) if (all[k] >= range[0] - span / 2 && all[k] <= range[1] + span / 2) { x.push(all[k]); y.push(values[k]); }
      traces.push({ x, y, type: 'scatter', mode: 'markers', marker: { symbol: 'circle-open', size: 9, color: lineColour(palette.outlier), line: { width: 2 } }, name: 'outlier' });
    }
    return traces;
  } };
}

// Inputs that share a unit, in one row; their colours are not those of modes.
export function inputRows(runs) {
  const units = [...new Set(runs.inputs.map((channel) => channel.unit))];
  return units.map((unit) => {
    const which = runs.inputs.map((channel, j) => j).filter((j) => runs.inputs[j].unit === unit);
    const title = which.length <= 3 ? which.map((j) => plain(runs.inputs[j].name)).join(',<br>') : 'inputs';
    return { title: unit ? `${title} [${plain(unit)}]` : title, height: 130, draw: async ({ run, clock, shown }) => Promise.all(which.map(async (j, position) => {
      const curve = await line(run.input[j], clock, shown);
      return { ...curve, type: 'scatter', mode: 'lines', line: { ...stroke(palette.inputs[position % palette.inputs.length], 1.3, ['solid', 'dash', 'dot'][position % 3]), shape: step(curve.per) }, name: plain(runs.inputs[j].name) };
    })) };
  });
}

export function probabilityRow(options) {
  return { title: 'P(mode)', height: 110, axis: { range: [0, 1], fixedrange: true, tickvals: [0, 0.5, 1] }, draw: async ({ run, clock, shown }) => {
    const filter = run.filters[options.filter()];
    if (!filter || !filter.probability) return [];
    return Promise.all(filter.probability.map(async (signal, k) => {
      const curve = await share(signal, clock, shown);
      return { ...curve, type: 'scatter', mode: 'lines', stackgroup: 'modes', line: { width: 0, shape: step(curve.per) }, fillcolor: modeColour(k), name: `mode ${k}`, hovertemplate: `mode ${k}: %{y:.3f}<extra></extra>` };
    }));
  } };
}

export function innovationRow(runs, i, options) {
  return { title: `innovation<br>${named(runs.states[i])}`, height: 150, draw: async ({ run, clock, shown }) => {
    const filter = run.filters[options.filter()];
    if (!filter) return [];
    const { up, down } = await bounds(filter.half_width[i], clock, shown), edge = { type: 'scatter', mode: 'lines', line: stroke(palette.prediction, 1), hoverinfo: 'skip' };
    return [{ ...up, ...edge }, { ...down, ...edge },
      { ...(await line(filter.innovation[i], clock, shown)), type: 'scatter', mode: 'lines', line: stroke(ink(), 0.9), name: 'innovation' }];
  } };
}

export function nisRow(runs, options) {
  const bound = (value) => ({ type: 'line', y0: value, y1: value, line: { color: lineColour(palette.outlier), width: 1.2, dash: 'dash' } });
  return { title: 'NIS', height: 150, axis: { type: 'log', exponentformat: 'power', dtick: 2, range: [-4, 2.5] }, shapes: () => runs.nis_bounds.map(bound), draw: async ({ run, clock, shown }) => {
    const filter = run.filters[options.filter()];
    if (!filter) return [];
    const curve = await line(filter.nis, clock, shown);
    const dots = curve.per === 1 && curve.y.length < 3000;
    return [{ ...curve, type: 'scatter', mode: dots ? 'markers' : 'lines', marker: { size: 3.5, color: ink(), opacity: 0.7 }, line: stroke(ink(), 0.8), name: 'NIS' }];
  } };
}
