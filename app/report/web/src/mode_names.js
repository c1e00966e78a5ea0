// Names and order of the modes on a page with one bank. A page with several banks does not set them; its modes have
// numbers only.
let names = [];
let ranks = [];
let hues = [];
let toldCount = Infinity;

/**
 * `list`: the name of each mode, '' where it has none; `order`: all modes, those of the most used motion first, of
 * which `told` stand one by one; `motions`: {title, modes}, the most used first.
 */
export function nameModes(list, order = [], told = Infinity, motions = order.map((mode) => ({modes: [mode]}))) {
  names = list;
  ranks = [];
  hues = [];
  toldCount = told;
  order.forEach((mode, rank) => {
    ranks[mode] = rank;
  });
  motions.forEach((motion, hue) => motion.modes.forEach((mode, turn) => {
    hues[mode] = {hue, turn};
  }));
}

/** Number of modes with more use. */
export const rankOf = (k) => (ranks[k] === undefined ? k : ranks[k]);
/** Its hue, which modes of one motion share, and how many more used modes that motion has. */
export const hueOf = (k) => hues[k] || {hue: rankOf(k), turn: 0};
/** Whether a mode is among the rarely used ones that are merged. */
export const isOther = (k) => rankOf(k) >= toldCount;

/** Text for a column of modes. */
export const modeCell = (k) => (names[k] ? `${k} ${names[k]}` : String(k));
/** Text for other places. */
export const modeTitle = (k) => (names[k] ? `mode ${k}: ${names[k]}` : `mode ${k}`);
