// Names and order of the modes on a page with one bank. A page with several banks sets neither, so modes are plain
// numbers.
let names = [];
let ranks = [];
let hues = [];
let toldCount = Infinity;

/**
 * `list`: the name of each mode, '' where it has none; `order`: all modes, most used first, of which `told` are told
 * one by one.
 */
export function nameModes(list, order = [], told = Infinity) {
  names = list;
  ranks = [];
  hues = [];
  toldCount = told;
  const taken = new Map();  // how many modes have the label so far
  const labels = [];
  order.forEach((mode, rank) => {
    ranks[mode] = rank;
    const label = list[mode] || `mode ${mode}`, turn = taken.get(label) || 0;
    if (!turn) labels.push(label);
    hues[mode] = {hue: labels.indexOf(label), turn};
    taken.set(label, turn + 1);
  });
}

/** Number of modes with more use. */
export const rankOf = (k) => (ranks[k] === undefined ? k : ranks[k]);
/** Its hue, which modes of the same label share, and how many more used modes of that label there are. */
export const hueOf = (k) => hues[k] || {hue: rankOf(k), turn: 0};
/** Whether a mode is among the rarely used ones that are merged. */
export const isOther = (k) => rankOf(k) >= toldCount;

/** Text for a column of modes. */
export const modeCell = (k) => (names[k] ? `${k} ${names[k]}` : String(k));
/** Text for other places. */
export const modeTitle = (k) => (names[k] ? `mode ${k}: ${names[k]}` : `mode ${k}`);
