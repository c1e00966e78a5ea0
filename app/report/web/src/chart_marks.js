// The marks of a chart as SVG shapes. All points of one mark are drawn as one path.
import {path as d3Path} from 'd3-path';

import {shade} from './colour.js';
import {s} from './elements.js';
import {linePath} from './time_drawing.js';

const known = (v) => v !== null && Number.isFinite(v);
const dashes = {
  dash: '7 5',
  dot: '2 4',
};

// Corners of each symbol, for a half width of 1.
const corners = {
  square: [[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]],
  diamond: [[0, -1.2], [1.2, 0], [0, 1.2], [-1.2, 0]],
  star: Array.from(
      {length: 10},
      (_, k) => [0, 1].map((axis) => (k % 2 ? 0.55 : 1.4) * [Math.sin, (a) => -Math.cos(a)][axis](k * Math.PI / 5))),
};

const short = (v) => Math.round(10 * v) / 10;

// If several points are in the same half pixel, only one is drawn.
function eachPlace({x, y}, to, visit) {
  const seen = new Set();
  for (let i = 0; i < x.length; ++i) {
    if (!known(x[i]) || !known(y[i])) continue;
    const px = to.x(x[i]), py = to.y(y[i]), key = Math.round(2 * px) * 65536 + Math.round(2 * py);
    if (seen.has(key)) continue;
    seen.add(key);
    visit(short(px), short(py));
  }
}

function points(mark, to) {
  const {size = 4, symbol = 'circle', opacity, edge} = mark, colour = shade(mark.colour), list = [];
  const shape = corners[symbol], r = size / 2;
  eachPlace(mark, to, (px, py) => {
    if (shape) {
      list.push(`M${shape.map(([a, b]) => `${short(px + r * a)} ${short(py + r * b)}`).join('L')}Z`);
    } else if (edge) {
      list.push(`M${short(px - r)} ${py}a${r} ${r} 0 1 0 ${size} 0a${r} ${r} 0 1 0 ${- size} 0Z`);
    } else {
      list.push(`M${px} ${py}h0`);  // a line of length 0 with a round cap is drawn as a dot
    }
  });
  const dot = !shape && !edge;
  return s('path', {
    d: list.join(''),
    fill: dot ? 'none' : colour,
    stroke: dot ? colour :
        edge    ? 'var(--ink)' :
                  'none',
    'stroke-width': dot ? size : 1.2,
    'stroke-linecap': 'round',
    opacity,
  });
}

function line({x, y, colour, width = 1.6, dash, step}, to) {
  const record = d3Path();
  linePath({x, y, step}, (v) => short(to.x(v)), (v) => short(to.y(v)))(record);
  return s('path', {
    d: record.toString(),
    fill: 'none',
    stroke: shade(colour),
    'stroke-width': width,
    'stroke-dasharray': dashes[dash],
    'stroke-linejoin': 'round',
  });
}

function bars({x, y, width, colour, opacity}, to) {
  const floor = to.y(0), list = [];
  for (let i = 0; i < x.length; ++i) {
    if (!known(y[i])) continue;
    const left = to.x(x[i] - width / 2), right = to.x(x[i] + width / 2);
    list.push(`M${short(left)} ${short(floor)}V${short(to.y(y[i]))}H${short(right)}V${short(floor)}Z`);
  }
  return s('path', {d: list.join(''), fill: shade(colour), opacity});
}

const band = ({low, high}, to, at) =>
    s('rect', {class: 'band', x: at.x, width: at.width, y: to.y(high), height: Math.max(0, to.y(low) - to.y(high))});

function rule({x, y, dash = 'dash'}, to, at) {
  const d = y === undefined ? `M${to.x(x)} ${at.y}V${at.y + at.height}` : `M${at.x} ${to.y(y)}H${at.x + at.width}`;
  return s('path', {d, class: 'rule', 'stroke-dasharray': dashes[dash]});
}

const kinds = {
  points,
  line,
  bars,
  band,
  rule,
};

/** A mark's shapes; `to`: converts values to pixels, `at`: the panel's inside. */
export const markShapes = (mark, to, at) => kinds[mark.kind](mark, to, at);
