// The figure of a WindowCloud: its chosen parameters two at a time.
import {ellipsePath} from './ellipsoid.js';
import {modeTitle} from './mode_names.js';
import {axisTitle, componentColour, figure, ink, modeColour, palette, plain} from './plots.js';
import {usualRange} from './statistics.js';

const many = 20000;      // windows that are drawn smaller and fainter
const many_flat = 3000;  // windows that are drawn by WebGL

// A bank that was not refined has the components for its modes.
const colourIn = (cloud, k) => (cloud.by === 'mode' || !cloud.windows.refined ? modeColour(k) : componentColour(k));
export const groupColour = (cloud, key) => (key < 0 ? palette.unclustered : colourIn(cloud, key));

const rangeOf = (cloud, a) => (cloud.showAll ? undefined : usualRange(cloud.values[a]));
const within = (cloud, axes) => (cloud.covariance ? cloud.parametersOnly(axes) : false);

function windowPoints(cloud, axes, type) {
  const crowded = cloud.count > many;
  return cloud.shownGroups(axes).map(({key, list}) => {
    const marker = {size: crowded ? 2.5 : 4, color: groupColour(cloud, key), line: {width: 0}};
    marker.opacity = key < 0 ? 0.3 : crowded ? 0.35 : 0.65;
    const trace =
        {type, mode: 'markers', name: plain(cloud.groupName(key)), customdata: list, hoverinfo: 'none', marker};
    axes.forEach((a, j) => {
      trace['xy'[j]] = Float32Array.from(list, (i) => cloud.values[a][i]);
    });
    return trace;
  });
}

function bankPoints(cloud, axes, type) {
  const {bank} = cloud.windows;
  if (!bank || !cloud.showBank || !cloud.parametersOnly(axes)) return [];
  const trace = {
    type,
    mode: 'markers',
    customdata: bank.map(() => -1),
    hovertext: bank.map((_, k) => `${plain(modeTitle(k))} of the bank`),
    hoverinfo: 'text',
    marker: {
      symbol: 'diamond',
      size: 11,
      color: bank.map((_, k) => modeColour(k)),
      line: {width: 1.5, color: ink()},
    },
  };
  axes.forEach((a, j) => {
    trace['xy'[j]] = bank.map((group) => group.mean[a]);
  });
  return [trace];
}

// Pairs of the chosen axes.
function pairsOf(axes) {
  if (axes.length < 2) return [[0, 0]];
  if (axes.length < 3) return [axes];
  return [[0, 1], [0, 2], [1, 2]].map(([a, b]) => [axes[a], axes[b]]);
}

// Ellipses of the groups and of the picked window, on the axes numbered n.
function ellipseShapes(cloud, pair, n) {
  const {limit2} = cloud.windows;
  const shape = (path, line) => ({type: 'path', path, xref: `x${n}`, yref: `y${n}`, line, layer: 'above'});
  const list = cloud.ellipses(pair).map(
      ({k, mean, covariance}) => shape(ellipsePath(mean, covariance, limit2), {color: colourIn(cloud, k), width: 2}));
  if (cloud.picked >= 0 && within(cloud, pair)) {
    const path = ellipsePath(cloud.point(cloud.picked, pair), cloud.errorMatrix(cloud.picked, pair), limit2);
    list.push(shape(path, {color: ink(), width: 2, dash: 'dot'}));
  }
  return list.filter(({path}) => path);
}

// Axes of panel s of `count`, beside each other or, on a narrow window, above each other.
function panelAxes(cloud, [a, b], s, count, stacked) {
  const n = s === 0 ? '' : s + 1, share = 1 / count, gap = stacked ? 0.06 : 0.05;
  const span = [s * share + (s ? gap : 0), (s + 1) * share - (s < count - 1 ? gap / 3 : 0)];
  const axis = (which, title) => ({title, range: rangeOf(cloud, which), nticks: 6, zeroline: false});
  const name = (which) => axisTitle(cloud.windows.axes[which]);
  return {
    [`xaxis${n}`]: {...axis(a, {text: name(a)}), anchor: `y${n}`, domain: stacked ? [0, 1] : span},
    [`yaxis${n}`]: {
      ...axis(b, {text: name(b), standoff: 4}),
      anchor: `x${n}`,
      domain: stacked ? [1 - span[1], 1 - span[0]] : [0, 1],
    },
  };
}

function flatPlot(cloud) {
  const pairs = pairsOf(cloud.axes), stacked = window.innerWidth < 700;
  const type = cloud.count > many_flat ? 'scattergl' : 'scatter';
  const traces = [];
  const layout = {
    height: stacked ? 330 * pairs.length : 380,
    margin: {l: 66, r: 12, t: 32, b: 48},
    showlegend: false,
    shapes: [],
  };
  pairs.forEach((pair, s) => {
    const n = s === 0 ? '' : s + 1;
    Object.assign(layout, panelAxes(cloud, pair, s, pairs.length, stacked));
    for (const trace of [...windowPoints(cloud, pair, type), ...bankPoints(cloud, pair, type)]) {
      traces.push({...trace, xaxis: `x${n}`, yaxis: `y${n}`});
    }
    layout.shapes.push(...ellipseShapes(cloud, pair, n));
  });
  return {traces, layout};
}

export function flatFigure(cloud) {
  if (cloud.windows.axes.length < 2) return null;
  return figure(
      'The local models in two parameters at a time, with the ellipses of the mixture components',
      () => flatPlot(cloud),
      `Ellipses hold ${100 * cloud.windows.level} % of a mixture component, or of the spread of a mode’s windows.`);
}
