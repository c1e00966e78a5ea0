// The overview of a folder of archives that `modebank view` serves: a table that sorts and filters, two ticks to
// compare, new archives by themselves.
import {controls, h, note} from './elements.js';
import {filterOf} from './filter_text.js';
import {sortedRows} from './ordering.js';
import {columns, nameOf, sentenceOf, ticked} from './overview_rows.js';
import {draw, head} from './page.js';
import {ariaSort, cellOf, headingOf, pressed, scrolling, sortButton} from './table.js';

const poll_ms = 2000;
const at_once = 500;  // rows shown

class Overview {
  constructor() {
    this.rows = [];
    this.filters = new Map();
    this.order = {column: columns[columns.length - 1], down: true};
    this.ticks = [];
    this.headings = h('tr');
    this.body = h('tbody');
    this.count = h('p', {class: 'soft', role: 'status', id: 'count'});
    this.compare =
        h('button', {type: 'button', id: 'compare', onclick: () => this.showBoth()}, 'Compare the two ticked');
  }

  showBoth() {
    location.assign(`/compare/${this.ticks.join('/')}`);
  }

  tick(id, on) {
    this.ticks = ticked(this.ticks, id, on);
    this.body.querySelectorAll('input').forEach((box) => {
      box.checked = this.ticks.includes(box.dataset.id);
    });
    this.compare.disabled = this.ticks.length < 2;
  }

  tickCell(row) {
    const box = h('input', {
      type: 'checkbox',
      'data-id': row.id,
      'aria-label': `Compare ${nameOf(row)}`,
      checked: this.ticks.includes(row.id),
      disabled: !row.digest || row.digest.kind !== 'run',
      onchange: () => this.tick(row.id, box.checked),
    });
    return h('td', {}, box);
  }

  line(row) {
    const cells = columns.map((column) => cellOf(column, row));
    cells[0].replaceChildren(h('a', {href: `/archive/${row.id}`, 'data-id': row.id}, nameOf(row)));
    cells[1].title = sentenceOf(row);
    if (row.problem) cells[1].append(h('div', {class: 'soft sentence'}, row.problem));
    return h('tr', {}, this.tickCell(row), cells);
  }

  shown() {
    const tests = columns.map((column) => [filterOf(this.filters.get(column) || ''), column.of]);
    const passing = this.rows.filter((row) => tests.every(([test, of]) => test(of(row))));
    return sortedRows(passing, this.order.column.of, this.order.down);
  }

  fill() {
    const focused = /** @type {HTMLElement|null} */ (document.activeElement), key = focused && focused.dataset.id;
    const rows = this.shown();
    this.body.replaceChildren(...rows.slice(0, at_once).map((row) => this.line(row)));
    this.count.textContent = `${rows.length} of ${this.rows.length} archives` +
        (rows.length > at_once ? `, the first ${at_once} of them shown` : '');
    if (key) {
      const again = this.body.querySelector(`${focused.tagName.toLowerCase()}[data-id="${key}"]`);
      if (again) again.focus();
    }
  }

  frame() {
    this.headings.replaceChildren(h('th', {scope: 'col'}, 'Compare'), ...columns.map((column) => {
      const sort = ariaSort(this.order, column), mark = {ascending: ' ▴', descending: ' ▾'}[sort] || '';
      const sortBy = () => {
        this.order = pressed(this.order, column);
        this.frame();
        this.fill();
        this.headings.querySelector('[aria-sort] button').focus();
      };
      return headingOf(column, {'aria-sort': sort}, sortButton(sortBy, column.name + mark));
    }));
  }

  filterRow() {
    const field = (column) => h('input', {
      type: 'search',
      size: 6,
      'aria-label': `Filter ${column.name}`,
      oninput: (event) => {
        this.filters.set(column, event.target.value);
        this.fill();
      },
    });
    return h('tr', {class: 'filters'}, h('td'), columns.map((column) => h('td', {}, field(column))));
  }

  elements() {
    this.frame();
    this.tick(null, false);
    const caption = h('caption', {}, 'Archives of the folder');
    const heading = h('thead', {}, this.headings, this.filterRow());
    const help = 'Filters: a part of the text, > 2, <= 0.1, 3..5 or a | b. New archives appear by themselves.';
    return [
      h('p', {class: 'soft'}, help),
      controls(this.compare, this.count),
      scrolling('Table of archives', h('table', {id: 'archives'}, caption, heading, this.body)),
    ];
  }

  take(rows) {
    this.rows = rows;
    const ids = new Set(rows.map(({id}) => id));
    this.ticks = this.ticks.filter((id) => ids.has(id));
    this.compare.disabled = this.ticks.length < 2;
    this.fill();
  }
}

async function ask(version) {
  const response = await fetch(`/overview.json${version ? `?${version}` : ''}`, {credentials: 'same-origin'});
  if (!response.ok) throw new Error('the server answers no more');
  return response.json();
}

function follow(overview, first) {
  let {version} = first;
  const lost = note('modebank view has ended or does not answer: what stands here may be old.', true);
  lost.hidden = true;
  lost.setAttribute('role', 'alert');
  document.getElementById('main').prepend(lost);
  const again = async () => {
    try {
      if (!document.hidden) {
        const news = await ask(version);
        if (news.rows) overview.take(news.rows);
        ({version} = news);
        lost.hidden = true;
      }
    } catch {
      lost.hidden = false;
    }
    setTimeout(again, poll_ms);
  };
  setTimeout(again, poll_ms / 4);
}

draw(async () => {
  const first = await ask('');
  const overview = new Overview();
  document.title = `${first.title} – archives`;
  head(first.title, 'Archives of modebank');
  document.getElementById('main').append(...overview.elements());
  if (first.cut) document.getElementById('main').prepend(note('There are more archives than are shown here.'));
  overview.take(first.rows);
  follow(overview, first);
});
