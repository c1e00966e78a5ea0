import assert from 'node:assert/strict';
import {test} from 'node:test';

import {lossOf, paretoFront, usualRange} from '../src/statistics.js';

test('the usual range leaves the outermost hundredth of either side out', () => {
  const values = Float32Array.from({length: 101}, (_, i) => i);  // percentiles 1 and 99 have the values 1 and 99
  values[100] = 1e9;
  const [low, high] = usualRange(values);
  assert.ok(Math.abs(low - (1 - 0.12 * 98)) < 1e-9);
  assert.ok(Math.abs(high - (99 + 0.12 * 98)) < 1e-9);
});

test('values that sort differently as text, unknown ones and several lists', () => {
  assert.deepEqual(usualRange([9, 10, NaN], Float64Array.of(100, Infinity)), [9 - 0.12 * 91, 100 + 0.12 * 91]);
  assert.deepEqual(usualRange([NaN]), [-1, 1]);
  const [low, high] = usualRange([3, 3]);
  assert.ok(low < 3 && high > 3);
});

test('losses by goal', () => {
  assert.equal(lossOf(undefined, 2), -2);
  assert.equal(lossOf({kind: 'higher'}, 2), -2);
  assert.equal(lossOf({kind: 'lower'}, 2), 2);
  assert.equal(lossOf({kind: 'nominal', nominal: 0.025}, 0.02), 0.025 - 0.02);
});

test('the Pareto front holds what no other point beats in both', () => {
  const points = [[1, 5], [2, 5], [2, 3], [3, 4], [4, 1], [4, 1], [5, 1]].map(([x, loss]) => ({x, loss}));
  // The definition, for each point: no other point is at least as good in both numbers and better in one.
  const beaten = (p) => points.some((q) => q.x <= p.x && q.loss <= p.loss && (q.x < p.x || q.loss < p.loss));
  const best = new Set(points.filter((p) => !beaten(p)).map(({x, loss}) => `${x} ${loss}`));
  assert.deepEqual(paretoFront(points).map(({x, loss}) => `${x} ${loss}`), [...best]);
  assert.deepEqual(paretoFront([]), []);
});
