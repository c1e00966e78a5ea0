// What the overview of a folder shows of each archive; `row` is as overview.json has it (app/view/digest.hpp).

const digits = 3;
const number = (v, text = (x) => x.toPrecision(digits)) => (typeof v === 'number' ? {v, t: text(v)} : null);

const percent = (v) => number(v, (x) => `${(100 * x).toFixed(1)} %`);

function gain({gain: mean, standard_error: error}) {
  if (typeof mean !== 'number') return null;
  const band = typeof error === 'number' ? ` ± ${error.toPrecision(2)}` : '';
  return {v: mean, t: mean.toPrecision(digits) + band};
}

// 2026-11-23T11:11:27Z, or when the file was changed, as 2026-11-23 11:11.
function date({digest, changed_s: changed}) {
  const created = (digest && digest.created) || new Date(1000 * changed).toISOString();
  return created.slice(0, 16).replace('T', ' ');
}

function verdict({digest, problem}) {
  if (problem) return 'not readable';
  if (!digest) return 'being read';
  if (digest.kind === 'study') return 'study';
  return digest.answer || 'none';
}

const of = (take) => (row) => (row.digest ? take(row.digest) : null);

export const nameOf = ({folder, name}) => (folder ? `${folder}/${name}` : name);
// The verdict's sentence, or what is wrong.
export const sentenceOf = ({digest, problem}) => problem || (digest && digest.text) || '';

export const columns = [
  {name: 'Name', text: true, of: nameOf},
  {name: 'Verdict', text: true, of: verdict},
  {name: 'Data', text: true, of: of((digest) => digest.data)},
  {name: 'Modes', of: of((digest) => digest.modes)},
  {name: 'Gain [nats/sample]', of: of(gain)},
  {name: 'Log score', of: of((digest) => number(digest.log_score))},
  {name: 'In the 95 % band', of: of((digest) => percent(digest.coverage_95))},
  {name: 'Date (UTC)', text: true, of: date},
];

// Two at most: a third takes the place of the first.
export function ticked(ids, id, on) {
  const others = ids.filter((each) => each !== id);
  return on ? [...others, id].slice(-2) : others;
}
