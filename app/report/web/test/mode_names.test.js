import assert from 'node:assert/strict';
import {test} from 'node:test';

import {isOther, modeCell, modeTitle, nameModes, rankOf} from '../src/mode_names.js';

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
