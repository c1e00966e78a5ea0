// The transition graph of a bank: modes on a circle, arrows by probability.
import { s } from './svg.js';
import { modeColour } from './plots.js';

const least = 0.005;  // rarer transitions are left to the matrix

function arrow(from, to, width, colour, title) {
  const dx = to.x - from.x, dy = to.y - from.y, length = Math.hypot(dx, dy), ux = dx / length, uy = dy / length;
  const bend = 0.14 * length, start = { x: from.x + ux * from.r, y: from.y + uy * from.r }, end = { x: to.x - ux * (to.r + 7), y: to.y - uy * (to.r + 7) };
  const middle = { x: (from.x + to.x) / 2 - uy * bend, y: (from.y + to.y) / 2 + ux * bend };
  const tx = end.x - middle.x, ty = end.y - middle.y, size = Math.hypot(tx, ty), ax = tx / size, ay = ty / size, head = 4 + width;
  const tip = { x: end.x + ax * 6, y: end.y + ay * 6 };
  const element = s('g', {}, s('title', {}, title),
    s('path', { d: `M${start.x},${start.y}Q${middle.x},${middle.y} ${end.x},${end.y}`, fill: 'none', stroke: colour, 'stroke-width': width, 'stroke-opacity': 0.75 }),
    s('path', { d: `M${tip.x},${tip.y}L${end.x - ay * head * 0.6},${end.y + ax * head * 0.6}L${end.x + ay * head * 0.6},${end.y - ax * head * 0.6}Z`, fill: colour }));
  return { element, at: { x: (start.x + 2 * middle.x + end.x) / 4, y: (start.y + 2 * middle.y + end.y) / 4 } };
}

// `transition[i][j]`: C++'s number cells; `weights`: sizes of the nodes.
export function transitionGraph(transition, weights) {
  const K = transition.length, size = 420, centre = size / 2, ring = K === 1 ? 0 : size / 2 - 52;
  const nodes = transition.map((_, k) => ({ x: centre + ring * Math.sin((2 * Math.PI * k) / K), y: centre - ring * Math.cos((2 * Math.PI * k) / K), r: Math.min(15 + 16 * Math.sqrt(weights[k] || 0), K > 12 ? 20 : 30) }));
  const picture = s('svg', { viewBox: `0 0 ${size} ${size}`, role: 'img', 'aria-label': `Transitions between ${K} modes; the matrix beside holds the same numbers`, class: 'graph' });
  const labels = [];
  for (let i = 0; i < K; ++i)
    for (let j = 0; j < K; ++j) {
      const cell = transition[i][j];
      if (i === j || !(cell.v >= least)) continue;
      const edge = arrow(nodes[i], nodes[j], 1 + 7 * Math.sqrt(cell.v), modeColour(i), `from mode ${i} to mode ${j}: ${cell.t}`);
      picture.append(edge.element);
      if (K <= 6) labels.push(s('text', { x: edge.at.x, y: edge.at.y, class: 'edge' }, cell.v.toPrecision(2)));
    }
  nodes.forEach((node, k) => picture.append(s('g', {}, s('title', {}, `mode ${k} stays with probability ${transition[k][k].t}`),
    s('circle', { cx: node.x, cy: node.y, r: node.r, fill: modeColour(k), stroke: 'var(--ink)' }),
    s('text', { x: node.x, y: node.y, class: 'node' }, String(k)))));
  picture.append(...labels);
  return picture;
}
