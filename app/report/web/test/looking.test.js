import assert from 'node:assert/strict';
import {test} from 'node:test';

import {csvOf, fileName} from '../src/downloads.js';
import {rangeText, secondsText, shortNumber} from '../src/number_text.js';
import {listenToKeys} from '../src/time_keys.js';
import {TimeState} from '../src/time_state.js';
import {linkOf, viewIn} from '../src/view_link.js';

test('numbers are short, with a true minus sign and a unit', () => {
  assert.deepEqual([1 / 3, -0.5, 1e-9, NaN].map((v) => shortNumber(v)), ['0.333333', '−0.5', '1e−9', '–']);
  assert.equal(secondsText(12345.67891), '12345.6789 s');
  assert.equal(rangeText({low: -1, high: 2}, 'm/s'), '−1 … 2 m/s');
  assert.equal(rangeText({low: 2, high: 2}), '2');
});

test('a link says what is shown and is read as it was written, whatever runs are called', () => {
  const view = {run: 'a&b=#é 漢', filter: 'bank', range: [1.25, 3.5], at: 2.125};
  assert.deepEqual(viewIn(linkOf(view)), view);
  assert.deepEqual(viewIn(linkOf({run: '1', range: null, at: null})), {run: '1', range: null, at: null});
  assert.equal(viewIn('#data'), null);
  assert.deepEqual(viewIn('#view?from=5&to=x&at='), {range: null, at: null});
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

test('keys lead the crosshair and let the view begin and end there', async () => {
  const run = {role: 'test', time: {samples: 1001, start: 0, end: 10, period: 0.01}}, state = new TimeState([run]);
  const plot = {addEventListener: (_, listen) => Object.assign(plot, {listen})}, told = [];
  listenToKeys(plot, state);
  const press = async (key, shiftKey = false) => {
    plot.listen({target: plot, key, shiftKey, preventDefault: () => told.push(key)});
    await new Promise(setImmediate);
  };
  await press('ArrowLeft');
  assert.ok(Math.abs(state.at - 4.98) < 1e-9);  // one step is a five-hundredth of the view
  await press('[');
  assert.deepEqual(state.range, [state.at, 10]);
  await press('ArrowRight', true);
  await press(']');
  assert.ok(Math.abs(state.range[0] - 4.98) < 1e-9 && Math.abs(state.range[1] - state.at) < 1e-9 && state.at > 5);
  const [from, to] = state.range;
  await press('PageDown');
  assert.ok(Math.abs(state.range[0] - (from + to) / 2) < 1e-9);
  await press('0');
  await press('Escape');
  assert.deepEqual([state.range, state.at], [null, null]);
  await press('x');
  assert.equal(told.at(-1), 'Escape');
});

test('a table as CSV quotes what would be read otherwise', () => {
  assert.equal(csvOf([['a', 'b,c'], ['say "x"', '1']]), 'a,"b,c"\n"say ""x""",1\n');
  assert.equal(fileName('One run over time: données', 'svg'), 'one_run_over_time_donnees.svg');
});
