// The transition graph of a bank: modes on a circle, and arrows for the transition probabilities.
import {shade} from './colour.js';
import {s} from './elements.js';

const bend = 0.14;    // height of an arrow's arc, relative to the arrow's length
const least = 0.005;  // smallest probability with an arrow; the matrix also shows smaller ones

const minus = (a, b) => ({x: a.x - b.x, y: a.y - b.y});
const along = (a, v, length) => ({x: a.x + length * v.x, y: a.y + length * v.y});
const unit = (v) => ({x: v.x / Math.hypot(v.x, v.y), y: v.y / Math.hypot(v.x, v.y)});
const left = (v) => ({x: v.y, y: -v.x});
const put = ({x, y}) => `${x},${y}`;

// A bent arrow between two nodes {x, y, r}, and the position of its label.
function arrow(from, to, width, colour, title) {
  const way = minus(to, from), straight = unit(way);
  const start = along(from, straight, from.r), end = along(to, straight, -(to.r + 7));
  const middle = along(along(from, way, 0.5), left(straight), -bend * Math.hypot(way.x, way.y));
  const heading = unit(minus(end, middle)), half = 0.6 * (4 + width), side = left(heading);
  const corners = [along(end, heading, 6), along(end, side, half), along(end, side, -half)];
  const element =
      s('g', {}, s('title', {}, title), s('path', {
          d: `M${put(start)}Q${put(middle)} ${put(end)}`,
          fill: 'none',
          stroke: shade(colour),
          'stroke-width': width,
          'stroke-opacity': 0.75,
        }),
        s('path', {d: `M${corners.map(put).join('L')}Z`, fill: shade(colour)}));
  // Labels are near the start of their arrows. In the middle all labels would overlap.
  const t = 0.3, share = [(1 - t) ** 2, 2 * t * (1 - t), t ** 2];
  const on = (axis) => share[0] * start[axis] + share[1] * middle[axis] + share[2] * end[axis];
  return {element, at: {x: on('x'), y: on('y')}};
}

function edgesOf(transition, nodes, places) {
  const labelled = nodes.length <= 6, pictures = [], labels = [];
  transition.forEach((row, i) => row.forEach((cell, j) => {
    if (i === j || !(cell.v >= least)) return;
    const title = `from ${nodes[i].title} to ${nodes[j].title}: ${cell.t}`;
    const edge = arrow(places[i], places[j], 1 + 7 * Math.sqrt(cell.v), nodes[i].colour, title);
    pictures.push(edge.element);
    if (labelled) labels.push(s('text', {x: edge.at.x, y: edge.at.y, class: 'edge'}, cell.v.toPrecision(2)));
  }));
  return {pictures, labels};
}

// `transition[i][j]`: formatted numbers from C++. `nodes`: {title, short, colour, use}. The size of a node increases
// with its use.
export function transitionGraph(transition, nodes) {
  const K = nodes.length, size = 420, centre = size / 2, ring = K === 1 ? 0 : size / 2 - 52;
  const angle = (k) => (2 * Math.PI * k) / K;
  const places = nodes.map(({use}, k) => ({
                             x: centre + ring * Math.sin(angle(k)),
                             y: centre - ring * Math.cos(angle(k)),
                             r: Math.min(15 + 16 * Math.sqrt(use || 0), 30),
                           }));
  const label = 'Transitions between the modes, those of one family together; the matrix holds those of each mode';
  const picture = s('svg', {viewBox: `0 0 ${size} ${size}`, role: 'img', 'aria-label': label, class: 'graph'});
  const {pictures, labels} = edgesOf(transition, nodes, places);
  const circles = places.map(
      ({x, y, r}, k) =>
          s('g', {}, s('title', {}, `${nodes[k].title} stays with probability ${transition[k][k].t}`),
            s('circle', {cx: x, cy: y, r, fill: shade(nodes[k].colour), stroke: 'var(--ink)'}),
            s('text', {x, y, class: 'node'}, nodes[k].short)));
  picture.append(...pictures, ...circles, ...labels);
  return picture;
}
