// Ellipses and ellipsoids (x - mean)' C^-1 (x - mean) <= limit as points, paths and meshes.

// Lower Cholesky factor of a small covariance; null when it is not one (a window that data do not determine).
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

// Where a point of the unit sphere goes.
function image(center, L, scale, unit) {
  return center.map((c, i) => c + scale * L[i].reduce((sum, l, j) => sum + l * unit[j], 0));
}

const turnOf = (i, steps) => (2 * Math.PI * i) / steps;
const circle = (steps) =>
    Array.from({length: steps + 1}, (_, i) => [Math.cos(turnOf(i, steps)), Math.sin(turnOf(i, steps))]);

// An ellipse as an SVG path; null where there is none.
export function ellipsePath(mean, matrix, limit) {
  const L = factor(matrix);
  if (!L) return null;
  const points = circle(48).map((unit) => image(mean, L, Math.sqrt(limit), unit).join(','));
  return `M${points.join('L')}Z`;
}

// Appends three great circles of an ellipsoid to the lists of coordinates `to`, each followed by a gap.
export function appendWires(to, center, matrix, limit) {
  const L = factor(matrix);
  if (!L) return;
  for (const [a, b] of [[0, 1], [0, 2], [1, 2]]) {
    for (const [c, s] of circle(28)) {
      const unit = [0, 0, 0];
      unit[a] = c;
      unit[b] = s;
      image(center, L, Math.sqrt(limit), unit).forEach((v, i) => to[i].push(v));
    }
    to.forEach((list) => list.push(null));
  }
}

// An ellipsoid's surface as triangles: corners x, y, z and the corners i, j, k of each; null where there is none.
export function surface(center, matrix, limit) {
  const L = factor(matrix);
  if (!L) return null;
  const rings = 10, sides = 18;
  const mesh = {x: [], y: [], z: [], i: [], j: [], k: []};
  for (let r = 0; r <= rings; ++r) {
    for (let s = 0; s < sides; ++s) {
      const polar = (Math.PI * r) / rings, turn = turnOf(s, sides);
      const unit = [Math.sin(polar) * Math.cos(turn), Math.sin(polar) * Math.sin(turn), Math.cos(polar)];
      image(center, L, Math.sqrt(limit), unit).forEach((v, axis) => mesh['xyz'[axis]].push(v));
      if (r === rings) continue;
      const a = r * sides + s, b = r * sides + ((s + 1) % sides);
      mesh.i.push(a, b);
      mesh.j.push(b, b + sides);
      mesh.k.push(a + sides, a + sides);
    }
  }
  return mesh;
}
