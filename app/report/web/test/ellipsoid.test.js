import assert from 'node:assert/strict';
import {test} from 'node:test';

import {ellipsePath, factor, part} from '../src/ellipsoid.js';

// (x - mean)' C^-1 (x - mean) by Cramer's rule for two, and for three of a matrix whose inverse is written down.
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

test('an ellipse is a closed path around its mean', () => {
  const path = ellipsePath([1, -2], part(covariance, [0, 1]), 5.99);
  const points = path.slice(1, -1).split('L').map((text) => text.split(',').map(Number));
  assert.ok(path.startsWith('M') && path.endsWith('Z'));
  for (const [x, y] of points) close(distance([x - 1, y + 2, 0]), 5.99);
  assert.equal(ellipsePath([0, 0], [[0, 0], [0, 1]], 1), null);
});
