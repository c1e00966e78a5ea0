// Downloads of tables as CSV.
import {h} from './elements.js';

/** A file name from the caption of a table. */
export function fileName(label) {
  const words =
      label.normalize('NFKD').replace(/\p{M}/gu, '').toLowerCase().replace(/[^a-z0-9]+/g, '_').replace(/^_+|_+$/g, '');
  return `${words.slice(0, 60) || 'file'}.csv`;
}

/** Makes the browser save a file. */
function save(name, blob) {
  const link = h('a', {href: URL.createObjectURL(blob), download: name, hidden: true});
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const quoted = (text) => (/[",\n\r]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);

// The exact value of a cell, or its text if it has no exact value.
function cellText(cell) {
  const exact = cell.dataset.value || (cell.querySelector(':scope > [data-value]') || {dataset: {}}).dataset.value;
  const value = exact === undefined ? cell.textContent.trim() : JSON.parse(exact);
  return value === null ? '' : Array.isArray(value) ? value.join(' ') : String(value);
}

/** Rows of texts as CSV. */
export const csvOf = (rows) => rows.map((row) => row.map(quoted).join(',') + '\n').join('');

/** A table in the order of the page, with numbers as exact as the archive's. */
function tableFile(table) {
  const rows = [...table.rows].map((row) => [...row.cells].map(cellText));
  return new Blob([csvOf(rows)], {type: 'text/csv;charset=utf-8'});
}

/** A button that saves a table with this caption. */
export const csvButton = (label, table) =>
    h('button', {
      type: 'button',
      class: 'download',
      'aria-label': `CSV of: ${label}`,
      onclick: () => save(fileName(label), tableFile(table)),
    },
      'CSV');
