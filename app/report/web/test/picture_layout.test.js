import assert from 'node:assert/strict';
import {test} from 'node:test';

import {segments, ticks} from '../src/picture_layout.js';

test('equal neighbours are one segment', () => {
  assert.deepEqual(
      segments([1, 1, 0, 1]), [{from: 0, to: 2, value: 1}, {from: 2, to: 3, value: 0}, {from: 3, to: 4, value: 1}]);
  assert.deepEqual(segments([]), []);
});

test('ticks are round, inside, and about as many as asked for', () => {
  assert.deepEqual(ticks([-1.1, 1.1], 4), [-1, 0, 1]);
  assert.deepEqual(ticks([0.013, 0.05], 4), [0.02, 0.03, 0.04, 0.05]);
  for (const range of [[-3e-7, 5e-7], [1e6, 9e6], [0, 1]]) {
    const list = ticks(range, 4);
    assert.ok(list.length >= 2 && list.length <= 6, String(list));
    assert.ok(list.every((value) => value >= range[0] && value <= range[1]));
  }
});
