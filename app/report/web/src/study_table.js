// The table of a study's runs. A click on a heading sorts, text below a heading filters, and a click or Enter on a row
// selects the run. All repeats of a setting share one row, unless the reader chooses single runs.
import {check, controls, details, h} from './elements.js';
import {filterOf} from './filter_text.js';
import {sortedRows} from './ordering.js';
import {groupedRows} from './repeats.js';
import {columnTitle} from './score_names.js';
import {ariaSort, cellOf, headingOf, pressed, scrolling, sortButton} from './table.js';

const at_once = 30;  // number of rows that are shown at first

class StudyTable {
  // `reader`: an object with filter(rows), showRun(row) and chosen() => row.
  constructor(study, reader) {
    this.study = study;
    this.reader = reader;
    this.columns = this.inOrder(
        study.columns.map((column, i) => ({...column, of: (row) => row.cells[i], visible: column.shown, filter: ''})));
    this.order = this.bestFirst();
    this.grouped = study.rows.some((row) => row.repeat > 0);
    this.most = at_once;
    this.rows = study.rows;
    this.body = h('tbody');
    this.status = h('p', {class: 'soft', role: 'status', id: 'run-count'});
    this.headings = h('tr');
    this.inputs = h('tr', {class: 'filters'});
    this.more = h('button', {type: 'button', onclick: () => this.showMore()}, 'Show more');
  }

  // The order of columns: varied keys, the verdict's score, the number of modes, all others.
  inOrder(columns) {
    const place = ({kind, name}) =>
        (kind === 'varied'                      ? 0 :
             name === this.study.standard_score ? 1 :
             kind === 'cost'                    ? 2 :
                                                  3);
    return columns.map((column, i) => [place(column), i, column])
        .sort((p, q) => p[0] - q[0] || p[1] - q[1])
        .map(([, , column]) => column);
  }

  // Sorts by the score of the verdict, the best first.
  bestFirst() {
    const column = this.columns.find(({name}) => name === this.study.standard_score) || null;
    return {column, down: Boolean(column && (!column.goal || column.goal.kind === 'higher'))};
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
    this.most += 10 * at_once;
    this.fill();
  }

  fill() {
    const {length} = this.rows, all = this.study.rows.length, lines = this.lines(), cut = lines.length > this.most;
    const settings = this.grouped ? ` in ${lines.length} settings` : '';
    this.body.replaceChildren(...lines.slice(0, this.most).map((row) => this.line(row)));
    this.status.textContent =
        `${length} of ${all} runs${settings}${cut ? `, the first ${this.most} lines of them shown` : ''}`;
    this.more.hidden = !cut;
  }

  // Rows of the table: single runs, or settings with all their repeats.
  lines() {
    const rows = this.grouped ? groupedRows(this.study.columns, this.rows) : this.rows;
    const {column, down} = this.order;
    return column ? sortedRows(rows, column.of, down) : rows;
  }

  // Applies filters and order to the rows again.
  update() {
    const tests = this.columns.filter(({filter}) => filter.trim()).map(({filter, of}) => [filterOf(filter), of]);
    this.rows = this.study.rows.filter((row) => tests.every(([test, of]) => test(of(row))));
    this.fill();
    this.reader.filter(this.rows);
  }

  heading(column) {
    const sort = ariaSort(this.order, column), mark = {ascending: ' ▴', descending: ' ▾'}[sort] || '';
    return headingOf(column, {'aria-sort': sort, 'data-column': column.name}, sortButton(() => {
                       this.order = pressed(this.order, column);
                       this.frame();
                       this.update();
                     }, columnTitle(column.name) + mark));
  }

  input(column) {
    const oninput = (event) => {
      column.filter = event.target.value;
      this.update();
    };
    return h('td', {}, h('input', {
               type: 'search',
               size: 6,
               'aria-label': `Filter ${columnTitle(column.name)}`,
               'data-column': column.name,
               value: column.filter,
               oninput,
             }));
  }

  // The headings and the input fields below them.
  frame() {
    this.headings.replaceChildren(...this.visible().map((column) => this.heading(column)));
    this.inputs.replaceChildren(...this.visible().map((column) => this.input(column)));
  }

  columnChoice(column) {
    return check(columnTitle(column.name), column.visible, (on) => {
      column.visible = on;
      this.frame();
      this.fill();
    });
  }

  groupChoice() {
    return check('Repeats of a setting in one line (mean ± standard deviation)', this.grouped, (on) => {
      this.grouped = on;
      this.fill();
    });
  }

  elements() {
    const caption = h('caption', {}, 'Every run with its varied keys and scores');
    const element = h('table', {id: 'study-table'}, caption, h('thead', {}, this.headings, this.inputs), this.body);
    const help = 'Filters: a part of the text, > 2, <= 0.1, 3..5 or a | b. The plots below show the runs that pass.';
    return [
      h('p', {class: 'soft'}, help),
      this.study.rows.some((row) => row.repeat > 0) ? controls(this.groupChoice()) : null,
      details('Columns', controls(this.columns.map((column) => this.columnChoice(column)))),
      this.status,
      scrolling('Table of runs', element),
      this.more,
    ].filter(Boolean);
  }
}

export function drawStudyTable(place, study, reader) {
  const table = new StudyTable(study, reader);
  place.append(...table.elements());
  table.frame();
  table.update();
}
