import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {test} from 'node:test';

import {hueColour, mixed, onGround, paletteColour, shade, translucent, usedColour} from '../src/colour.js';

const palette = JSON.parse(readFileSync(new URL('../palette.json', import.meta.url), 'utf8'));

test('colours mix channel by channel', () => {
  assert.equal(mixed('#000000', '#ffffff', 0.5), '#808080');  // 127.5 rounds up
  assert.equal(mixed('#102030', '#ffffff', 0), '#102030');
  assert.equal(mixed('#102030', '#ff00ff', 1), '#ff00ff');
  assert.equal(mixed('#6496c8', '#000000', 0.25), '#4b7196');  // 3/4 of 100, 150, 200: 75, 112.5, 150
});

test('the palette comes again darker, then lighter, then as it was', () => {
  const n = palette.modes.length;
  assert.equal(paletteColour(palette, -1), palette.unclustered);
  assert.equal(paletteColour(palette, n - 1), palette.modes[n - 1]);
  assert.equal(paletteColour(palette, n), mixed(palette.modes[0], '#000000', 0.45));
  assert.equal(paletteColour(palette, 2 * n), mixed(palette.modes[0], '#ffffff', 0.45));
  assert.equal(paletteColour(palette, 3 * n), palette.modes[0]);
  const first = Array.from({length: 3 * n}, (_, k) => paletteColour(palette, k));
  assert.equal(new Set(first).size, 3 * n);
});

test('opacity is the last byte; colours are lighter on a dark ground', () => {
  assert.equal(translucent('#123456', 0.2), '#12345633');
  assert.equal(onGround('#000000', false), '#000000');
  assert.equal(onGround('#000000', true), '#595959');  // 0.35 * 255 = 89.25
  assert.equal(onGround('#00000054', true), '#59595954');
  assert.equal(onGround('red', true), 'red');
  assert.equal(shade('#123456'), 'color-mix(in srgb, #123456 var(--own), #fff)');
  assert.equal(shade('var(--ink)'), 'var(--ink)');
});

test('the eight most used modes have a colour of their own, the others one together', () => {
  const ranks = Array.from({length: 8}, (_, rank) => usedColour(palette, rank));
  assert.equal(new Set(ranks).size, 8);
  assert.equal(ranks[0], palette.modes[0]);
  assert.equal(usedColour(palette, 8), palette.unclustered);
  assert.equal(usedColour(palette, 54), palette.unclustered);
});

test('eight modes of one label have eight colours, the most used one the label’s own', () => {
  for (let hue = 0; hue < 8; ++hue) {
    const colours = Array.from({length: 8}, (_, turn) => hueColour(palette, hue, turn));
    assert.equal(colours[0], palette.modes[hue]);
    assert.equal(new Set(colours).size, 8);
  }
});
