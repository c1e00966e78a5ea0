import assert from 'node:assert/strict';
import {test} from 'node:test';

import {endOf, layoutOf, wrapped} from '../src/chart_layout.js';

const measure = (text) => 10 * text.length;
const points = {
  kind: 'points',
  x: [0, 1, 2],
  y: [5, 6, 7],
};
const panel = {
  x: {title: 'lag [samples]', whole: true},
  y: {title: 'score [nats]'},
  marks: [points]
};

// Whether texts centred at these places in a row do not overlap.
function clear(places, width) {
  return places.every((place, i) => i === 0 || Math.abs(place - places[i - 1]) >= width);
}

test('a long name keeps its end', () => {
  assert.equal(endOf('run_2', 50, measure), 'run_2');
  assert.equal(endOf('2024-01-05_field_run_12', 80, measure), '…_run_12');
  assert.deepEqual(wrapped('bank, held out: log score [nats]', 170, measure), ['bank, held out:', 'log score [nats]']);
  assert.deepEqual(wrapped('', 100, measure), ['']);
});

test('panels stand beside each other where the page is wide and below each other where it is not', () => {
  const drawing = {panels: [panel, panel, panel], height: 100, wide: 300};
  const wide = layoutOf(drawing, 1000), narrow = layoutOf(drawing, 360);
  assert.equal(new Set(wide.panels.map(({at}) => at.y)).size, 1);
  assert.equal(new Set(narrow.panels.map(({at}) => at.y)).size, 3);
  for (const {width, height, panels} of [wide, narrow]) {
    for (const {at} of panels) assert.ok(at.x > 0 && at.x + at.width <= width && at.y + at.height < height);
  }
  const [first, second] = wide.panels.map(({at}) => at);
  assert.ok(first.x + first.width < second.x);
});

test('ticks have room for their texts, and whole numbers only where asked for', () => {
  for (const width of [200, 360, 700, 1400]) {
    const [{ticks, to, up}] = layoutOf({panels: [panel], height: 150}, width).panels;
    assert.deepEqual(ticks.map(({at}) => Number.isInteger(at)), ticks.map(() => true));
    assert.ok(clear(ticks.map(({at}) => to.x(at)), 12));
    assert.ok(clear(up.ticks.map(({at}) => to.y(at)), 15));
  }
});

test('names of levels that have no room are tilted, cut at their beginning, and thinned', () => {
  const levels = Array.from({length: 40}, (_, k) => `a long name of a level ${k}`);
  const long = {...panel, x: {levels}};
  const [{ticks, tilt, to}] = layoutOf({panels: [long]}, 360).panels;
  assert.ok(tilt && ticks.length < 40);
  assert.ok(clear(ticks.map(({at}) => to.x(at)), 15));
  assert.ok(ticks.every(({at, text}) => text.startsWith('…') && text.endsWith(` ${at}`)));
  assert.equal(layoutOf({panels: [{...panel, x: {levels: ['a', 'b']}}]}, 360).panels[0].tilt, false);
});

test('bars begin at zero and lie within the frame', () => {
  const bars = {kind: 'bars', x: [0, 1, 2], y: [4, 5, 6], width: 0.8};
  const [{across, up}] = layoutOf({panels: [{x: {}, y: {zero: true}, marks: [bars]}]}, 500).panels;
  assert.equal(up.range[0], 0);
  assert.ok(across.range[0] < -0.4 && across.range[1] > 2.4);
});
