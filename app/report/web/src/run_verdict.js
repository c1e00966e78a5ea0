// The first screen: finding and reliability of the band. Words and numbers are those of the
// program's first screen (screen_facts.hpp).
import {h, value} from './elements.js';
import {modeColour} from './look.js';
import {section} from './page.js';
import {cellOf, headingOf, scrolling} from './table.js';
import {meaningOf} from './terms.js';

const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

// A cell may break between its parts, but not between a number and its error or unit.
const breakable = (text) => text.replace(/ (±|%|s\b|m\b)/g, '\u00a0$1').replace(/(±|period) /g, '$1\u00a0');

// Finds commands (`modebank show`) and options (--filter.horizon 10) in a sentence.
const command = /(`[^`]+`|--[\w.]+(?:[ =](?:'[^']*'|[\d.]+|auto|varx))?)/;
// Browsers break lines after hyphens. Without this, `--filter.horizon` could be split.
const words = (text) => text.split(' ').flatMap((word, i) => [i ? ' ' : null, h('span', {class: 'word'}, word)]);
const withCode = (text) =>
    text.split(command).map((part, i) => (i % 2 ? h('code', {}, words(part.replace(/`/g, ''))) : part));

function card(row) {
  return h(
      'li', {'data-card': row.key}, h('div', {class: 'name', title: meaningOf(row.name)}, row.name),
      h('div', {}, h('span', {class: 'big'}, value(row.big)), ' ', h('span', {class: 'soft'}, row.unit)),
      h('div', {class: 'said'}, withCode(row.said)));
}

const cardList = (id, rows) => (rows.length ? h('ul', {class: 'numbers', id}, rows.map(card)) : null);

function modesTable(modes) {
  const unit = modes.gain_unit ? `; gains in ${modes.gain_unit}` : '';
  const columns = modes.headings.map((name, i) => ({
                                       name,
                                       text: i === 0,
                                       of: (row) => breakable(row.cells[i]),
                                       swatch: i === 0 ? (row) => modeColour(row.modes[0]) : null,
                                     }));
  const head = h('tr', {}, columns.map((column) => headingOf(column, {}, column.name)));
  const body = modes.rows.map((row) => h('tr', {}, columns.map((column) => cellOf(column, row))));
  const caption = h('caption', {}, modes.title + unit);
  return h(
      'div', {id: 'screen-modes'},
      scrolling('Modes in words', h('table', {}, caption, h('thead', {}, head), h('tbody', {}, body))),
      modes.others ? h('p', {class: 'soft'}, modes.others) : null);
}

export function drawVerdict(verdict) {
  const sort = verdict.good === true ? 'good' : verdict.good === false ? 'bad' : '';
  const of = (wanted) => verdict.cards.filter((row) => (row.key === 'coverage') === wanted);
  const said =
      h('div', {id: 'said', class: `verdict ${sort}`}, h('p', {class: 'answer'}, capital(verdict.headline), '.'),
        h('p', {}, withCode(verdict.text)), (verdict.equations || []).map((line) => h('p', {}, h('code', {}, line))));
  const use =
      verdict.use ? h('p', {id: 'use', class: 'note'}, withCode(capital(verdict.use).replace(/ \+- /g, ' ± '))) : null;
  const warning = verdict.warning ? h('p', {id: 'warning', class: 'soft'}, h('strong', {}, 'Warning: '),
                                      withCode(verdict.warning.replace(/ \+- /g, ' ± '))) :
                                    null;
  section(
      'verdict', 'Verdict',
      h('div', {class: 'screen'}, said, cardList('coverage', of(true)), use, cardList('scores', of(false)),
        verdict.modes ? modesTable(verdict.modes) : null, warning));
}
