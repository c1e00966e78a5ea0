// The page of a study: a table of runs, and the effects of varied keys on scores.
import {copyButton, details, facts, h, note} from './elements.js';
import {draw, head, section} from './page.js';
import {pageData} from './page_data.js';
import {columnTitle} from './score_names.js';
import {drawBetter} from './study_better.js';
import {drawEffects} from './study_effects.js';
import {drawStudyTable} from './study_table.js';
import {table} from './table.js';

function drawOrigin(study, origin) {
  const columns = [
    {name: 'Varied key', text: true, of: (row) => row.key},
    {name: 'Values', text: true, of: (row) => row.values},
  ];
  section(
      'origin', 'What was run', facts([
        ['Runs', study.counts.map(([status, count]) => `${count} ${status}`).join(', ')],
        ['Command', h('code', {}, origin.command)],
        ['Made', `${origin.created} by modebank ${origin.version}`],
        ['Data', h('code', {}, origin.data_hash)],
      ]),
      table(columns, study.varied, {caption: 'What was varied'}),
      details(
          'The study\'s configuration', copyButton('Copy the configuration', origin.config),
          h('pre', {tabindex: 0}, origin.config)));
}

function drawVerdict(study, showRun) {
  const {text, row} = study.best;
  const show = () => showRun(study.rows[row]);
  section(
      'verdict', 'Verdict', h('p', {class: 'verdict'}, text),
      row === null ? null :
                     h('p', {}, h('button', {type: 'button', id: 'show-best', onclick: show}, 'Show the best run')));
}

// [key, value] pairs of the configuration that repeats the run.
function configurationOf(study, row) {
  return [...study.varied.map(({key}, i) => [key, String(row.varied[i])]), ['job.seed', String(row.seed)]];
}

function archiveOf(row) {
  if (row.page) return h('a', {href: row.page, id: 'run-page'}, 'This run\'s page');
  if (!row.archive) return 'Its archive is missing.';
  return h('span', {}, 'Its page is made by ', h('code', {}, `modebank report ${row.archive}`));
}

// One run: its configuration, its scores, and its page or the command that makes this page.
function runDetail(study, row) {
  const configuration = configurationOf(study, row);
  const scores = study.columns.map((column, i) => ({name: columnTitle(column.name), cell: row.cells[i]}))
                     .filter(({cell}) => cell && typeof cell === 'object');
  const columns = [{name: 'Score', text: true, of: (s) => s.name}, {name: 'Value', of: (s) => s.cell}];
  return [
    h('h3', {}, `Run ${row.number}: ${row.status}`),
    row.message ? note(row.message, true) : '',
    facts([...configuration, ['key', h('code', {}, row.key)], ['archive', archiveOf(row)]]),
    copyButton('Copy as options', configuration.map(([key, text]) => `--${key} '${text}'`).join(' ')),
    scores.length ? details('All scores of this run', table(columns, scores, {caption: 'Scores of this run'})) : '',
  ];
}

function markChosen(row) {
  const runs = document.getElementById('runs');
  runs.querySelectorAll('tr.chosen').forEach((line) => line.classList.remove('chosen'));
  const line = runs.querySelector(`tr[data-number="${row.number}"]`);
  if (line) line.classList.add('chosen');
}

draw(async () => {
  const data = pageData(), {study} = data;
  const detail = h('div', {id: 'run-detail', tabindex: -1, 'aria-live': 'polite'}, note('Choose a run in the table.'));
  let chosen = null;
  const showRun = (row) => {
    chosen = row;
    detail.replaceChildren(...runDetail(study, row));
    markChosen(row);
    detail.scrollIntoView({block: 'nearest'});
  };
  document.title = `Study ${data.file}`;
  head(`Study ${data.file}`, `${study.rows.length} runs, made ${data.origin.created}`);
  drawVerdict(study, showRun);
  drawBetter(study, showRun);
  const runs = section('runs', 'Runs');
  drawStudyTable(runs, study, {showRun, chosen: () => chosen});
  runs.append(detail);
  drawEffects(study);
  drawOrigin(study, data.origin);
});
