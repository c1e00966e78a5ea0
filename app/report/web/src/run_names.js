// Names of runs in natural order. Long names are shortened.

const most_letters = 36;

/** Compares two names: run_2 comes before run_10. */
export const naturally = (a, b) => String(a).localeCompare(String(b), 'en', {numeric: true});

/** Objects with a name, in natural order. */
export const inNaturalOrder = (list) => [...list].sort((a, b) => naturally(a.name, b.name));

/** The end of a long name, after dots: names of recordings begin alike and differ at their ends. */
export function shortName(name, most = most_letters) {
  const letters = [...name];
  return letters.length <= most ? name : `…${letters.slice(1 - most).join('')}`;
}
