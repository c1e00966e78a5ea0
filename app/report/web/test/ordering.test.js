import assert from 'node:assert/strict';
import {test} from 'node:test';

import {compareCells, sortedRows} from '../src/ordering.js';

const number = (v) => ({v, t: v === null ? '–' : `${v}`});
const sorted = (cells, down) => sortedRows(cells, (cell) => cell, down);

test('numbers sort by their exact value, not by their text', () => {
  const cells = [{v: 1.26, t: '1.3'}, {v: 10, t: '10'}, {v: 1.34, t: '1.3'}, {v: -2, t: '−2'}];
  assert.deepEqual(sorted(cells, false).map(({v}) => v), [-2, 1.26, 1.34, 10]);
  assert.deepEqual(sorted(cells, true).map(({v}) => v), [10, 1.34, 1.26, -2]);
});

test('unknown values come last in both directions', () => {
  for (const nothing of [null, undefined, '', number(null)]) {
    const cells = [nothing, number(3), number(-1)];
    assert.deepEqual(sorted(cells, false), [number(-1), number(3), nothing]);
    assert.deepEqual(sorted(cells, true), [number(3), number(-1), nothing]);
  }
  assert.equal(compareCells(null, number(null)), 0);
});

test('words sort as people order them: numbers inside them by value', () => {
  assert.deepEqual(sorted(['run 10', 'run 9', 'Run 1'], false), ['Run 1', 'run 9', 'run 10']);
});

test('equal cells keep the order of their rows', () => {
  const rows = [['a', 1], ['b', 0], ['c', 1], ['d', 0]];
  assert.deepEqual(sortedRows(rows, (row) => row[1], false).map(([name]) => name), ['b', 'd', 'a', 'c']);
  assert.deepEqual(sortedRows(rows, (row) => row[1], true).map(([name]) => name), ['a', 'c', 'b', 'd']);
  assert.deepEqual(rows.map(([name]) => name), ['a', 'b', 'c', 'd']);
});
