import assert from 'node:assert/strict';
import {test} from 'node:test';

import {differingWords, matchedRanks, sortedPairs} from '../src/mode_pairs.js';

const pair = (first, second, distance, agree, z = []) =>
    ({first, second, agree, distance: {v: distance}, z: z.map((v) => ({v, t: v.toFixed(1)}))});
const modes = [
  pair(0, 1, 0.4, true, [0.4, 0.4]), pair(1, 0, 6, false, [8, -2.5]), pair(2, -1, null, false), pair(-1, 3, null, false)
];

test('pairs that differ come first, those of one bank alone last', () => {
  const [differing, agreeing] = sortedPairs({modes});
  assert.deepEqual(differing.map(({first, second}) => [first, second]), [[1, 0], [-1, 3], [2, -1]]);
  assert.deepEqual(agreeing.map(({first}) => first), [0]);
});

test('what a pair differs in', () => {
  assert.equal(differingWords(pair(0, 1, null, false), []), '–');  // the modes belong to different models
  assert.equal(differingWords(modes[1], ['A [1/s]', 'B']), 'differ in A (8.0), B (-2.5)');
  assert.equal(differingWords(modes[0], ['A', 'B']), 'agree within their errors');
  assert.equal(differingWords(modes[2], ['A', 'B']), 'only in A');
  assert.equal(differingWords(modes[3], ['A', 'B']), 'only in B');
});

test('matched modes share the colour of the first bank, others come after it', () => {
  const first = {order: [2, 0, 1, 3], told: 3}, second = {order: [1, 3, 0, 2], told: 4};
  const match = {modes: [pair(0, 1), pair(1, 0), pair(2, -1), pair(3, 3), pair(-1, 2)]};
  // Mode 3 matches a merged mode of A; mode 2 has no match. Both get the next colours, in the order of their use.
  assert.deepEqual(matchedRanks(first, second, match), [[1, 2, 0, Infinity], [2, 1, 4, 3]]);
});
