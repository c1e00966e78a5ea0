// Order of cells: numbers by value, words in natural order. Unknown values are last in both directions.
import {naturally} from './run_names.js';

// The value of a cell. A cell is a word, a number, or a formatted number from C++: {v: exact value, t: text}.
export const plainValue = (cell) => (cell && typeof cell === 'object' ? cell.v : cell);

const isKnown = (v) => v !== null && v !== undefined && v !== '';

// Compares two known values. The result is negative if x comes first.
function compareKnown(x, y) {
  const p = Number(x), q = Number(y);
  if (Number.isNaN(p) || Number.isNaN(q)) return naturally(x, y);
  return p - q;
}

export function compareCells(a, b, down = false) {
  const x = plainValue(a), y = plainValue(b);
  if (!isKnown(x) || !isKnown(y)) return Number(isKnown(y)) - Number(isKnown(x));
  return down ? compareKnown(y, x) : compareKnown(x, y);
}

// A copy of `rows` sorted by the cells that `of(row)` returns. Rows with equal cells keep their order.
export function sortedRows(rows, of, down) {
  return [...rows].sort((a, b) => compareCells(of(a), of(b), down));
}
