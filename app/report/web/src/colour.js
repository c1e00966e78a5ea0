// Functions for colours in the form '#rrggbb'.

const hex = (byte) => Math.round(byte).toString(16).padStart(2, '0');

// Mixture of two colours. `share`: share of the second colour.
export function mixed(colour, other, share) {
  const at = (text, i) => parseInt(text.slice(1 + 2 * i, 3 + 2 * i), 16);
  return '#' + [0, 1, 2].map((i) => hex((1 - share) * at(colour, i) + share * at(other, i))).join('');
}

export const translucent = (colour, alpha) => colour + hex(255 * alpha);

// The k-th colour. After the end of the palette the colours repeat: first darker, then lighter.
export function paletteColour(palette, k) {
  if (k < 0) return palette.unclustered;
  const base = palette.modes[k % palette.modes.length];
  const round = Math.floor(k / palette.modes.length) % 3;
  if (round === 0) return base;
  return mixed(base, round === 1 ? '#000000' : '#ffffff', 0.45);
}

// The colour of a mode. `rank`: position by use, 0 for the most used mode. After the end of the palette the colours
// look alike. C++ determines the ranks, and which modes are shown as "others" (used_modes, told_modes in
// app/text/mode_words.hpp). Pages and figures in papers use the same ranks.
export const usedColour = (palette, rank) => paletteColour(palette, rank < palette.modes.length ? rank : -1);

// Shades for the modes of one motion: towards black or white, and how strongly.
const turns = [
  [], ['#000000', 0.3], ['#ffffff', 0.4], ['#000000', 0.5], ['#ffffff', 0.6], ['#000000', 0.66], ['#ffffff', 0.75],
  ['#000000', 0.15]
];

/**
 * The colour of a mode that has `turn` more used ones of its motion before it; `hue`: the motion's place in the
 * palette.
 */
export function hueColour(palette, hue, turn) {
  const base = usedColour(palette, hue), [towards, share] = turns[turn % turns.length];
  return towards ? mixed(base, towards, share) : base;
}

/** A colour for canvas: lighter on a dark background. */
export function onGround(colour, dark) {
  if (!dark || !/^#[0-9a-f]{6}/i.test(colour)) return colour;
  return mixed(colour.slice(0, 7), '#ffffff', 0.35) + colour.slice(7);
}

/** The same in CSS, for any background: --own is the share of the colour itself (page.css). */
export const shade = (colour) =>
    (/^#[0-9a-f]{6}$/i.test(colour) ? `color-mix(in srgb, ${colour} var(--own), #fff)` : colour);
