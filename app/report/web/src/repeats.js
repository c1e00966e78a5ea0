// Shows repeats as one row of a table. Repeats are runs that differ only in their seed.
import {isNumber, mean} from './statistics.js';

const rounding = 1e-5;  // relative to the mean; the table does not show a smaller difference

const known = (cell) => Boolean(cell) && typeof cell === 'object' && isNumber(cell.v);

// Mean ± standard deviation of the cells of a score, as a formatted number {t, v}.
function meanCell(cells) {
  const values = cells.filter(known).map(({v}) => v);
  if (!values.length) return cells[0];
  const middle = mean(values);
  if (values.length === 1) return {t: cells.find(known).t, v: middle};
  const sd = Math.sqrt(values.reduce((sum, v) => sum + (v - middle) ** 2, 0) / (values.length - 1));
  if (sd < rounding * Math.abs(middle)) return {t: cells.find(known).t, v: middle};
  return {t: `${Number(middle.toPrecision(4))} ± ${Number(sd.toPrecision(2))}`, v: middle};
}

// "done" if all runs are done, else for example "2 done, 1 failed".
function wordsOf(cells) {
  const counts = new Map();
  for (const cell of cells) counts.set(cell, (counts.get(cell) || 0) + 1);
  if (counts.size === 1) return cells[0];
  return [...counts].map(([word, count]) => `${count} ${word}`).join(', ');
}

function cellOf(column, cells) {
  if (column.kind === 'varied') return cells[0];
  if (column.name === 'repeat') return `${cells.length} run${cells.length > 1 ? 's' : ''}`;
  if (column.name === 'seed') return cells.join(', ');
  return column.kind === 'about' ? wordsOf(cells) : meanCell(cells);
}

// One row per setting, in the order of the settings' first runs. A click on the row selects the first run. `members`:
// the runs of the setting.
export function groupedRows(columns, rows) {
  const groups = new Map();
  for (const row of rows) {
    const key = JSON.stringify(row.varied);
    if (!groups.has(key)) groups.set(key, []);
    groups.get(key).push(row);
  }
  return [...groups.values()].map(
      (members) => ({
        ...members[0],
        members,
        cells: columns.map((column, i) => cellOf(column, members.map((row) => row.cells[i])))
      }));
}
