import assert from 'node:assert/strict';
import {test} from 'node:test';

import {csvOf, fileName} from '../src/downloads.js';
import {rangeText, secondsText, shortNumber} from '../src/number_text.js';
import {beside, changes, greatest} from '../src/time_jumps.js';
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

test('the worst of each stretch, the worst first', () => {
  const values = new Float32Array(10000).fill(NaN);
  Object.assign(values, {7: 3, 9: 4, 5000: 9, 9999: 5});
  assert.deepEqual(greatest(values, 2), [{at: 5000, value: 9}, {at: 9999, value: 5}]);
  assert.deepEqual(greatest(values).map(({at}) => at), [5000, 9999, 9]);  // samples 7 and 9 are in the same part
});

test('a change of the likeliest mode is where another becomes the greatest', () => {
  assert.deepEqual(changes([[0.9, 0.4, NaN, 0.2, 0.8], [0.1, 0.6, NaN, 0.8, 0.2]]), [1, 4]);
  assert.deepEqual([beside([1, 2, 3], 2, 1), beside([1, 2, 3], 2, -1), beside([1], 1, 1)], [3, 1, null]);
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
  await state.jump(15.02);
  assert.ok(Math.abs(state.at - 15) < 1e-9 && Math.abs(state.range[0] - 14.52) < 1e-9);
});

test('keys lead the crosshair and let the view begin and end there', async () => {
  const run = {role: 'test', time: {samples: 1001, start: 0, end: 10, period: 0.01}}, state = new TimeState([run]);
  const plot = {addEventListener: (_, listen) => Object.assign(plot, {listen})}, told = [];
  listenToKeys(plot, state, [{key: 'w', act: () => told.push('worst')}]);
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
  await press('w');
  assert.deepEqual(told.slice(-2), ['w', 'worst']);
});

test('a table as CSV quotes what would be read otherwise', () => {
  assert.equal(csvOf([['a', 'b,c'], ['say "x"', '1']]), 'a,"b,c"\n"say ""x""",1\n');
  assert.equal(fileName('One run over time: données', 'svg'), 'one_run_over_time_donnees.svg');
});
