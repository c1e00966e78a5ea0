// How cells sort: numbers by value, words as people order them, what is not known last in either direction.
import {naturally} from './run_names.js';

// A cell is a word, a number or what C++ formatted: {v: exact value, t: text}.
export const plainValue = (cell) => (cell && typeof cell === 'object' ? cell.v : cell);

const isKnown = (v) => v !== null && v !== undefined && v !== '';

// Of two known values: negative where x comes first.
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

// A copy of `rows` by the cell that `of` takes from each; equal ones keep their order.
export function sortedRows(rows, of, down) {
  return [...rows].sort((a, b) => compareCells(of(a), of(b), down));
}
