import assert from 'node:assert/strict';
import {test} from 'node:test';

import {inNaturalOrder, shortName} from '../src/run_names.js';

test('runs stand in the order that people count in', () => {
  const names = ['run_10', 'run_2', 'a', 'run_1'].map((name) => ({name}));
  assert.deepEqual(inNaturalOrder(names).map(({name}) => name), ['a', 'run_1', 'run_2', 'run_10']);
});

test('a long name keeps its end', () => {
  assert.equal(shortName('run_2'), 'run_2');
  assert.equal(shortName('2026-11-27_field_run_12', 8), '…_run_12');
  assert.equal([...shortName('漢'.repeat(50), 10)].length, 10);
});
