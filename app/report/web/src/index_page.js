// The index page of a folder of archives: a table with sorting and filters, and the command that compares the selected
// archives.
import {controls, copyButton, h} from './elements.js';
import {filterOf} from './filter_text.js';
import {addressOf, columns, compareCommand, sentenceOf} from './index_rows.js';
import {sortedRows} from './ordering.js';
import {draw, head} from './page.js';
import {pageData} from './page_data.js';
import {ariaSort, cellOf, headingOf, pressed, scrolling, sortButton} from './table.js';

const data = pageData(), filters = new Map(), ticked = new Set();
let order = {column: columns[columns.length - 1], down: true};
const headings = h('tr'), body = h('tbody');
const count = h('p', {class: 'soft', role: 'status', id: 'count'});
const command = h('code', {id: 'compare', role: 'status'});
const copy = copyButton('Copy', () => command.textContent);

function showCommand() {
  const rows = data.rows.filter((row) => ticked.has(row)), most = data.most_compared;
  const enough = rows.length >= 2 && rows.length <= most;
  command.textContent =
      enough ? compareCommand(rows) : `Tick two to ${most} archives to see the command that compares them.`;
  copy.hidden = !enough;
}

function tickCell(row) {
  const box = h('input', {
    type: 'checkbox',
    'aria-label': `Compare ${row.name}`,
    checked: ticked.has(row),
    disabled: row.kind !== 'run' || !row.page,
    onchange: () => {
      ticked[box.checked ? 'add' : 'delete'](row);
      showCommand();
    },
  });
  return h('td', {}, box);
}

function line(row) {
  const cells = columns.map((column) => cellOf(column, row));
  if (row.page) cells[0].replaceChildren(h('a', {href: addressOf(row)}, row.name));
  cells[1].title = sentenceOf(row);
  if (row.problem) cells[1].append(h('div', {class: 'soft sentence'}, row.problem));
  return h('tr', {}, tickCell(row), cells);
}

function fill() {
  const tests = columns.map((column) => [filterOf(filters.get(column) || ''), column.of]);
  const shown = data.rows.filter((row) => tests.every(([test, of]) => test(of(row))));
  body.replaceChildren(...sortedRows(shown, order.column.of, order.down).map(line));
  count.textContent = `${shown.length} of ${data.rows.length} archives`;
}

function frame() {
  headings.replaceChildren(h('th', {scope: 'col'}, 'Compare'), ...columns.map((column) => {
    const sort = ariaSort(order, column), mark = {ascending: ' ▴', descending: ' ▾'}[sort] || '';
    const sortBy = () => {
      order = pressed(order, column);
      frame();
      fill();
      headings.querySelector('[aria-sort] button').focus();
    };
    return headingOf(column, {'aria-sort': sort}, sortButton(sortBy, column.name + mark));
  }));
}

function filterRow() {
  const field = (column) => h('input', {
    type: 'search',
    size: 6,
    'aria-label': `Filter ${column.name}`,
    oninput: (event) => {
      filters.set(column, event.target.value);
      fill();
    },
  });
  return h('tr', {class: 'filters'}, h('td'), columns.map((column) => h('td', {}, field(column))));
}

draw(() => {
  head(data.folder, 'Archives of modebank');
  frame();
  fill();
  showCommand();
  const table =
      h('table', {id: 'archives'}, h('caption', {}, 'Archives of the folder'), h('thead', {}, headings, filterRow()),
        body);
  document.getElementById('main').append(
      controls(h('p', {class: 'soft'}, 'Filters: a part of the text, > 2, <= 0.1, 3..5 or a | b.'), count),
      controls(command, copy), scrolling('Table of archives', table));
});
