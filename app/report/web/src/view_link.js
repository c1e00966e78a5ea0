// The part of a page's address that contains the view of its time plots:
// #view?run=...&from=...&to=...&at=...&filter=...

const prefix = '#view?';
const text = (seconds) => String(Number(seconds.toFixed(6)));

/**
 * @typedef {{run?: string, filter?: string, range?: [number, number]|null, at?: number|null}} View
 */

/** @param {View} view */
export function linkOf({run, filter, range, at}) {
  const words = new URLSearchParams();
  if (run !== undefined) words.set('run', run);
  if (filter) words.set('filter', filter);
  if (range) {
    words.set('from', text(range[0]));
    words.set('to', text(range[1]));
  }
  if (at !== null && at !== undefined) words.set('at', text(at));
  return prefix + words;
}

const number = (word) => (word === null || word.trim() === '' ? NaN : Number(word));

/** The view in an address; null if it has none. @returns {View|null} */
export function viewIn(hash) {
  if (!hash.startsWith(prefix)) return null;
  const words = new URLSearchParams(hash.slice(prefix.length)), view = {};
  if (words.has('run')) view.run = words.get('run');
  if (words.has('filter')) view.filter = words.get('filter');
  const from = number(words.get('from')), to = number(words.get('to')), at = number(words.get('at'));
  view.range = to > from && Number.isFinite(to - from) ? [from, to] : null;
  view.at = Number.isFinite(at) ? at : null;
  return view;
}
