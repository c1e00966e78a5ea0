import assert from 'node:assert/strict';
import {test} from 'node:test';

import {endOf, layoutOf, wrapped} from '../src/chart_layout.js';
import {pointAt} from '../src/chart_tip.js';

const measure = (text) => 10 * text.length;
const points = {
  kind: 'points',
  x: [0, 1, 2],
  y: [5, 6, 7],
  tip: (i) => `point ${i}`
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

test('the point next to the pointer tells what it is; far from all of them nothing does', () => {
  const {panels} = layoutOf({panels: [panel]}, 600), [{to}] = panels;
  assert.equal(pointAt(panels, to.x(1) + 5, to.y(6) - 5).i, 1);
  assert.equal(pointAt(panels, to.x(1), to.y(6) + 40), null);
});

test('a bar tells over its whole width, a cell where no point is near', () => {
  const bars = {kind: 'bars', x: [0.25, 0.75], y: [3, null], width: 0.5, tip: String};
  const grid = {kind: 'cells', x: [0, 1], y: [0, 1], colours: [['a', 'b'], ['c', 'd']], tip: String};
  const ofBars = layoutOf({panels: [{x: {range: [0, 1]}, y: {zero: true}, marks: [bars]}]}, 600).panels;
  assert.equal(pointAt(ofBars, ofBars[0].to.x(0.05), ofBars[0].to.y(2.5)).i, 0);
  assert.equal(pointAt(ofBars, ofBars[0].to.x(0.75), ofBars[0].to.y(1)), null);
  const cells = layoutOf({panels: [{x: {range: [-0.5, 1.5]}, y: {range: [-0.5, 1.5]}, marks: [grid]}]}, 600).panels;
  assert.equal(pointAt(cells, cells[0].to.x(0.9), cells[0].to.y(0.2)).i, 1);
  assert.equal(pointAt(cells, cells[0].to.x(-0.2), cells[0].to.y(1.2)).i, 2);
});

test('bars begin at zero and lie within the frame', () => {
  const bars = {kind: 'bars', x: [0, 1, 2], y: [4, 5, 6], width: 0.8};
  const [{across, up}] = layoutOf({panels: [{x: {}, y: {zero: true}, marks: [bars]}]}, 500).panels;
  assert.equal(up.range[0], 0);
  assert.ok(across.range[0] < -0.4 && across.range[1] > 2.4);
});
