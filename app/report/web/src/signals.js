// The signals of runs in the detail that a plot can show (series.hpp): samples if few are visible, else extremes of
// buckets.
import {array} from './page_data.js';

// Index of the first sample at time t or later.
function indexIn(times, t) {
  let low = 0, high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < t) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

// The clock of a run at its finest level. It converts times to indices and indices to times.
export async function clock(axis) {
  if (axis.samples === 0) return {samples: 0, start: 0, end: 0, at: () => 0, near: () => 0};
  const {samples, start, end, period} = axis;
  if (period !== undefined) {
    const near = (t) => Math.max(0, Math.min(samples - 1, Math.round((t - start) / period)));
    return {samples, start, end, at: (k) => start + period * k, near};
  }
  const bucket = axis.finest, times = await array(bucket === 1 ? axis.raw : axis.levels[0].low);
  return {
    samples,
    start,
    end,
    at: (k) => times[Math.min(times.length - 1, Math.floor(k / bucket))],
    near: (t) => Math.min(samples - 1, bucket * indexIn(times, t))
  };
}

// The samples that a view of `range` shows, and the number of samples in a bucket of the drawing. A bucket is about a
// pixel wide. The number is a power of two. So each bucket consists of whole stored buckets, and does not change while
// the view moves. The drawing has one more bucket beyond each edge, so that lines continue to the edge.
export function view(clockOf, range, pixels) {
  const first = clockOf.near(range[0]), last = clockOf.near(range[1]);
  const per = 2 ** Math.max(0, Math.round(Math.log2((last - first + 1) / pixels)));
  return {first: Math.max(0, first - 2 * per), last: Math.min(clockOf.samples - 1, last + 2 * per), per};
}

// The coarsest stored level whose buckets are at most as large as the buckets of the drawing.
function levelFor(signal, per) {
  let best = signal.raw ? {bucket: 1, low: signal.raw, high: signal.raw} : null;
  for (const level of signal.levels) {
    if (level.bucket <= per || !best) best = level;
  }
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
// The smaller or the larger of two values. If one is NaN, the result is the other.
const lower = (a, b) => (a < b || Number.isNaN(b) ? a : b);
const higher = (a, b) => (a > b || Number.isNaN(b) ? a : b);

// How to compute the buckets of a view from a stored level. Each consists of `count` stored buckets; the first one
// starts at stored bucket `from`.
function grouping(level, shown) {
  const count = Math.max(1, Math.floor(shown.per / level.bucket)), per = level.bucket * count;
  return {count, per, from: Math.floor(shown.first / per) * count};
}

// Buckets of one signal in a view: {first, per, low, high}. Bucket i contains the `per` samples that start at sample
// first + i per. If per is 1, low and high are the samples.
async function buckets(signal, shown, edge) {
  const level = levelFor(signal, shown.per);
  const {count, per, from} = grouping(level, shown);
  const part = async (place, pick) => {
    const values = await array(place), to = Math.min(values.length, Math.ceil((shown.last + 1) / level.bucket));
    return count === 1 ? values.subarray(from, to) : merged(values, from, to, count, pick);
  };
  const low = edge === 'high' ? null : await part(level.low, lower);
  const high = edge === 'low' ? null : await part(level.high || level.low, higher);
  return {first: from * level.bucket, per, low, high};
}

// x and y of a line through a signal. A bucket gives two points: its extremes.
export async function line(signal, clockOf, shown) {
  const b = await buckets(signal, shown), n = b.low.length;
  if (b.per === 1) return {x: Float64Array.from({length: n}, (_, i) => clockOf.at(b.first + i)), y: b.low, per: 1};
  const x = new Float64Array(2 * n), y = new Float32Array(2 * n);
  for (let i = 0; i < n; ++i) {
    x[2 * i] = clockOf.at(b.first + i * b.per);
    x[2 * i + 1] = clockOf.at(Math.min(clockOf.samples - 1, b.first + i * b.per + b.per / 2));
    const rises = i === 0 || !(y[2 * i - 1] > b.high[i]);
    y[2 * i] = rises ? b.low[i] : b.high[i];
    y[2 * i + 1] = rises ? b.high[i] : b.low[i];
  }
  return {x, y, per: b.per};
}

// Means over groups of `count` values. Unknown values are ignored.
function means(values, from, to, count) {
  return Float32Array.from({length: Math.ceil((to - from) / count)}, (_, i) => {
    let sum = 0, known = 0;
    for (let k = from + i * count, end = Math.min(to, k + count); k < end; ++k) {
      if (Number.isNaN(values[k])) continue;
      sum += values[k];
      ++known;
    }
    return known ? sum / known : NaN;
  });
}

// Same as `line`, but with one mean per bucket. For shares.
export async function share(signal, clockOf, shown) {
  const level = levelFor(signal, shown.per), values = await array(level.low);
  const {count, per, from} = grouping(level, shown);
  const y = means(values, from, Math.min(values.length, Math.ceil((shown.last + 1) / level.bucket)), count);
  return {x: Float64Array.from(y, (_, i) => clockOf.at((from + i * count) * level.bucket)), y, per};
}

const few = 16;  // largest number of samples per bucket for which band edges are computed sample by sample

// For buckets of shown.per samples, the smallest and the largest edge of center +- half.
async function edgesOfSamples(center, half, shown) {
  const c = await array(center.raw), w = await array(half.raw), per = shown.per;
  const first = Math.floor(shown.first / per) * per, length = shown.last + 1 - first;
  const edge = (sign) => Float32Array.from({length}, (_, i) => c[first + i] + sign * w[first + i]);
  return {first, per, low: merged(edge(-1), 0, length, per, lower), high: merged(edge(1), 0, length, per, higher)};
}

async function edgesOfBuckets(lowest, highest, shown) {
  const {first, per, low} = await buckets({raw: null, levels: lowest.levels}, shown, 'low');
  const {high} = await buckets({raw: null, levels: highest.levels}, shown, 'high');
  return {first, per, low, high};
}

// A band from center - half to center + half. It consists of closed outlines, one for each part without gaps. The
// outline of buckets follows the smallest and the largest edge in each bucket.
export async function band({center, half, lowest, highest}, clockOf, shown) {
  const bySample = !lowest.levels.length || (center.raw && shown.per < few);
  const {first, per, low, high} = bySample ?
      await edgesOfSamples(center, half, {...shown, per: Math.min(shown.per, few - 1)}) :
      await edgesOfBuckets(lowest, highest, shown);
  const time = (i) => clockOf.at(Math.min(clockOf.samples - 1, first + i * per));
  if (per === 1) return outlines(low, high, time);
  const x = new Float64Array(2 * low.length), y = new Float32Array(2 * low.length);
  low.forEach((v, i) => {
    x.fill(time(i), 2 * i, 2 * i + 2);
    y[2 * i] = v;
    y[2 * i + 1] = high[i];
  });
  return {x, y, per};
}

function outlines(low, high, time) {
  const x = [], y = [];
  const known = (i) => !Number.isNaN(low[i]) && !Number.isNaN(high[i]);
  const put = (at, height) => {
    x.push(at);
    y.push(height);
  };
  for (let i = 0; i < low.length;) {
    if (!known(i)) {
      ++i;
      continue;
    }
    let end = i;
    while (end < low.length && known(end)) ++end;
    for (let k = i; k < end; ++k) put(time(k), high[k]);
    for (let k = end - 1; k >= i; --k) put(time(k), low[k]);
    put(null, null);
    i = end;
  }
  return {x, y};
}

// Two lines at +half and -half.
export async function bounds(half, clockOf, shown) {
  const up = await line(half, clockOf, shown);
  return {up, down: {...up, y: up.y.map((v) => -v)}};
}

/**
 * A signal at sample k: its value, or, where only extremes of buckets are stored, the smallest and the largest value in
 * its bucket.
 * @returns {Promise<{low: number, high: number}>}
 */
export async function valueAt(signal, k) {
  const level = signal.raw ? {bucket: 1, low: signal.raw, high: signal.raw} : signal.levels[0];
  const i = Math.floor(k / level.bucket), low = await array(level.low), high = await array(level.high || level.low);
  return {low: low[i], high: high[i]};
}
