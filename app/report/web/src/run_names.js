// Names of runs: in the order that people count in, and short where they are long.

const most_letters = 36;

/** Compares two names: run_2 comes before run_10. */
export const naturally = (a, b) => String(a).localeCompare(String(b), 'en', {numeric: true});

/** Things with a name, in natural order. */
export const inNaturalOrder = (list) => [...list].sort((a, b) => naturally(a.name, b.name));

/** A name's end behind dots where it is long: names of recordings begin alike and differ at their end. */
export function shortName(name, most = most_letters) {
  const letters = [...name];
  return letters.length <= most ? name : `…${letters.slice(1 - most).join('')}`;
}
