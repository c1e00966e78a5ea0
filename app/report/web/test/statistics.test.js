import assert from 'node:assert/strict';
import {test} from 'node:test';

import {lossOf, usualRange} from '../src/statistics.js';

test('the usual range leaves the outermost hundredth of either side out', () => {
  const values = Float32Array.from({length: 101}, (_, i) => i);  // percentiles 1 and 99 have the values 1 and 99
  values[100] = 1e9;
  const [low, high] = usualRange(values);
  assert.ok(Math.abs(low - (1 - 0.12 * 98)) < 1e-9);
  assert.ok(Math.abs(high - (99 + 0.12 * 98)) < 1e-9);
});

test('values that sort differently as text, and unknown ones', () => {
  assert.deepEqual(usualRange(Float64Array.of(9, 10, NaN, 100, Infinity)), [9 - 0.12 * 91, 100 + 0.12 * 91]);
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
