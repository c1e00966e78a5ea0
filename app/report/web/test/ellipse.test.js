import assert from 'node:assert/strict';
import {test} from 'node:test';

import {ellipseLine, factor, part} from '../src/ellipse.js';

// (x - mean)' C^-1 (x - mean), for two variables by Cramer's rule, and for three by an explicit inverse.
const covariance = [[4, 2, 0], [2, 3, 0], [0, 0, 0.25]];
const inverse = [[3 / 8, -2 / 8, 0], [-2 / 8, 4 / 8, 0], [0, 0, 4]];
const distance = (d) => d.reduce((sum, a, i) => sum + a * d.reduce((row, b, j) => row + inverse[i][j] * b, 0), 0);
const close = (a, b) => assert.ok(Math.abs(a - b) < 1e-9, `${a} is not ${b}`);

test('a factor times its transpose is the matrix', () => {
  const L = factor(covariance);
  covariance.forEach((row, i) => row.forEach((c, j) => close(L[i].reduce((sum, l, k) => sum + l * L[j][k], 0), c)));
  assert.equal(factor([[1, 2], [2, 1]]), null);
  assert.equal(factor([[NaN]]), null);
});

test('an ellipse is a closed line around its mean', () => {
  const {x, y} = ellipseLine([1, -2], part(covariance, [0, 1]), 5.99);
  x.forEach((_, i) => close(distance([x[i] - 1, y[i] + 2, 0]), 5.99));
  close(x[0], x.at(-1));
  close(y[0], y.at(-1));
  assert.equal(ellipseLine([0, 0], [[0, 0], [0, 1]], 1), null);
});
