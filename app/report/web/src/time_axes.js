// Geometry of the panels of a time plot: inner area, scales and ticks.
import scaleLinear from 'd3-scale/src/linear.js';
import scaleLog from 'd3-scale/src/log.js';

const px_per_tick = {
  time: 90,
  value: 34
};

/**
 * @typedef {(value: number) => number} Position
 * @typedef {{to: Position, from: Position, ticks: {at: number, text: string}[], range: [number, number]}} Scale
 */

/** Margins of a panel. All panels of a page have the same, so that equal times are above each other. */
export const margins = (width) => ({left: width < 600 ? 46 : 64, right: 10});

/**
 * @param {[number, number]} range of the values from pixel `first` to `last`
 * @returns {Scale}
 */
export function linearScale(range, first, last, count) {
  const scale = scaleLinear().domain(range).range([first, last]), format = scale.tickFormat(count);
  const ticks = scale.ticks(count).map((at) => ({at, text: format(at).replace('-', '−')}));
  return {to: scale, from: scale.invert, ticks, range};
}

/** @returns {Scale} */
export function timeScale(range, width) {
  const {left, right} = margins(width);
  const count = Math.max(2, Math.floor((width - left - right) / px_per_tick.time));
  return linearScale(range, left, width - right, count);
}

const superscripts = '⁰¹²³⁴⁵⁶⁷⁸⁹';
const powerOfTen = (power) =>
    `10${power < 0 ? '⁻' : ''}${[...String(Math.abs(power))].map((d) => superscripts[Number(d)]).join('')}`;

/**
 * A scale with ticks at powers of ten, as many as fit.
 * @param {[number, number]} range
 * @returns {Scale}
 */
function logarithmic([low, high], top, bottom) {
  const lowest = low > 0 ? low : 1e-12;
  const scale = scaleLog().domain([lowest, Math.max(high, 10 * lowest)]).range([bottom, top]).clamp(true);
  const first = Math.ceil(Math.log10(lowest)), last = Math.floor(Math.log10(high));
  const step = Math.max(1, Math.ceil((last - first + 1) * px_per_tick.value / (bottom - top)));
  const ticks = [];
  for (let power = Math.ceil(first / step) * step; power <= last; power += step) {
    ticks.push({at: 10 ** power, text: powerOfTen(power)});
  }
  return {to: scale, from: scale.invert, ticks, range: [low, high]};
}

/**
 * A panel's scale of values, from its pixel `bottom` up to `top`.
 * @returns {Scale}
 */
export function valueScale(range, top, bottom, log = false) {
  if (log) return logarithmic(range, top, bottom);
  return linearScale(range, bottom, top, Math.max(2, Math.floor((bottom - top) / px_per_tick.value)));
}

/**
 * The range of all traces with a small margin; a constant gets a margin of its own.
 * @param {{y: ArrayLike<number|null>}[]} traces
 * @returns {[number, number]}
 */
export function extent(traces) {
  let low = Infinity, high = -Infinity;
  for (const {y} of traces) {
    for (let i = 0; i < y.length; ++i) {
      const v = y[i];
      if (v === null || Number.isNaN(v)) continue;
      if (v < low) low = v;
      if (v > high) high = v;
    }
  }
  if (low > high) return [0, 1];
  const room = high > low ? 0.05 * (high - low) : Math.abs(low) || 1;
  return [low - room, high + room];
}
