// The page of a study: its runs as a table that sorts and filters, and what the varied keys do to the scores.
import { copyButton, data, draw, facts, h, head, note, section, table } from './common.js';
import { drawStudyTable } from './study_table.js';
import { drawCoverage, drawEffects, drawHeatMap, drawParallel, drawPareto } from './study_plots.js';

const study = data.study;
// The runs that pass the filters (base) and what was dragged in the parallel coordinates, too (rows); every plot follows.
const shown = { rows: study.rows, base: study.rows, listeners: [] };

function drawOrigin() {
  section('origin', 'What was run',
    facts([['Runs', study.counts.map(([status, count]) => `${count} ${status}`).join(', ')], ['Command', h('code', {}, data.origin.command)],
      ['Made', `${data.origin.created} by modebank ${data.origin.version}`], ['Data', h('code', {}, data.origin.data_hash)]]),
    table([{ name: 'Varied key', text: true, of: (row) => row.key }, { name: 'Values', text: true, of: (row) => row.values }],
      study.varied, { caption: 'What was varied' }),
    h('details', {}, h('summary', {}, "The study's configuration"), copyButton('Copy the configuration', data.origin.config), h('pre', { tabindex: 0 }, data.origin.config)));
}

function drawVerdict() {
  const best = study.best;
  section('verdict', 'Verdict',
    h('p', { class: 'verdict' }, best.text),
    best.row === null ? null : h('p', {}, h('button', { type: 'button', id: 'show-best', onclick: () => showRun(study.rows[best.row]) }, 'Show the best run')));
}

// A run: its configuration, its scores, its page or how to make it.
const detail = h('div', { id: 'run-detail', tabindex: -1, 'aria-live': 'polite' }, note('Choose a run in the table or in a plot.'));
let chosen = null;

function configurationOf(row) {
  return study.varied.map(({ key }, i) => `${key} = ${row.varied[i]}`).concat(`job.seed = ${row.seed}`);
}

function showRun(row) {
  chosen = row;
  const options = configurationOf(row).map((line) => { const [key, ...rest] = line.split(' = '); return `--${key} '${rest.join(' = ')}'`; }).join(' ');
  const scores = study.columns.map((column, i) => ({ name: column.name, cell: row.cells[i] })).filter(({ cell }) => cell && typeof cell === 'object');
  const archive = row.page ? h('a', { href: row.page, id: 'run-page' }, "This run's page")
    : row.archive ? h('span', {}, 'Its page is made by ', h('code', {}, `modebank report ${row.archive}`)) : 'Its archive is not there.';
  detail.replaceChildren(h('h3', {}, `Run ${row.number}: ${row.status}`), row.message ? note(row.message, true) : '',
    facts([...configurationOf(row).map((line) => line.split(' = ')), ['key', h('code', {}, row.key)], ['archive', archive]]),
    copyButton('Copy as options', options),
    scores.length ? table([{ name: 'Score', text: true, of: (s) => s.name }, { name: 'Value', of: (s) => s.cell }], scores, { caption: 'Scores of this run' }) : '');
  document.getElementById('runs').querySelectorAll('tr.chosen').forEach((line) => line.classList.remove('chosen'));
  const line = document.getElementById('runs').querySelector(`tr[data-number="${row.number}"]`);
  if (line) line.classList.add('chosen');
  detail.scrollIntoView({ block: 'nearest' });
}

draw(async () => {
  document.title = `Study ${data.file}`;
  head(`Study ${data.file}`, `${study.rows.length} runs, made ${data.origin.created}`);
  drawOrigin();
  drawVerdict();
  const filter = (rows, base, dragged) => { Object.assign(shown, { rows, base }); shown.listeners.forEach((listener) => listener(dragged)); };
  const runs = section('runs', 'Runs');
  const tableOfRuns = drawStudyTable(runs, study, { filter, showRun, chosen: () => chosen });
  runs.append(detail);
  const context = { study, shown, showRun, restrict: tableOfRuns.restrict };
  drawParallel(context);
  drawEffects(context);
  drawHeatMap(context);
  drawPareto(context);
  drawCoverage(context);
});
