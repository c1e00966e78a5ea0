// Rows of time plots: states with predictions, inputs, mode probabilities, innovations, NIS. A layer draws one filter:
// {of: run => its filter or null, prefix: '', band, opacity, line}. Free runs of several filters have several layers.
//
// A row is {title, height, draw: async ({run, clock, shown, range}) => traces, read: async (run, k) => entries, range,
// log, levels}. `read` returns the values of the signals at sample k. For k = -1 it returns entries of a legend.
import {INK, modeColour, palette, translucent} from './look.js';
import {modeTitle, rankOf} from './mode_names.js';
import {array} from './page_data.js';
import {band, bounds, line, share, valueAt} from './signals.js';

const most_outliers = 3000;
const few_markers = 700;
const few_nis = 3000;
const told_modes = 4;

/** @typedef {import('./time_drawing.js').Trace} Trace */
/** @typedef {{name: string, colour: string, unit?: string, value?: {low: number, high: number}}} Entry */

export const titleOf = ({name, unit}) => (unit ? `${name} [${unit}]` : name);

// An entry in the readout of a row. For k < 0 it has only a name and a colour.
async function told(signal, k, entry) {
  return k < 0 || !signal ? entry : {...entry, value: await valueAt(signal, k)};
}

// The edges of a band at sample k.
async function toldBand(filter, i, k, entry) {
  if (k < 0) return entry;
  const center = await valueAt((filter.center || filter.prediction)[i], k),
        half = await valueAt(filter.half_width[i], k);
  const bySample = center.low === center.high;
  const low = bySample ? center.low - half.low : (await valueAt(filter.lower[i], k)).low;
  const high = bySample ? center.low + half.low : (await valueAt(filter.upper[i], k)).high;
  return {...entry, band: true, value: {low, high}};
}

async function predictionTraces(layer, filter, i, {clock, shown}) {
  const edges = {
    center:
        (filter.center || filter.prediction)[i],  // the band of a free run need not be symmetric about the prediction
    half: filter.half_width[i],
    lowest: filter.lower[i],
    highest: filter.upper[i],
  };
  return [
    {
      ...(await band(edges, clock, shown)),
      kind: 'area',
      colour: translucent(layer.band, layer.opacity),
      name: `${layer.prefix}band`
    },
    {
      ...(await line(filter.prediction[i], clock, shown)),
      kind: 'line',
      colour: layer.line,
      width: 1.4,
      name: `${layer.prefix}predicted`
    },
  ];
}

async function measuredTraces(signal, {clock, shown}) {
  const measured = await line(signal, clock, shown), look = {colour: INK, name: 'measured'};
  const curve = {...measured, ...look, kind: 'line', width: 1};
  if (measured.per > 1 || measured.y.length > few_markers) return [curve];
  return [curve, {...measured, ...look, kind: 'dots', size: 1.6}];
}

async function outlierTrace(outliers, i, range) {
  const times = await array(outliers.time), values = await array(outliers.values[i]), x = [], y = [];
  for (let k = 0; k < times.length && x.length < most_outliers; ++k) {
    if (times[k] < range[0] || times[k] > range[1]) continue;
    x.push(times[k]);
    y.push(values[k]);
  }
  return {x, y, kind: 'dots', symbol: 'ring', size: 4.5, colour: palette.outlier, name: 'outlier'};
}

async function stateTraces(layers, i, view) {
  const {run, clock, shown, range} = view, traces = [], filters = layers.map((layer) => layer.of(run));
  for (const [k, layer] of layers.entries()) {
    if (filters[k]) traces.push(...(await predictionTraces(layer, filters[k], i, view)));
  }
  if (run.truth) {
    const truth = await line(run.truth[i], clock, shown);
    traces.push({...truth, kind: 'line', colour: palette.truth, width: 1.2, dash: 'dot', name: 'truth'});
  }
  traces.push(...(await measuredTraces(run.state[i], view)));
  const [filter] = filters;
  if (layers.length === 1 && filter && filter.outliers && filter.outliers.count) {
    traces.push(await outlierTrace(filter.outliers, i, range));
  }
  return traces;
}

function stateEntries(layers, i, unit, run, k) {
  const entries = [told(run.state[i], k, {name: 'measured', unit, colour: INK})];
  for (const layer of layers) {
    const filter = layer.of(run);
    if (!filter) continue;
    const {prefix} = layer;
    entries.push(
        told(filter.prediction[i], k, {name: `${prefix}predicted`, unit, colour: layer.line}),
        toldBand(filter, i, k, {name: `${prefix}band`, unit, colour: layer.band}));
  }
  if (run.truth) entries.push(told(run.truth[i], k, {name: 'truth', unit, colour: palette.truth}));
  return Promise.all(entries);
}

// Measured state i with the band and prediction of each layer, and the true state. Outliers are drawn only if there is
// a single layer.
export function stateRow(runs, i, layers) {
  return {
    title: titleOf(runs.states[i]),
    height: 230,
    draw: (view) => stateTraces(layers, i, view),
    read: (run, k) => stateEntries(layers, i, runs.states[i].unit, run, k),
  };
}

// All inputs with the same unit in one row. Their colours differ from the colours of modes.
export function inputRows(runs) {
  const look = (k) => ({
    colour: palette.inputs[k % palette.inputs.length],
    dash: /** @type {'dash'|'dot'|undefined} */ ([undefined, 'dash', 'dot'][k % 3]),
  });
  return [...new Set(runs.inputs.map((channel) => channel.unit))].map((unit) => {
    const which = runs.inputs.map((_, j) => j).filter((j) => runs.inputs[j].unit === unit);
    const name = (j) => runs.inputs[j].name;
    const draw = ({run, clock, shown}) => Promise.all(which.map(async (j, k) => {
      const curve = await line(run.input[j], clock, shown);
      return {...curve, ...look(k), kind: 'line', width: 1.3, step: curve.per === 1, name: name(j)};
    }));
    const read = (run, sample) =>
        Promise.all(which.map((j, k) => told(run.input[j], sample, {name: name(j), unit, colour: look(k).colour})));
    return {title: titleOf({name: which.length > 1 ? 'inputs' : 'input', unit}), height: 130, draw, read};
  });
}

// The most probable modes at sample k, sorted by probability.
async function modeEntries(filter, k) {
  const byUse = filter.probability.map((_, mode) => mode).sort((a, b) => rankOf(a) - rankOf(b));
  const shares = await Promise.all(
      filter.probability.map((signal, mode) => told(signal, k, {name: modeTitle(mode), colour: modeColour(mode)})));
  if (k < 0) return shares.length <= 2 * told_modes ? byUse.map((mode) => shares[mode]) : [];
  return shares.filter(({value}) => value.low > 0.005).sort((a, b) => b.value.low - a.value.low).slice(0, told_modes);
}

// `of`: run => the filter.
export function probabilityRow(of) {
  const draw = ({run, clock, shown}) => {
    const filter = of(run);
    if (!filter || !filter.probability) return [];
    // The most used modes come first, as in tables and legends.
    const order = filter.probability.map((_, k) => k).sort((a, b) => rankOf(a) - rankOf(b));
    return Promise.all(order.map(async (k) => {
      const curve = await share(filter.probability[k], clock, shown);
      return {...curve, kind: 'shares', step: curve.per === 1, colour: modeColour(k), name: modeTitle(k)};
    }));
  };
  const read = (run, k) => {
    const filter = of(run);
    return filter && filter.probability ? modeEntries(filter, k) : [];
  };
  return {title: 'probability of the modes', height: 110, range: [0, 1], draw, read};
}

export function innovationRow(runs, i, of) {
  const {unit} = runs.states[i], edge = {kind: 'line', colour: palette.prediction, width: 1, name: 'bound'};
  const draw = async ({run, clock, shown}) => {
    const filter = of(run);
    if (!filter) return [];
    const {up, down} = await bounds(filter.half_width[i], clock, shown);
    const innovation = await line(filter.innovation[i], clock, shown);
    return [
      {...up, ...edge}, {...down, ...edge}, {...innovation, kind: 'line', colour: INK, width: 0.9, name: 'innovation'}
    ];
  };
  const read = async (run, k) => {
    const filter = of(run);
    if (!filter) return [];
    return Promise.all([
      told(filter.innovation[i], k, {name: 'innovation', unit, colour: INK}),
      told(filter.half_width[i], k, {name: `± ${100 * runs.level} %`, unit, colour: palette.prediction}),
    ]);
  };
  return {title: `innovation of ${titleOf(runs.states[i])}`, height: 130, draw, read};
}

async function nisTrace(filter, {clock, shown}) {
  const curve = await line(filter.nis, clock, shown), look = {colour: INK, name: 'NIS'};
  if (curve.per === 1 && curve.y.length < few_nis) return {...curve, ...look, kind: 'dots', size: 1.8};
  return {...curve, ...look, kind: 'line', width: 0.8};
}

// `of`: run => the filter.
export function nisRow(runs, of) {
  return {
    title: 'normalised innovation squared (NIS)',
    height: 140,
    log: true,
    range: [1e-4, 300],
    draw: async (view) => (of(view.run) ? [await nisTrace(of(view.run), view)] : []),
    levels: () => runs.nis_bounds.map((height) => ({height, colour: palette.outlier})),
    read: async (run, k) => (of(run) ? [await told(of(run).nis, k, {name: 'NIS', colour: INK})] : []),
  };
}
