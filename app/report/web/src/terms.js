// What terms mean, in the words of help TERM.
import terms from '../terms.json';

const named = terms.flatMap(({term, also, means}) => [term, ...also].map((name) => [name.toLowerCase(), means]));
const meanings = new Map(/** @type {[string, string][]} */ (named));

// The meaning of a heading, whatever unit it has; null for words that need none.
export const meaningOf = (heading) => {
  const name = String(heading).toLowerCase();
  return meanings.get(name) || meanings.get(name.replace(/ \[[^\]]*\]$/, '')) || null;
};
