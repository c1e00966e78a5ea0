// The table of a study's runs. A click on a heading sorts, and a click or Enter on a row selects the run.
import {check, controls, details, h} from './elements.js';
import {sortedRows} from './ordering.js';
import {columnTitle} from './score_names.js';
import {ariaSort, cellOf, headingOf, pressed, scrolling, sortButton} from './table.js';

const at_once = 30;  // number of rows that are shown at first

class StudyTable {
  // `reader`: an object with showRun(row) and chosen() => row.
  constructor(study, reader) {
    this.study = study;
    this.reader = reader;
    this.columns =
        this.inOrder(study.columns.map((column, i) => ({...column, of: (row) => row.cells[i], visible: column.shown})));
    this.order = this.bestFirst();
    this.most = at_once;
    this.body = h('tbody');
    this.status = h('p', {class: 'soft', role: 'status', id: 'run-count'});
    this.headings = h('tr');
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
    const all = this.study.rows.length, lines = this.lines(), cut = all > this.most;
    this.body.replaceChildren(...lines.slice(0, this.most).map((row) => this.line(row)));
    this.status.textContent = `${all} runs${cut ? `, the first ${this.most} of them shown` : ''}`;
    this.more.hidden = !cut;
  }

  lines() {
    const {column, down} = this.order;
    return column ? sortedRows(this.study.rows, column.of, down) : this.study.rows;
  }


  heading(column) {
    const sort = ariaSort(this.order, column), mark = {ascending: ' ▴', descending: ' ▾'}[sort] || '';
    return headingOf(column, {'aria-sort': sort, 'data-column': column.name}, sortButton(() => {
                       this.order = pressed(this.order, column);
                       this.frame();
                       this.fill();
                     }, columnTitle(column.name) + mark));
  }

  frame() {
    this.headings.replaceChildren(...this.visible().map((column) => this.heading(column)));
  }

  columnChoice(column) {
    return check(columnTitle(column.name), column.visible, (on) => {
      column.visible = on;
      this.frame();
      this.fill();
    });
  }

  elements() {
    const caption = h('caption', {}, 'Every run with its varied keys and scores');
    const element = h('table', {id: 'study-table'}, caption, h('thead', {}, this.headings), this.body);
    return [
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
  table.fill();
}
