// The rows of plots over time: states with predictions, inputs, mode probabilities, innovations, NIS. What belongs to
// one filter is drawn by a layer: {of: run => its filter or null, prefix: '', band, line: colours, stroke: more of its
// lines, symbol}. A page of one run has one layer, a page that compares two runs has two.
import {modeTitle} from './mode_names.js';
import {array} from './page_data.js';
import {axisTitle, dashedLine, ink, lineColour, modeColour, palette, plain, translucent} from './plots.js';
import {band, bounds, line, share} from './signals.js';

const most_outliers = 3000;
const few_markers = 700;
const few_nis = 3000;

const lines = {
  type: 'scatter',
  mode: 'lines'
};
const stroke = (color, width = 1.2, dash) => ({color: lineColour(color), width, dash, simplify: true});
const shapeOf = (per) => (per === 1 ? 'hv' : 'linear');

async function predictionTraces(layer, filter, i, {clock, shown}) {
  const edges = {
    center: (filter.center || filter.prediction)[i],  // a free run's band need not be symmetric
    half: filter.half_width[i],
    lowest: filter.lower[i],
    highest: filter.upper[i],
  };
  const fillcolor = translucent(layer.band, layer.opacity);
  return [
    {
      ...(await band(edges, clock, shown)),
      ...lines,
      fill: 'toself',
      fillcolor,
      line: {width: 0},
      hoverinfo: 'skip',
      name: `${layer.prefix}band`,
    },
    {
      ...(await line(filter.prediction[i], clock, shown)),
      ...lines,
      line: {...stroke(layer.line, 1.4), ...layer.stroke},
      name: `${layer.prefix}predicted`,
    },
  ];
}

async function measuredTrace(signal, {clock, shown}) {
  const measured = await line(signal, clock, shown), few = measured.per === 1 && measured.y.length < few_markers;
  const mode = few ? 'lines+markers' : 'lines';
  return {...measured, ...lines, mode, marker: {size: 3, color: ink()}, line: stroke(ink(), 1), name: 'measured'};
}

// Those in view or half a view beside it.
async function outlierTrace(outliers, i, range) {
  const reach = (range[1] - range[0]) / 2;
  const times = await array(outliers.time), values = await array(outliers.values[i]), x = [], y = [];
  for (let k = 0; k < times.length && x.length < most_outliers; ++k) {
    if (times[k] < range[0] - reach || times[k] > range[1] + reach) continue;
    x.push(times[k]);
    y.push(values[k]);
  }
  const marker = {symbol: 'circle-open', size: 9, color: lineColour(palette.outlier), line: {width: 2}};
  return {x, y, type: 'scatter', mode: 'markers', marker, name: 'outlier'};
}

// Measured state i with each layer's band and prediction, truth and, for a single layer, outliers.
export function stateRow(runs, i, layers, height = 230) {
  const draw = async (view) => {
    const {run, clock, shown, range} = view, traces = [], filters = layers.map((layer) => layer.of(run));
    for (const [k, layer] of layers.entries()) {
      if (filters[k]) traces.push(...(await predictionTraces(layer, filters[k], i, view)));
    }
    if (run.truth) {
      const truth = await line(run.truth[i], clock, shown);
      traces.push({...truth, ...lines, line: stroke(palette.truth, 1.2, 'dot'), name: 'truth'});
    }
    traces.push(await measuredTrace(run.state[i], view));
    const [filter] = filters;
    if (layers.length === 1 && filter && filter.outliers && filter.outliers.count) {
      traces.push(await outlierTrace(filter.outliers, i, range));
    }
    return traces;
  };
  return {title: axisTitle(runs.states[i]), height, draw};
}

// Inputs that share a unit, in one row; their colours are not those of modes.
export function inputRows(runs) {
  const colour = (k) => palette.inputs[k % palette.inputs.length];
  const dash = (k) => ['solid', 'dash', 'dot'][k % 3];
  return [...new Set(runs.inputs.map((channel) => channel.unit))].map((unit) => {
    const which = runs.inputs.map((_, j) => j).filter((j) => runs.inputs[j].unit === unit);
    const name = (j) => plain(runs.inputs[j].name);
    const title = which.length <= 3 ? which.map(name).join(',<br>') : 'inputs';
    const draw = ({run, clock, shown}) => Promise.all(which.map(async (j, k) => {
      const curve = await line(run.input[j], clock, shown);
      return {...curve, ...lines, line: {...stroke(colour(k), 1.3, dash(k)), shape: shapeOf(curve.per)}, name: name(j)};
    }));
    return {title: unit ? `${title} [${plain(unit)}]` : title, height: 130, draw};
  });
}

// `of`: run => the filter; `title` where there are several.
export function probabilityRow(of, title = 'P(mode)') {
  const draw = ({run, clock, shown}) => {
    const filter = of(run);
    if (!filter || !filter.probability) return [];
    return Promise.all(filter.probability.map(async (signal, k) => {
      const curve = await share(signal, clock, shown), name = plain(modeTitle(k));
      return {
        ...curve,
        ...lines,
        stackgroup: 'modes',
        line: {width: 0, shape: shapeOf(curve.per)},
        fillcolor: modeColour(k),
        name,
        hovertemplate: '%{fullData.name}: %{y:.3f}<extra></extra>',
      };
    }));
  };
  return {title, height: 110, axis: {range: [0, 1], fixedrange: true, tickvals: [0, 0.5, 1]}, draw};
}

export function innovationRow(runs, i, of) {
  const draw = async ({run, clock, shown}) => {
    const filter = of(run);
    if (!filter) return [];
    const {up, down} = await bounds(filter.half_width[i], clock, shown);
    const edge = {...lines, line: stroke(palette.prediction, 1), hoverinfo: 'skip'};
    const innovation = await line(filter.innovation[i], clock, shown);
    return [
      {...up, ...edge}, {...down, ...edge}, {...innovation, ...lines, line: stroke(ink(), 0.9), name: 'innovation'}
    ];
  };
  return {title: `innovation<br>${axisTitle(runs.states[i])}`, height: 150, draw};
}

async function nisTrace(layer, filter, {clock, shown}) {
  const curve = await line(filter.nis, clock, shown), dots = curve.per === 1 && curve.y.length < few_nis;
  const color = layer.nis || ink();
  return {
    ...curve,
    type: 'scatter',
    mode: dots ? 'markers' : 'lines',
    name: `${layer.prefix}NIS`,
    marker: {size: 3.5, color, symbol: layer.symbol || 'circle', opacity: 0.7},
    line: {...stroke(color, 0.8), ...layer.stroke},
  };
}

export function nisRow(runs, layers) {
  const bound = (height) => dashedLine(height, {line: {color: lineColour(palette.outlier), width: 1.2, dash: 'dash'}});
  const draw = (view) => {
    const told = layers.map((layer) => [layer, layer.of(view.run)]).filter(([, filter]) => filter);
    return Promise.all(told.map(([layer, filter]) => nisTrace(layer, filter, view)));
  };
  const axis = {type: 'log', exponentformat: 'power', dtick: 2, range: [-4, 2.5]};
  return {title: 'NIS', height: 150, axis, shapes: () => runs.nis_bounds.map(bound), draw};
}
