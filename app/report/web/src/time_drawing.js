// Draws one panel of a time plot with a pen.
import {extent, margins, timeScale, valueScale} from './time_axes.js';

/**
 * A curve: x and y of equal length; NaN or null leaves a gap. 'line': through the points; 'area': the inside of closed
 * outlines; 'shares': stacked on the shares before; 'dots': only points. `per`: samples per bucket. If `per` exceeds 1,
 * a line or band has two points per bucket, its extremes.
 * @typedef {{kind: 'line'|'area'|'shares'|'dots', x: ArrayLike<number|null>, y: ArrayLike<number|null>, colour: string,
 *   name: string, per?: number, width?: number, dash?: 'dash'|'dot', step?: boolean, symbol?: string, size?: number}}
 * Trace
 * @typedef {{traces: Trace[], range: [number, number]|null, log: boolean,
 *   levels: {height: number, colour: string}[]}} Content
 * @typedef {{width: number, height: number, last: boolean, range: [number, number]}} Frame
 * @typedef {{ink: string, faint: string}} Look
 */

export const axis_px = 34;  // height of the time axis below the last panel
const above = 6, below = 6;
const least_px = 0.05;  // smallest height that is drawn; a thinner share would be invisible

const known = (v) => v !== null && !Number.isNaN(v);

/** A line's path, broken at unknown values. @returns {import('./pens.js').Path} */
export function linePath({x, y, step}, toX, toY) {
  return (context) => {
    let last = NaN;
    for (let i = 0; i < y.length; ++i) {
      if (!known(y[i])) {
        last = NaN;
        continue;
      }
      const px = toX(x[i]), py = toY(y[i]);
      if (Number.isNaN(last)) {
        context.moveTo(px, py);
      } else {
        if (step) context.lineTo(px, last);
        context.lineTo(px, py);
      }
      last = py;
    }
  };
}

/** Rounded to whole pixels, so that neighbours neither overlap nor leave gaps. */
function pixelSpan(x, i, step, toX) {
  const left = Math.floor(toX(x[i])), next = i + step < x.length ? Math.floor(toX(x[i + step])) : left + 1;
  return [left, Math.max(1, next - left)];
}

/**
 * Buckets of a line or band as boxes about a pixel wide, from the smallest to the largest value. Boxes of a line touch
 * the previous one.
 * @returns {number[]} x, y, width and height of each box
 */
export function bucketBoxes({kind, x, y, width = 1}, toX, toY) {
  const boxes = [], half = kind === 'line' ? width / 2 : 0;
  let before = NaN;
  for (let i = 0; i < x.length; i += 2) {
    const a = toY(y[i]), b = toY(y[i + 1]), from = kind === 'line' && !Number.isNaN(before) ? before : a;
    before = b;
    if (!known(y[i])) continue;
    const [left, wide] = pixelSpan(x, i, 2, toX), top = Math.min(a, b, from) - half;
    boxes.push(left, top, wide, Math.max(a, b, from) + half - top);
  }
  return boxes;
}

/** A path of closed outlines. */
function outlinePath({x, y}, toX, toY) {
  return (context) => {
    let open = false;
    for (let i = 0; i < y.length; ++i) {
      if (!known(y[i])) {
        if (open) context.closePath();
        open = false;
        continue;
      }
      (open ? context.lineTo : context.moveTo).call(context, toX(x[i]), toY(y[i]));
      open = true;
    }
    if (open) context.closePath();
  };
}

/** The area between two sums of shares; unknown shares count as 0. */
function stackPath({x, step}, lower, upper, toX, toY) {
  return (context) => {
    const n = x.length;
    for (let i = 0; i < n; ++i) {
      if (step && i > 0) context.lineTo(toX(x[i]), toY(upper[i - 1]));
      (i ? context.lineTo : context.moveTo).call(context, toX(x[i]), toY(upper[i]));
    }
    for (let i = n - 1; i >= 0; --i) {
      context.lineTo(toX(x[i]), toY(lower[i]));
      if (step && i > 0) context.lineTo(toX(x[i]), toY(lower[i - 1]));
    }
    context.closePath();
  };
}

/** The same for buckets. */
function stackBoxes({x}, lower, upper, toX, toY) {
  const boxes = [];
  for (let i = 0; i < x.length; ++i) {
    const top = toY(upper[i]), bottom = toY(lower[i]);
    if (bottom - top < least_px) continue;
    const [left, wide] = pixelSpan(x, i, 1, toX);
    boxes.push(left, top, wide, bottom - top);
  }
  return boxes;
}

function drawShares(pen, traces, toX, toY) {
  let lower = null;
  for (const trace of traces) {
    if (!lower) lower = new Float32Array(trace.y.length);
    const upper = Float32Array.from(lower, (sum, i) => sum + (trace.y[i] || 0));
    if (trace.per > 1) {
      pen.boxes(stackBoxes(trace, lower, upper, toX, toY), trace.colour);
    } else {
      pen.area(stackPath(trace, lower, upper, toX, toY), trace.colour);
    }
    lower = upper;
  }
}

function drawDots(pen, trace, toX, toY) {
  const {x, y, size = 2, symbol} = trace;
  const path = (context) => {
    for (let i = 0; i < y.length; ++i) {
      if (!known(y[i])) continue;
      const px = toX(x[i]), py = toY(y[i]);
      context.moveTo(px + size, py);
      context.arc(px, py, size, 0, 2 * Math.PI);
    }
  };
  if (symbol === 'ring') {
    pen.line(path, {colour: trace.colour, width: 2});
  } else {
    pen.area(path, trace.colour);
  }
}

function drawTraces(pen, traces, toX, toY) {
  const shares = traces.filter(({kind}) => kind === 'shares');
  if (shares.length) drawShares(pen, shares, toX, toY);
  for (const trace of traces) {
    if (trace.kind === 'dots') {
      drawDots(pen, trace, toX, toY);
    } else if (trace.kind !== 'shares' && trace.per > 1) {
      pen.boxes(bucketBoxes(trace, toX, toY), trace.colour);
    } else if (trace.kind === 'area') {
      pen.area(outlinePath(trace, toX, toY), trace.colour);
    } else if (trace.kind === 'line') {
      pen.line(linePath(trace, toX, toY), trace);
    }
  }
}

const across = (from, to, y) => (context) => {
  context.moveTo(from, y);
  context.lineTo(to, y);
};
const down = (x, from, to) => (context) => {
  context.moveTo(x, from);
  context.lineTo(x, to);
};

function drawAxes(pen, frame, times, values, look) {
  const {left, right} = margins(frame.width), end = frame.width - right, floor = frame.height - below;
  for (const {at, text} of values.ticks) {
    const y = Math.round(values.to(at)) + 0.5;
    pen.line(across(left, end, y), {colour: look.faint});
    pen.text(text, left - 6, y + 4, {colour: look.ink, align: 'right'});
  }
  for (const {at, text} of times.ticks) {
    const x = Math.round(times.to(at)) + 0.5;
    pen.line(down(x, above, floor + (frame.last ? 4 : 0)), {colour: look.faint});
    if (frame.last) pen.text(text, x, floor + 16, {colour: look.ink, align: 'center'});
  }
  if (frame.last) pen.text('time [s]', (left + end) / 2, floor + 31, {colour: look.ink, align: 'center'});
}

/**
 * Draws a panel with its upper left corner at the origin.
 * @param {import('./pens.js').Pen} pen
 * @param {Frame} frame `height`: without the time axis below the last panel
 * @param {Content} content
 * @param {Look} look
 */
export function drawPanel(pen, frame, content, look) {
  const {left, right} = margins(frame.width), floor = frame.height - below;
  const times = timeScale(frame.range, frame.width);
  const values = valueScale(content.range || extent(content.traces), above, floor, content.log);
  const box = {x: left, y: above, width: frame.width - left - right, height: floor - above};
  drawAxes(pen, frame, times, values, look);
  pen.within(box, () => {
    drawTraces(pen, content.traces, times.to, values.to);
    for (const {height, colour} of content.levels) {
      pen.line(across(left, left + box.width, values.to(height)), {colour, width: 1.2, dash: 'dash'});
    }
  });
}
