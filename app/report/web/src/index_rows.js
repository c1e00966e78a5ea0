// Columns of the index page. Each row is an archive (app/report/site/index_row.hpp).

const digits = 3;
const number = (v, text = (x) => x.toPrecision(digits)) => (typeof v === 'number' ? {v, t: text(v)} : null);
const percent = (v) => number(v, (x) => `${(100 * x).toFixed(1)} %`);

function gain({gain: mean, standard_error: error}) {
  const band = typeof error === 'number' ? ` ± ${error.toPrecision(2)}` : '';
  return number(mean, (x) => x.toPrecision(digits) + band);
}

// The date in short: 2026-11-23T11:11:27Z becomes 2026-11-23 11:11.
const date = ({created}) => (created ? created.slice(0, 16).replace('T', ' ') : null);

function answer({problem, kind, answer: word}) {
  if (problem) return 'not readable';
  return kind === 'study' ? 'study' : word || 'none';
}

// The sentence with the verdict, or the problem of the archive.
export const sentenceOf = ({problem, text}) => problem || text || '';

export const columns = [
  {name: 'Name', text: true, of: ({name}) => name},
  {name: 'Answer', text: true, of: answer},
  {name: 'Data', text: true, of: ({data}) => data},
  {name: 'Modes', of: ({modes}) => modes},
  {name: 'Gain [nats/sample]', of: gain},
  {name: 'Log score', of: ({log_score: score}) => number(score)},
  {name: 'In the 95 % band', of: ({coverage_95: share}) => percent(share)},
  {name: 'Date (UTC)', text: true, of: date},
];

// The path of a page as a URL.
export const addressOf = ({page}) => page.split('/').map(encodeURIComponent).join('/');

const word = (text) => (/^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll('\'', '\'\\\'\'')}'`);

// The command that makes a page which compares these archives.
export function compareCommand(rows) {
  const stems = rows.map(({name}) => name.split('/').pop().replace(/\.h5$/, ''));
  return ['modebank report', ...rows.map(({archive}) => word(archive)), '-o', word(`${stems.join('_')}.html`)].join(
      ' ');
}
