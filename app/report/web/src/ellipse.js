// Points on ellipses (x - mean)' C^-1 (x - mean) = limit.

// Lower Cholesky factor of a small covariance. Null for a singular covariance, for example of a window whose data do
// not determine the parameters.
export function factor(matrix) {
  const n = matrix.length, L = matrix.map((row) => row.map(() => 0));
  for (let i = 0; i < n; ++i) {
    for (let j = 0; j <= i; ++j) {
      let rest = matrix[i][j];
      for (let k = 0; k < j; ++k) rest -= L[i][k] * L[j][k];
      if (i === j && !(rest > 0)) return null;
      L[i][j] = i === j ? Math.sqrt(rest) : rest / L[j][j];
    }
  }
  return L;
}

export const part = (matrix, axes) => axes.map((i) => axes.map((j) => matrix[i][j]));

// Maps a point of the unit circle to the ellipse.
function image(center, L, scale, unit) {
  return center.map((c, i) => c + scale * L[i].reduce((sum, l, j) => sum + l * unit[j], 0));
}

const turnOf = (i, steps) => (2 * Math.PI * i) / steps;
const circle = (steps) =>
    Array.from({length: steps + 1}, (_, i) => [Math.cos(turnOf(i, steps)), Math.sin(turnOf(i, steps))]);

// An ellipse as a closed line; null for a singular covariance.
export function ellipseLine(mean, matrix, limit) {
  const L = factor(matrix);
  if (!L) return null;
  const points = circle(48).map((unit) => image(mean, L, Math.sqrt(limit), unit));
  return {x: points.map(([x]) => x), y: points.map(([, y]) => y)};
}
