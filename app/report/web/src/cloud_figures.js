// The figure of a WindowCloud. It has one panel for each pair of chosen parameters.
import {figure} from './chart.js';
import {ellipseLine} from './ellipse.js';
import {componentColour, modeColour, palette} from './look.js';
import {usualRange} from './statistics.js';
import {titleOf} from './time_rows.js';

const many = 20000;  // from this number of windows on, points are small and faint

// The modes of an unrefined bank are the components, so the colours are the same.
const colourIn = (cloud, k) => (cloud.by === 'mode' || !cloud.windows.refined ? modeColour(k) : componentColour(k));
export const groupColour = (cloud, key) => (key < 0 ? palette.unclustered : colourIn(cloud, key));

const rangeOf = (cloud, a) => (cloud.showAll ? null : usualRange(cloud.values[a]));

function windowPoints(cloud, [a, b]) {
  const crowded = cloud.count > many;
  return cloud.shownGroups([a, b]).map(({key, list}) => {
    const at = (axis) => Float32Array.from(list, (i) => cloud.values[axis][i]);
    return {
      kind: 'points',
      name: cloud.groupName(key),
      x: at(a),
      y: at(b),
      colour: groupColour(cloud, key),
      size: crowded ? 2.5 : 4,
      opacity: key < 0 ? 0.3 :
          crowded      ? 0.4 :
                         0.65,
    };
  });
}

function bankPoints(cloud, [a, b]) {
  const {bank} = cloud.windows;
  if (!bank || !cloud.showBank || !cloud.parametersOnly([a, b])) return [];
  return bank.map(({mean}, k) => ({
                    kind: 'points',
                    x: [mean[a]],
                    y: [mean[b]],
                    colour: modeColour(k),
                    symbol: 'diamond',
                    size: 11,
                    edge: true,
                  }));
}

// All pairs of the chosen axes.
function pairsOf(axes) {
  if (axes.length < 3) return [axes];
  return [[0, 1], [0, 2], [1, 2]].map(([a, b]) => [axes[a], axes[b]]);
}

// Ellipses of the groups.
function ellipses(cloud, pair) {
  const {limit2} = cloud.windows;
  const outline = (mean, covariance, look) => {
    const closed = ellipseLine(mean, covariance, limit2);
    return closed ? [{kind: 'line', ...closed, width: 2, ...look}] : [];
  };
  return cloud.ellipses(pair).flatMap(
      ({k, mean, covariance}) => outline(mean, covariance, {colour: colourIn(cloud, k)}));
}

function panelOf(cloud, pair) {
  const axis = (a) => ({title: titleOf(cloud.windows.axes[a]), range: rangeOf(cloud, a)});
  return {
    x: axis(pair[0]),
    y: axis(pair[1]),
    marks: [...windowPoints(cloud, pair), ...ellipses(cloud, pair), ...bankPoints(cloud, pair)],
  };
}

/** Null with fewer than two dimensions. */
export function cloudFigure(cloud) {
  if (cloud.windows.axes.length < 2) return null;
  return figure(
      'The local models in two parameters at a time, with the ellipses of the mixture components',
      () => ({panels: pairsOf(cloud.axes).map((pair) => panelOf(cloud, pair)), height: 290, wide: 300}),
      `Ellipses hold ${100 * cloud.windows.level} % of a mixture component, or of the windows of a mode. ` +
          'Diamonds are the modes of the bank. The tables of modes have the numbers.');
}
