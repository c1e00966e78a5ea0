import assert from 'node:assert/strict';
import {test} from 'node:test';

import {csvOf, fileName} from '../src/downloads.js';
import {rangeText, secondsText, shortNumber} from '../src/number_text.js';
import {TimeState} from '../src/time_state.js';

test('numbers are short, with a true minus sign and a unit', () => {
  assert.deepEqual([1 / 3, -0.5, 1e-9, NaN].map((v) => shortNumber(v)), ['0.333333', '−0.5', '1e−9', '–']);
  assert.equal(secondsText(12345.67891), '12345.6789 s');
  assert.equal(rangeText({low: -1, high: 2}, 'm/s'), '−1 … 2 m/s');
  assert.equal(rangeText({low: 2, high: 2}), '2');
});

test('a view stays inside its run and never gets narrower than a few samples', async () => {
  const run = {role: 'test', time: {samples: 101, start: 10, end: 20, period: 0.1}}, state = new TimeState([run]);
  await state.zoom([8, 12]);
  assert.deepEqual(state.range, [10, 14]);
  await state.zoom([12, 12]);
  assert.ok(Math.abs(state.range[1] - state.range[0] - 40 / 101) < 1e-9);
  await state.scale(1000);
  assert.equal(state.range, null);
  await state.zoom([12, 14]);
  await state.scale(0.5, 12);
  assert.deepEqual(state.range, [12, 13]);
  await state.point(12.34);
  assert.ok(Math.abs(state.at - 12.3) < 1e-9);
});

test('a table as CSV quotes what would be read otherwise', () => {
  assert.equal(csvOf([['a', 'b,c'], ['say "x"', '1']]), 'a,"b,c"\n"say ""x""",1\n');
  assert.equal(fileName('One run over time: données'), 'one_run_over_time_donnees.csv');
});
