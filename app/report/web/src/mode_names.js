// What the page calls the modes of its bank; a page of several banks gives none, and their modes have numbers alone.
let names = [];

/** `list`: the name of each mode, '' where it has none. */
export function nameModes(list) {
  names = list;
}

/** In a column of modes. */
export const modeCell = (k) => (names[k] ? `${k} ${names[k]}` : String(k));
/** Anywhere else. For Plotly as plain(modeTitle(k)). */
export const modeTitle = (k) => (names[k] ? `mode ${k}: ${names[k]}` : `mode ${k}`);
