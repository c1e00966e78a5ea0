import assert from 'node:assert/strict';
import {test} from 'node:test';

import {extent, margins, timeScale, valueScale} from '../src/time_axes.js';
import {bucketBoxes, drawPanel, linePath} from '../src/time_drawing.js';

// A pen that only records its calls.
function notes() {
  const list = [];
  const pathOf = (path) => {
    const points = [], put = (word) => (...at) => points.push([word, ...at]);
    path({moveTo: put('M'), lineTo: put('L'), closePath: put('Z'), arc: put('A'), rect: put('R')});
    return points;
  };
  const pen = {
    line: (path, look) => list.push({kind: 'line', points: pathOf(path), ...look}),
    area: (path, colour) => list.push({kind: 'area', points: pathOf(path), colour}),
    text: (text, x, y) => list.push({kind: 'text', text, x, y}),
    boxes: (boxes, colour) => list.push({kind: 'boxes', boxes, colour}),
    within: (box, body) => body(),
  };
  return {pen, list};
}
const look = {
  ink: '#000',
  faint: '#eee',
};

test('times and pixels are each other\'s inverse inside the margins', () => {
  const {left, right} = margins(1000), scale = timeScale([10, 20], 1000);
  assert.deepEqual([scale.to(10), scale.to(20)], [left, 1000 - right]);
  for (const t of [10, 13.7, 20]) assert.ok(Math.abs(scale.from(scale.to(t)) - t) < 1e-12);
  assert.ok(scale.ticks.length >= 5 && scale.ticks.every(({at}) => at >= 10 && at <= 20));
});

test('ticks of a logarithmic axis are powers of ten that do not touch', () => {
  const {ticks, to} = valueScale([1e-4, 300], 0, 130, true);
  assert.deepEqual(ticks.map(({text}) => text), ['10⁻⁴', '10⁻²', '10⁰', '10²']);
  assert.ok(Math.abs(to(1e-4) - 130) < 1e-9 && Math.abs(to(300)) < 1e-9);
  assert.equal(to(0), to(1e-4));
});

test('an extent leaves room and survives what is unknown', () => {
  assert.deepEqual(extent([{y: [NaN, 1, null]}, {y: [3]}]), [1 - 0.1, 3 + 0.1]);
  assert.deepEqual(extent([{y: [5]}]), [0, 10]);
  assert.deepEqual(extent([{y: [NaN]}]), [0, 1]);
});

test('a line is broken where a value is unknown; steps go across, then up', () => {
  const same = (v) => v;
  const drawn = (trace) => {
    const points = [], put = (word) => (x, y) => points.push([word, x, y]);
    linePath(trace, same, same)({moveTo: put('M'), lineTo: put('L')});
    return points;
  };
  assert.deepEqual(drawn({x: [0, 1, 2, 3], y: [5, 6, NaN, 7]}), [['M', 0, 5], ['L', 1, 6], ['M', 3, 7]]);
  assert.deepEqual(drawn({x: [0, 1], y: [5, 6], step: true}), [['M', 0, 5], ['L', 1, 5], ['L', 1, 6]]);
});

test('shares are stacked from the floor of a panel to its top', () => {
  const {pen, list} = notes();
  const trace = (y, colour) => ({kind: 'shares', x: [0, 1], y, colour, name: ''});
  const content = {traces: [trace([0.25, 1], '#111'), trace([0.75, 0], '#222')], range: [0, 1], log: false, levels: []};
  drawPanel(pen, {width: 1000, height: 112, last: true, range: [0, 1]}, content, look);
  const [lower, upper] = list.filter(({kind}) => kind === 'area');
  assert.deepEqual([lower.colour, lower.points[0][2], lower.points[1][2]], ['#111', 81, 6]);
  assert.deepEqual([upper.points[0][2], upper.points[1][2]], [6, 6]);
  assert.ok(list.some(({text}) => text === 'time [s]'));
});

test('buckets are boxes beside each other that hold their extremes; a line\'s touch', () => {
  const toX = (v) => 1.4 * v, toY = (v) => 100 - v, x = [0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5];
  const y = [10, 20, 50, 40, NaN, NaN, 5, 7];
  const line = bucketBoxes({kind: 'line', x, y, width: 2}, toX, toY);
  // The first bucket goes from 10 to 20. The second goes from 40 to 50 and is extended to 20, the value before. After a
  // gap, a bucket is not extended.
  assert.deepEqual(line, [0, 79, 1, 12, 1, 49, 1, 32, 4, 92, 1, 4]);
  const band = bucketBoxes({kind: 'area', x, y}, toX, toY);
  assert.deepEqual(band, [0, 80, 1, 10, 1, 50, 1, 10, 4, 93, 1, 2]);
});

test('shares of buckets fill a panel, too', () => {
  const {pen, list} = notes();
  const trace = (y, colour) => ({kind: 'shares', per: 4, x: [0, 0.5], y, colour, name: ''});
  const content = {traces: [trace([0.25, 1], '#111'), trace([0.75, 0], '#222')], range: [0, 1], log: false, levels: []};
  drawPanel(pen, {width: 1000, height: 112, last: true, range: [0, 1]}, content, look);
  const [lower, upper] = list.filter(({kind}) => kind === 'boxes');
  const {left} = margins(1000), half = Math.floor(left + (1000 - 10 - left) / 2);
  assert.deepEqual([...lower.boxes], [left, 81, half - left, 25, half, 6, 1, 100]);
  assert.deepEqual([...upper.boxes], [left, 6, half - left, 75]);  // the second bucket is empty
});
