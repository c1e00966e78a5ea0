// Runs' signals at the level of detail a plot can show (series.hpp): samples themselves where few enough are in view,
// else extremes over buckets. Everything is drawn half a view beyond both edges, so that panning shows data at once.
import { array } from './common.js';

const wanted = 800;  // buckets across a plot: about one per pixel pair

// Number of the first sample at or after time t.
function indexIn(times, t) {
  let low = 0, high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < t) low = middle + 1; else high = middle;
  }
  return low;
}

// The clock of a run: samples by time and times by sample, at its finest level.
export async function clock(axis) {
  if (axis.samples === 0) return { samples: 0, start: 0, end: 0, at: () => 0, near: () => 0 };
  if (axis.period !== undefined) {
    return { samples: axis.samples, start: axis.start, end: axis.end, at: (k) => axis.start + axis.period * k,
      near: (t) => Math.max(0, Math.min(axis.samples - 1, Math.round((t - axis.start) / axis.period))) };
  }
  const bucket = axis.finest, times = await array(bucket === 1 ? axis.raw : axis.levels[0].low);
  return { samples: axis.samples, start: axis.start, end: axis.end,
    at: (k) => times[Math.min(times.length - 1, Math.floor(k / bucket))],
    near: (t) => Math.min(axis.samples - 1, bucket * indexIn(times, t)) };
}

// Which samples a view of `range` shows and how many go into one bucket of the drawing.
export function view(clockOf, range) {
  const span = range[1] - range[0];
  const first = clockOf.near(range[0]), last = clockOf.near(range[1]);
  return { first: clockOf.near(range[0] - span / 2), last: clockOf.near(range[1] + span / 2), per: Math.max(1, Math.floor((last - first + 1) / wanted)) };
}

// The coarsest stored level whose buckets are not larger than the drawing's.
function levelFor(signal, per) {
  let best = signal.raw ? { bucket: 1, low: signal.raw, high: signal.raw } : null;
  for (const level of signal.levels) if (level.bucket <= per || !best) best = level;
  return best;
}

function merged(values, from, to, count, pick) {
  const result = new Float32Array(Math.ceil((to - from) / count));
  for (let i = from, j = 0; i < to; i += count, ++j) {
    let kept = NaN;
    for (let k = i, end = Math.min(to, i + count); k < end; ++k) kept = pick(kept, values[k]);
    result[j] = kept;
  }
  return result;
}
const lower = (a, b) => (a < b || b !== b ? a : b);
const higher = (a, b) => (a > b || b !== b ? a : b);

// Buckets of one signal in a view: {first, per, low, high}: bucket i holds samples first + i per ...; with per 1 low is
// high is the samples.
async function buckets(signal, shown, edge) {
  const level = levelFor(signal, shown.per);
  const count = Math.max(1, Math.floor(shown.per / level.bucket)), per = level.bucket * count;
  const from = Math.floor(shown.first / per) * count;
  const part = async (place, pick) => {
    const values = await array(place), to = Math.min(values.length, Math.ceil((shown.last + 1) / level.bucket));
    return count === 1 ? values.subarray(from, to) : merged(values, from, to, count, pick);
  };
  const low = edge === 'high' ? null : await part(level.low, lower), high = edge === 'low' ? null : await part(level.high || level.low, higher);
  return { first: from * level.bucket, per, low, high };
}

// x and y of a line through a signal; extremes of a bucket become two points.
export async function line(signal, clockOf, shown) {
  const b = await buckets(signal, shown), n = b.low.length;
  if (b.per === 1) return { x: Float64Array.from({ length: n }, (_, i) => clockOf.at(b.first + i)), y: b.low, per: 1 };
  const x = new Float64Array(2 * n), y = new Float32Array(2 * n);
  for (let i = 0; i < n; ++i) {
    x[2 * i] = clockOf.at(b.first + i * b.per);
    x[2 * i + 1] = clockOf.at(Math.min(clockOf.samples - 1, b.first + i * b.per + b.per / 2));
    const rises = i === 0 || !(y[2 * i - 1] > b.high[i]);
    y[2 * i] = rises ? b.low[i] : b.high[i];
    y[2 * i + 1] = rises ? b.high[i] : b.low[i];
  }
  return { x, y, per: b.per };
}

// The same for a mean per bucket: shares.
export async function share(signal, clockOf, shown) {
  const level = levelFor(signal, shown.per), values = await array(level.low);
  const count = Math.max(1, Math.floor(shown.per / level.bucket)), per = level.bucket * count;
  const from = Math.floor(shown.first / per) * count, to = Math.min(values.length, Math.ceil((shown.last + 1) / level.bucket));
  const n = Math.ceil((to - from) / count), x = new Float64Array(n), y = new Float32Array(n);
  for (let i = 0; i < n; ++i) {
    let sum = 0, known = 0;
    for (let k = from + i * count; k < Math.min(to, from + (i + 1) * count); ++k) if (values[k] === values[k]) { sum += values[k]; ++known; }
    x[i] = clockOf.at((from + i * count) * level.bucket);
    y[i] = known ? sum / known : NaN;
  }
  return { x, y, per };
}

// Closed outlines of a band, one per stretch without gaps: between center - half and center + half, or where samples are
// not drawn one by one between the lowest and the highest edge of each bucket.
export async function band(center, half, lowest, highest, clockOf, shown) {
  let low, high, first, per;
  const raw = center.raw && shown.per < 16;
  if (raw) {
    const c = await array(center.raw), w = await array(half.raw), count = shown.per;
    first = Math.floor(shown.first / count) * count; per = count;
    const edge = (sign) => Float32Array.from({ length: shown.last + 1 - first }, (_, i) => c[first + i] + sign * w[first + i]);
    low = merged(edge(-1), 0, shown.last + 1 - first, count, lower);
    high = merged(edge(1), 0, shown.last + 1 - first, count, higher);
  } else if (lowest.levels.length) {
    const b = await buckets({ raw: null, levels: lowest.levels }, shown, 'low');
    low = b.low; first = b.first; per = b.per;
    high = (await buckets({ raw: null, levels: highest.levels }, shown, 'high')).high;
  } else {
    return band(center, half, lowest, highest, clockOf, { ...shown, per: 15 });
  }
  return outlines(low, high, (i) => clockOf.at(Math.min(clockOf.samples - 1, first + i * per)));
}

function outlines(low, high, time) {
  const x = [], y = [];
  for (let i = 0; i < low.length;) {
    if (!(low[i] === low[i] && high[i] === high[i])) { ++i; continue; }
    let end = i;
    while (end < low.length && low[end] === low[end] && high[end] === high[end]) ++end;
    for (let k = i; k < end; ++k) { x.push(time(k)); y.push(high[k]); }
    for (let k = end - 1; k >= i; --k) { x.push(time(k)); y.push(low[k]); }
    x.push(null); y.push(null);
    i = end;
  }
  return { x, y };
}

// + and - a half width, for bounds about zero.
export async function bounds(half, clockOf, shown) {
  const up = await line(half, clockOf, shown);
  return { up, down: { x: up.x, y: up.y.map((v) => -v) } };
}
