import assert from 'node:assert/strict';
import {test} from 'node:test';

import {columnTitle} from '../src/score_names.js';
import {bestCell, levelOf, reached, settingsOf} from '../src/settings.js';

// K is 1, 2 or 3, and a filter is good or bad. Few components are best with the bad filter, many with the good filter.
const scores = {
  good: [1.0, 1.4, 1.6],
  bad: [-1.0, -2.0, -5.0]
};
const rows = [];
for (const variant of ['good', 'bad']) {
  [1, 2, 3].forEach((K, i) => {
    for (const repeat of [0, 1]) {
      rows.push({
        number: rows.length,
        repeat,
        varied: [String(K), variant],
        cells: [K, variant, {v: scores[variant][i] + (repeat ? 0.02 : -0.02), t: ''}, String(1000 + repeat), 'done'],
      });
    }
  });
}
const axis = (i, levels) => ({of: (row) => row.cells[i], levels});
const K = axis(0, [1, 2, 3]);
const score = {
  of: (row) => row.cells[2].v
};
const higher = {
  kind: 'higher'
};
const close = (a, b) => assert.ok(Math.abs(a - b) < 1e-12, `${a} is not ${b}`);

test('repeats of a setting are one setting', () => {
  const settings = settingsOf(rows, score);
  assert.equal(settings.length, 6);
  close(settings[2].mean, 1.6);
  close(settings[2].sd, 0.04 / Math.SQRT2);
});

test('the best over the others agrees with the best setting', () => {
  const settings = settingsOf(rows, score);
  const best = K.levels.map((level) => reached(settings.filter((one) => levelOf(K, one) === level), higher));
  best.forEach((value, i) => close(value, scores.good[i]));
  assert.equal(bestCell([best], higher).a, 2);
});

test('lower is better where the goal says so', () => {
  assert.equal(bestCell([[3, null, 2]], {kind: 'lower'}).a, 2);
});

test('columns in words', () => {
  assert.equal(columnTitle('bank_test_log_score'), 'bank, held out: log score [nats/sample]');
  assert.equal(columnTitle('noise_only_train_rmse_wz'), 'noise only, training: RMSE wz');
  assert.equal(columnTitle('window.length'), 'window.length');
});
