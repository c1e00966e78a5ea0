import assert from 'node:assert/strict';
import {test} from 'node:test';

import {filterOf} from '../src/filter_text.js';

const cell = (v, t = String(v)) => ({v, t});
const passing = (text, cells) => cells.filter(filterOf(text));

test('nothing typed lets everything pass', () => {
  assert.deepEqual(passing('  ', [null, cell(1)]), [null, cell(1)]);
});

test('comparisons are of the exact value and let nothing unknown pass', () => {
  const cells = [cell(1.96, '2.0'), cell(2), cell(2.04, '2.0'), cell(null, '–'), null, cell(''), 'word'];
  assert.deepEqual(passing('> 2', cells), [cells[2]]);
  assert.deepEqual(passing('>=2', cells), [cells[1], cells[2]]);
  assert.deepEqual(passing('< 2', cells), [cells[0]]);
  assert.deepEqual(passing('<= 2', cells), [cells[0], cells[1]]);
  assert.deepEqual(passing('= 2', cells), [cells[1]]);
  assert.deepEqual(passing('< -1e-3', [cell(-0.01), cell(0)]), [cell(-0.01)]);
});

test('ranges hold both ends', () => {
  const cells = [cell(2.99), cell(3), cell(4), cell(5), cell(5.01), null, cell(null)];
  assert.deepEqual(passing('3..5', cells), [cells[1], cells[2], cells[3]]);
  assert.deepEqual(passing('-1..0.5', [cell(-1), cell(0.6)]), [cell(-1)]);
});

test('any of several', () => {
  assert.deepEqual(passing('imm | gpb1', ['imm', 'gpb2', 'gpb1', 'gpb']), ['imm', 'gpb1']);
  assert.deepEqual(passing('1|4', [cell(1), cell(14), cell(4, '4.0')]), [cell(1), cell(4, '4.0')]);
});

test('anything else is a part of the text, capital or not', () => {
  assert.deepEqual(passing('IMM', ['imm', 'gpb1', 'simmer', null]), ['imm', 'simmer']);
  assert.deepEqual(passing('> x', ['a > x', 'x']), ['a > x']);
  assert.deepEqual(passing('a..b', ['a..b', 'ab']), ['a..b']);
});
