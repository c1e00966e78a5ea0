// Tables that can be sorted by their headings.
import {csvButton} from './downloads.js';
import {h, swatch, value} from './elements.js';
import {sortedRows} from './ordering.js';
import {meaningOf} from './terms.js';

// The cell of a row. Columns are {name, text: true for words, prose: true for sentences, of: row => cell, swatch: row
// => colour or null}.
export function cellOf(column, row) {
  const cell = value(column.of(row), 'td');
  if (column.text || column.prose) cell.classList.add('text');
  if (column.prose) cell.classList.add('prose');
  const colour = column.swatch && column.swatch(row);
  if (colour) cell.prepend(swatch(colour));
  return cell;
}

// `content`: the text of the heading, or the button that sorts. The title explains the column.
export function headingOf(column, attributes, content) {
  const kind = column.text || column.prose ? 'text' : null;
  return h('th', {scope: 'col', class: kind, title: meaningOf(column.name), ...attributes}, content);
}

// The button of a heading. `order`: the present order of the table, {column, down}.
export const sortButton = (onclick, ...content) => h('button', {type: 'button', onclick}, content);
export const ariaSort = (order, column) => (order.column === column ? (order.down ? 'descending' : 'ascending') : null);

// The order after a click on a heading: first ascending by its column, then descending.
export function pressed(order, column) {
  return {column, down: order.column === column && !order.down};
}

export const scrolling = (label, element) =>
    h('div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': label}, element, csvButton(label, element));

// `options`: caption, chosen: row => bool, sortable.
export function table(columns, rows, options = {}) {
  const body = h('tbody'), headings = h('tr');
  let order = {column: null, down: false};
  const show = () => {
    const list = order.column ? sortedRows(rows, order.column.of, order.down) : rows;
    body.replaceChildren(...list.map(
        (row) =>
            h('tr', {class: options.chosen && options.chosen(row) ? 'chosen' : null},
              columns.map((column) => cellOf(column, row)))));
  };
  const cells = columns.map((column) => {
    if (!options.sortable) return headingOf(column, {}, column.name);
    return headingOf(column, {}, sortButton(() => {
                       order = pressed(order, column);
                       cells.forEach((cell, i) => {
                         cell.removeAttribute('aria-sort');
                         if (columns[i] === column) cell.setAttribute('aria-sort', ariaSort(order, column));
                       });
                       show();
                     }, column.name));
  });
  headings.append(...cells);
  show();
  const caption = options.caption ? h('caption', {}, options.caption) : null;
  return scrolling(options.caption || 'table', h('table', {}, caption, h('thead', {}, headings), body));
}
