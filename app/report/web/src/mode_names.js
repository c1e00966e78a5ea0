// What the page calls the modes of its bank, and which of them come first; a page of several banks says neither, and
// their modes have numbers alone.
let names = [];
let ranks = [];

/** `list`: the name of each mode, '' where it has none; `order`: all modes, most used first. */
export function nameModes(list, order = []) {
  names = list;
  ranks = [];
  order.forEach((mode, rank) => {
    ranks[mode] = rank;
  });
}

/** How many modes are used more. */
export const rankOf = (k) => (ranks[k] === undefined ? k : ranks[k]);

/** In a column of modes. */
export const modeCell = (k) => (names[k] ? `${k} ${names[k]}` : String(k));
/** Anywhere else. For Plotly as plain(modeTitle(k)). */
export const modeTitle = (k) => (names[k] ? `mode ${k}: ${names[k]}` : `mode ${k}`);
