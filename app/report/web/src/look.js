// Colours of the page. Scripts pass colours of the palette unchanged. The drawing code makes them lighter on a dark
// background: shade() (colour.js) for elements and SVG, onCanvas() for a canvas.
import palette from '../palette.json';

import {hueColour, onGround, paletteColour, translucent} from './colour.js';
import {hueOf, isOther} from './mode_names.js';
import {dark} from './page.js';

export {palette, translucent};

/** The colour of text and of measurements. */
export const INK = 'var(--ink)';
const inkNow = () => (dark() ? '#e8eaee' : '#16181d');

/** A colour in the present theme. */
const onCanvas = (colour) => (colour === INK ? inkNow() : onGround(colour, dark()));

/** A trace or level of a time plot with its colour in the present theme, for a canvas. */
export const coloured = (it) => ({...it, colour: onCanvas(it.colour)});
export const canvasLook = () => ({
  ink: inkNow(),
  faint: dark() ? '#2c313a' : '#e4e7ec',
});

// Modes of one motion share a hue. The most used motions have the first hues of the palette. Rarely used motions are
// grey.
export function modeColour(k) {
  if (isOther(k)) return palette.unclustered;
  const {hue, turn} = hueOf(k);
  return hueColour(palette, hue, turn);
}
export const componentColour = (k) => paletteColour(palette, k);
export const filterColour = (name) => palette.filters[name] || INK;
