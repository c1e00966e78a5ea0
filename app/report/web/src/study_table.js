// The table of a study's runs: click a heading to sort; type under it to filter; a run is chosen by click or Enter.
import {check, controls, details, h} from './elements.js';
import {filterOf} from './filter_text.js';
import {sortedRows} from './ordering.js';
import {ariaSort, cellOf, headingOf, pressed, scrolling, sortButton} from './table.js';

const at_once = 200;  // rows shown at first

class StudyTable {
  // `reader`: filter(rows, base, dragged), showRun(row), chosen() => row.
  constructor(study, reader) {
    this.study = study;
    this.reader = reader;
    this.columns =
        study.columns.map((column, i) => ({...column, of: (row) => row.cells[i], visible: column.shown, filter: ''}));
    this.order = {column: null, down: false};
    this.restriction = null;
    this.most = at_once;
    this.rows = study.rows;
    this.body = h('tbody');
    this.status = h('p', {class: 'soft', role: 'status', id: 'run-count'});
    this.headings = h('tr');
    this.inputs = h('tr', {class: 'filters'});
    this.more = h('button', {type: 'button', onclick: () => this.showMore()}, 'Show more');
  }

  visible() {
    return this.columns.filter((column) => column.visible);
  }

  line(row) {
    const {chosen, showRun} = this.reader;
    return h(
        'tr', {
          'data-number': row.number,
          tabindex: 0,
          class: chosen() === row ? 'chosen' : null,
          onclick: () => showRun(row),
          onkeydown: (event) => {
            if (event.key === 'Enter') showRun(row);
          },
        },
        this.visible().map((column) => cellOf(column, row)));
  }

  showMore() {
    this.most += 5 * at_once;
    this.fill();
  }

  fill() {
    const {length} = this.rows, all = this.study.rows.length, cut = length > this.most;
    this.body.replaceChildren(...this.rows.slice(0, this.most).map((row) => this.line(row)));
    this.status.textContent = `${length} of ${all} runs${cut ? `, the first ${this.most} of them shown` : ''}`;
    this.more.hidden = !cut;
  }

  // Filters, restricts and sorts the rows anew.
  update(dragged = false) {
    const tests = this.columns.filter(({filter}) => filter.trim()).map(({filter, of}) => [filterOf(filter), of]);
    const base = this.study.rows.filter((row) => tests.every(([test, of]) => test(of(row))));
    this.rows = this.restriction ? base.filter(this.restriction) : base;
    const {column, down} = this.order;
    if (column) this.rows = sortedRows(this.rows, column.of, down);
    this.fill();
    this.reader.filter(this.rows, base, dragged);
  }

  heading(column) {
    const sort = ariaSort(this.order, column), mark = {ascending: ' ▴', descending: ' ▾'}[sort] || '';
    return headingOf(column, {'aria-sort': sort}, sortButton(() => {
                       this.order = pressed(this.order, column);
                       this.frame();
                       this.update();
                     }, column.name + mark));
  }

  input(column) {
    const oninput = (event) => {
      column.filter = event.target.value;
      this.update();
    };
    return h('td', {}, h('input', {
               type: 'search',
               size: 6,
               'aria-label': `Filter ${column.name}`,
               'data-column': column.name,
               value: column.filter,
               oninput,
             }));
  }

  // Headings and the fields under them.
  frame() {
    this.headings.replaceChildren(...this.visible().map((column) => this.heading(column)));
    this.inputs.replaceChildren(...this.visible().map((column) => this.input(column)));
  }

  columnChoice(column) {
    return check(column.name, column.visible, (on) => {
      column.visible = on;
      this.frame();
      this.fill();
    });
  }

  elements() {
    const caption = h('caption', {}, 'Every run with its varied keys and scores');
    const element = h('table', {id: 'study-table'}, caption, h('thead', {}, this.headings, this.inputs), this.body);
    const help = 'Filters: a part of the text, > 2, <= 0.1, 3..5 or a | b. The plots below show the runs that pass.';
    return [
      h('p', {class: 'soft'}, help),
      details('Columns', controls(this.columns.map((column) => this.columnChoice(column)))),
      this.status,
      scrolling('Table of runs', element),
      this.more,
    ];
  }
}

export function drawStudyTable(place, study, reader) {
  const table = new StudyTable(study, reader);
  place.append(...table.elements());
  table.frame();
  table.update();
  return {
    // Only rows that pass the test, too; null for all.
    restrict: (test) => {
      table.restriction = test;
      table.update(true);
    },
  };
}
