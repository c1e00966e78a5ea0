// The table of a study's runs: click a heading to sort; type under it to filter; a run is chosen by click or Enter.
import { h, value } from './common.js';

const plainValue = (cell) => (cell && typeof cell === 'object' ? cell.v : cell);

// "> 2", "<= 0.1", "3..5" and "a | b" (any of); anything else is a part of the text. Returns cell => bool.
export function filterOf(text) {
  const word = text.trim();
  if (!word) return () => true;
  const number = (t) => (t.trim() === '' ? NaN : Number(t));
  const comparison = /^(>=|<=|>|<|=)\s*(\S+)$/.exec(word);
  if (comparison && !Number.isNaN(number(comparison[2]))) {
    const limit = number(comparison[2]);
    const holds = { '>': (v) => v > limit, '<': (v) => v < limit, '>=': (v) => v >= limit, '<=': (v) => v <= limit, '=': (v) => v === limit }[comparison[1]];
    return (cell) => { const v = plainValue(cell); return v !== null && v !== '' && !Number.isNaN(Number(v)) && holds(Number(v)); };
  }
  const range = /^(\S+)\.\.(\S+)$/.exec(word);
  if (range && !Number.isNaN(number(range[1])) && !Number.isNaN(number(range[2]))) {
    return (cell) => { const v = plainValue(cell); return v !== null && v !== '' && Number(v) >= number(range[1]) && Number(v) <= number(range[2]); };
  }
  const shownText = (cell) => (cell === null || cell === undefined ? '' : String(typeof cell === 'object' ? cell.t : cell));
  if (word.includes('|')) {
    const choices = word.split('|').map((t) => t.trim());
    return (cell) => choices.includes(shownText(cell)) || choices.includes(String(plainValue(cell)));
  }
  return (cell) => shownText(cell).toLowerCase().includes(word.toLowerCase());
}

const known = (v) => v !== null && v !== undefined && v !== '';
export function compareCells(a, b) {
  const x = plainValue(a), y = plainValue(b);
  if (!known(x) || !known(y)) return known(x) ? -1 : known(y) ? 1 : 0;
  const p = Number(x), q = Number(y);
  return Number.isNaN(p) || Number.isNaN(q) ? String(x).localeCompare(String(y), 'en', { numeric: true }) : p - q;
}

export function drawStudyTable(place, study, { filter, showRun, chosen }) {
  const atOnce = 200;
  const state = { order: null, down: false, filters: study.columns.map(() => ''), restriction: null, most: atOnce, visible: study.columns.map((c) => c.shown) };
  const body = h('tbody');
  const status = h('p', { class: 'soft', role: 'status', id: 'run-count' });
  const more = h('button', { type: 'button', onclick: () => { state.most += 5 * atOnce; fill(); } }, 'Show more');
  const headings = h('tr'), inputs = h('tr', { class: 'filters' });
  const element = h('table', { id: 'study-table' }, h('caption', {}, 'Every run with its varied keys and scores'), h('thead', {}, headings, inputs), body);
  let rows = study.rows;

  const visible = () => study.columns.map((c, i) => i).filter((i) => state.visible[i]);
  function line(row) {
    const element = h('tr', { 'data-number': row.number, tabindex: 0, class: chosen() === row ? 'chosen' : null,
      onclick: () => showRun(row), onkeydown: (event) => { if (event.key === 'Enter') showRun(row); } });
    for (const i of visible()) {
      const cell = value(row.cells[i], 'td');
      if (study.columns[i].text) cell.classList.add('text');
      element.append(cell);
    }
    return element;
  }
  function fill() {
    body.replaceChildren(...rows.slice(0, state.most).map(line));
    status.textContent = `${rows.length} of ${study.rows.length} runs` + (rows.length > state.most ? `, the first ${state.most} of them shown` : '');
    more.hidden = rows.length <= state.most;
  }
  function update(dragged = false) {
    const tests = state.filters.map((text, i) => [filterOf(text), i, text]).filter(([, , text]) => text.trim());
    const base = study.rows.filter((row) => tests.every(([test, i]) => test(row.cells[i])));
    rows = state.restriction ? base.filter(state.restriction) : base;
    if (state.order !== null) {
      const i = state.order, sign = state.down ? -1 : 1;
      rows = [...rows].sort((a, b) => {
        const unknown = known(plainValue(a.cells[i])) - known(plainValue(b.cells[i]));
        return unknown ? -unknown : sign * compareCells(a.cells[i], b.cells[i]);  // unknown values last, either way
      });
    }
    fill();
    filter(rows, base, dragged);
  }
  function heading(i) {
    const column = study.columns[i];
    const cell = h('th', { scope: 'col', class: column.text ? 'text' : null, 'aria-sort': state.order === i ? (state.down ? 'descending' : 'ascending') : null });
    cell.append(h('button', { type: 'button', onclick: () => { state.down = state.order === i && !state.down; state.order = i; frame(); update(); } },
      column.name + (state.order === i ? (state.down ? ' ▾' : ' ▴') : '')));
    return cell;
  }
  function frame() {
    headings.replaceChildren(...visible().map(heading));
    inputs.replaceChildren(...visible().map((i) => h('td', {}, h('input', { type: 'search', size: 6, 'aria-label': `Filter ${study.columns[i].name}`,
      'data-column': study.columns[i].name, value: state.filters[i], oninput: (event) => { state.filters[i] = event.target.value; update(); } }))));
  }
  const columns = h('details', {}, h('summary', {}, 'Columns'), h('div', { class: 'controls' }, study.columns.map((column, i) => {
    const box = h('input', { type: 'checkbox', checked: state.visible[i], onchange: () => { state.visible[i] = box.checked; frame(); fill(); } });
    return h('label', {}, box, column.name);
  })));
  place.append(h('p', { class: 'soft' }, 'Filters: a part of the text, > 2, <= 0.1, 3..5 or a | b. The plots below show the runs that pass.'),
    columns, status, h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Table of runs' }, element), more);
  frame();
  update();
  return { restrict: (test) => { state.restriction = test; update(true); } };
}
