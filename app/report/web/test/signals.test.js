import assert from 'node:assert/strict';
import {test} from 'node:test';

import {fromPlanes} from '../src/page_data.js';
import {band, clock, line, share, valueAt, view} from '../src/signals.js';

const period = 0.01;
const evenClock = (samples) => clock({samples, start: 0, end: (samples - 1) * period, period});

test('planes of bytes become numbers again; shares know what is unknown', () => {
  const bytes = new Uint8Array(Float64Array.of(1.5, -2e9, NaN).buffer), planes = new Uint8Array(24);
  bytes.forEach((byte, i) => {
    planes[(i % 8) * 3 + Math.floor(i / 8)] = byte;
  });
  assert.deepEqual(fromPlanes(planes, {type: 'f8', size: 3}), Float64Array.of(1.5, -2e9, NaN));
  const shares = fromPlanes(Uint8Array.of(0xfe, 0xff, 0, 0xff, 0xff, 0), {type: 'share', size: 3});
  assert.deepEqual(shares, Float32Array.of(1, NaN, 0));
});

test('an uneven clock finds the sample at or after a time', async () => {
  const times = Float64Array.of(0, 1, 4, 9),
        uneven = await clock({samples: 4, start: 0, end: 9, finest: 1, raw: times});
  assert.deepEqual([-1, 0, 0.5, 4, 4.1, 20].map(uneven.near), [0, 0, 1, 2, 3, 3]);
  assert.deepEqual([0, 3, 7].map(uneven.at), [0, 9, 9]);
});

test('few samples are drawn one by one, and two beyond both edges', async () => {
  const values = Float32Array.from({length: 1000}, (_, i) => i), even = await evenClock(1000);
  const shown = view(even, [4, 6], 800), drawn = await line({raw: values, levels: []}, even, shown);
  assert.equal(drawn.per, 1);
  assert.deepEqual([drawn.y[0], drawn.y[drawn.y.length - 1]], [398, 602]);
  assert.equal(drawn.x[0], 398 * period);
});

test('the buckets of a view that moves stay the same', async () => {
  const even = await evenClock(1e6), at = (from) => view(even, [from, from + 3000.004], 1000);
  const sizes = Array.from({length: 200}, (_, i) => at(17.3 * i).per);
  assert.deepEqual([...new Set(sizes)], [256]);
  assert.deepEqual(at(0).first, 0);
});

test('a value at a sample is itself, or the extremes of its bucket', async () => {
  const raw = Float32Array.of(1, 2, 3, 4), levels = [{bucket: 2, low: raw.subarray(0, 2), high: raw.subarray(2)}];
  assert.deepEqual(await valueAt({raw, levels}, 2), {low: 3, high: 3});
  assert.deepEqual(await valueAt({raw: null, levels}, 2), {low: 2, high: 4});
});

test('many samples are drawn by the extremes of their buckets, no peak lost, unknown ones aside', async () => {
  const n = 100000, even = await evenClock(n);
  const values = Float32Array.from({length: n}, (_, i) => (i % 10 === 0 ? NaN : Math.sin(i / 500)));
  values[54321] = 7;
  values[12345] = -7;
  const drawn = await line({raw: values, levels: []}, even, view(even, [0, (n - 1) * period], 800));
  const known = Array.from(drawn.y).filter((v) => !Number.isNaN(v));
  assert.ok(drawn.per > 1 && known.length < 2000 && known.length > 1500);
  assert.deepEqual([Math.min(...known), Math.max(...known)], [-7, 7]);
  assert.ok(drawn.x.every((x, i) => i === 0 || x >= drawn.x[i - 1]));
});

test('the coarsest stored level that is fine enough is read', async () => {
  const n = 64000, even = await evenClock(n), of = (length, v) => new Float32Array(length).fill(v);
  const levels =
      [[16, 1], [64, 2], [256, 3]].map(([bucket, v]) => ({bucket, low: of(n / bucket, v), high: of(n / bucket, v)}));
  const drawn = await line(
      {raw: of(n, 0), levels}, even, view(even, [0, (n - 1) * period], 1000));  // here a bucket has 64 samples
  assert.equal(drawn.y[0], 2);
  assert.equal(drawn.per, 64);
});

test('shares are means of what is known', async () => {
  const even = await evenClock(4),
        drawn = await share(
            {raw: null, levels: [{bucket: 1, low: Float32Array.of(0, 1, NaN, 0.5)}]}, even,
            {first: 0, last: 3, per: 2});
  assert.deepEqual(drawn.y, Float32Array.of(0.5, 0.5));
});

test('a band is closed around each stretch without gaps', async () => {
  const even = await evenClock(4), none = {levels: []};
  const edges = {center: {raw: Float32Array.of(1, 2, NaN, 4)}, half: {raw: Float32Array.of(1, 1, 1, 2)}};
  const drawn = await band({...edges, lowest: none, highest: none}, even, {first: 0, last: 3, per: 1});
  assert.deepEqual(drawn.y, [2, 3, 1, 0, null, 6, 2, null]);
  assert.deepEqual(drawn.x, [0, period, period, 0, null, 3 * period, 3 * period, null]);
});

test('by samples and by stored extremes a band is the same', async () => {
  const n = 64, even = await evenClock(n), bucket = 16;
  const center = Float32Array.from({length: n}, (_, i) => Math.cos(i)), half = new Float32Array(n).fill(0.5);
  const extreme = (pick, sign) => Float32Array.from(
      {length: n / bucket}, (_, b) => Math.fround(pick(...center.slice(b * bucket, (b + 1) * bucket)) + sign * 0.5));
  const edges = {
    center: {raw: center},
    half: {raw: half},
    lowest: {levels: [{bucket, low: extreme(Math.min, -1)}]},
    highest: {levels: [{bucket, low: extreme(Math.max, 1)}]},
  };
  const stored = await band(edges, even, {first: 0, last: n - 1, per: bucket});
  const whole = await band({...edges, lowest: {levels: []}}, even, {first: 0, last: n - 1, per: 8});
  assert.deepEqual([stored.x.length, stored.per, whole.x.length, whole.per], [2 * 4, 16, 2 * 8, 8]);
  const ends = (y) => [Math.min(...y), Math.max(...y)].map((v) => v.toFixed(5));
  assert.deepEqual(ends(stored.y), ends(whole.y));
});
