import assert from 'node:assert/strict';
import {test} from 'node:test';

import {hueOf, isOther, modeCell, modeTitle, nameModes, rankOf} from '../src/mode_names.js';

test('a mode without a name is its number', () => {
  assert.deepEqual([modeCell(0), modeTitle(3)], ['0', 'mode 3']);
  nameModes(['', 'ice']);
  assert.deepEqual([0, 1, 2].map(modeCell), ['0', '1 ice', '2']);
  assert.deepEqual([0, 1, 2].map(modeTitle), ['mode 0', 'mode 1: ice', 'mode 2']);
  nameModes([]);
});

test('modes rank by use where it is known', () => {
  nameModes(['', '', ''], [2, 0, 1], 2);
  assert.deepEqual([0, 1, 2].map(rankOf), [1, 2, 0]);
  assert.deepEqual([0, 1, 2].map(isOther), [false, true, false]);
  nameModes([]);
  assert.equal(rankOf(2), 2);
  assert.equal(isOther(2), false);
});

test('modes of one motion share a hue, the most used motion has the first', () => {
  const motions = [{modes: [1]}, {modes: [2, 0]}, {modes: [4]}, {modes: [3]}];
  nameModes(['ice', 'grip', 'ice', '', ''], [1, 2, 0, 4, 3], 5, motions);
  assert.deepEqual([1, 2, 0, 4, 3].map((k) => hueOf(k).hue), [0, 1, 1, 2, 3]);
  assert.deepEqual([1, 2, 0, 4, 3].map((k) => hueOf(k).turn), [0, 0, 1, 0, 0]);
  nameModes([]);
  assert.deepEqual(hueOf(3), {hue: 3, turn: 0});
});
