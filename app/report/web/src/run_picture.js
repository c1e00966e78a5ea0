// A small picture of the data. It is drawn on a canvas, so that it appears early. It shows the first state in the
// colours of the most probable modes, the modes as a strip, and labels below.
import {endOf} from './chart_layout.js';
import {mixed} from './colour.js';
import {h, legend} from './elements.js';
import {roleNames} from './filters.js';
import {groundNow, INK, inkNow, modeColour, onCanvas, palette} from './look.js';
import {leadOf, rankOf} from './mode_names.js';
import {dark, onTheme} from './page.js';
import {segments, ticks} from './picture_layout.js';
import {inNaturalOrder} from './run_names.js';

const strip_px = 13, gap_px = 4, above_px = 18, left_px = 66, apart_px = 6;
const least_name_px = 40;  // smallest width of a run that shows its name; a name is cut to the width of its run
const least_px = 60;       // smallest width of a run that shows its times

// Labels are grey, so that they differ from modes. The share of ink is the same for the canvas and the legend.
const inkShare = (k, count) => 0.12 + (0.58 * k) / Math.max(1, count - 1);
const labelNow = (k, count) => mixed(groundNow(), inkNow(), inkShare(k, count));
const labelColour = (k, count) =>
    `color-mix(in srgb, var(--ink) ${(100 * inkShare(k, count)).toFixed(1)}%, var(--ground))`;

const titleOf = ({name, unit}) => (unit ? `${name} [${unit}]` : name);

// Positions on a canvas of this size. The width of each run is proportional to its number of samples.
function layoutOf(picture, width, height) {
  const strips = [picture.modes > 1 ? 'mode' : null, picture.labels.length ? 'label' : null].filter(Boolean);
  const total = picture.runs.reduce((sum, run) => sum + run.low.length, 0);
  const room = width - left_px - 8 - apart_px * (picture.runs.length - 1);
  const timed = picture.runs.some((run) => (room * run.low.length) / total > least_px);
  const below = timed ? 22 : 4, plot = height - above_px - below - strips.length * (strip_px + gap_px);
  let x = left_px;
  const places = picture.runs.map((run) => {
    const place = {run, x, width: (room * run.low.length) / total};
    x += place.width + apart_px;
    return place;
  });
  const top = (strip) => above_px + plot + gap_px + strips.indexOf(strip) * (strip_px + gap_px);
  return {plot, places, strips, top, bottom: height - below};
}

// Each family has the colour of its most used mode, because many shades would be confusing.
const familiesOver = (modes) => modes.map((k) => (k < 0 ? k : leadOf(k)));

// Height of a value, given as share of the range. A margin keeps both ends away from the frame.
const heightOf = (at, share) => above_px + at.plot * (0.98 - 0.96 * share);

function drawState(pen, picture, at, {run, x, width}) {
  const n = run.low.length, step = width / n, high = run.high || run.low;
  const y = (v) => heightOf(at, v / picture.steps);
  const list = run.mode ? familiesOver(run.mode) : run.low.map(() => -1);
  // The rarer modes are drawn last, so that frequent modes do not hide them.
  const modes = [...new Set(list)].sort((a, b) => rankOf(a) - rankOf(b));
  for (const mode of modes) {
    pen.beginPath();
    for (let i = 0; i < n; ++i) {
      if (list[i] !== mode || run.low[i] === null) continue;
      const middle = x + (i + 0.5) * step;
      const before = i > 0 && run.low[i - 1] !== null ? (run.low[i - 1] + high[i - 1]) / 2 : run.low[i];
      pen.moveTo(i > 0 ? middle - step : middle, y(before));
      pen.lineTo(middle, y(run.low[i]));
      pen.lineTo(middle, y(high[i]));
    }
    pen.strokeStyle = onCanvas(mode < 0 ? INK : modeColour(mode));
    pen.stroke();
  }
}

function drawStrip(pen, values, top, {x, width}, colour) {
  const step = width / values.length;
  for (const {from, to, value} of segments(values)) {
    if (value < 0) continue;
    pen.fillStyle = colour(value);
    pen.fillRect(x + from * step, top, (to - from) * step, strip_px);
  }
}

function drawNames(pen, picture, at) {
  const tint = dark() ? '#a9b0bc' : '#555c68';
  pen.fillStyle = tint;
  pen.font = '12px system-ui, "DejaVu Sans", sans-serif';
  pen.textAlign = 'right';
  pen.textBaseline = 'middle';
  for (const value of ticks(picture.range, 5)) {
    const share = (value - picture.range[0]) / (picture.range[1] - picture.range[0]);
    pen.fillText(String(value), left_px - 6, heightOf(at, share));
  }
  for (const strip of at.strips) {
    pen.fillText(strip === 'mode' ? 'mode' : 'known', left_px - 6, at.top(strip) + strip_px / 2);
  }
  pen.save();
  pen.translate(9, above_px + at.plot / 2);
  pen.rotate(-Math.PI / 2);
  pen.textAlign = 'center';
  pen.fillText(titleOf(picture.state), 0, 0, at.plot);
  pen.restore();
  pen.textAlign = 'left';
  for (const {run, x, width} of at.places) {
    const room = Math.max(width, least_name_px);
    pen.fillText(endOf(run.name, room, (text) => pen.measureText(text).width), x, 8, width);
    pen.textAlign = 'right';
    if (width > least_px) pen.fillText(`${Number(run.seconds.toPrecision(3))} s`, x + width, at.bottom + 12);
    pen.textAlign = 'left';
    if (width > least_px) pen.fillText('0', x, at.bottom + 12);
  }
}

function frame(pen, at) {
  pen.strokeStyle = dark() ? '#3a404b' : '#d5d9e0';
  pen.lineWidth = 1;
  for (const {x, width} of at.places) pen.strokeRect(x - 0.5, above_px - 0.5, width + 1, at.plot + 1);
}

function paint(canvas, picture) {
  const scale = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  canvas.width = Math.round(scale * width);
  canvas.height = Math.round(scale * height);
  const pen = canvas.getContext('2d');
  pen.scale(scale, scale);
  pen.clearRect(0, 0, width, height);
  const at = layoutOf(picture, width, height);
  frame(pen, at);
  pen.lineWidth = 1.4;
  pen.lineJoin = 'round';
  for (const place of at.places) {
    drawState(pen, picture, at, place);
    if (at.strips.includes('mode') && place.run.mode) {
      drawStrip(pen, familiesOver(place.run.mode), at.top('mode'), place, (k) => onCanvas(modeColour(k)));
    }
    if (place.run.label) {
      drawStrip(pen, place.run.label, at.top('label'), place, (k) => labelNow(k, picture.labels.length));
    }
  }
  drawNames(pen, picture, at);
}

// A description of the picture, for screen readers.
function described(picture, role) {
  const shown = picture.runs.length;
  const which = shown < picture.of_runs ? `${shown} of ${picture.of_runs} ${roleNames[role]}` : roleNames[role];
  const known = picture.labels.length ? '; beneath, what is known of them' : '';
  const coloured = picture.modes > 1 ? ', in the colour of the mode that is most probable' : '';
  return `${titleOf(picture.state)} over time [s], ${which}${coloured}${known}.`;
}

function key(picture, modes) {
  const told = modes && picture.modes > 1 ? modes.rows.map((row) => [modeColour(row.modes[0]), row.title]) : [];
  const others = told.length && modes.others ? [[palette.unclustered, 'others']] : [];
  const known = picture.labels.map((name, k) => [labelColour(k, picture.labels.length), `known: ${name}`]);
  return legend([...told, ...others, ...known], 'Colours of modes and labels');
}

/** Draws the picture of the verdict's section into `place`, again after each change of size or theme. */
export function drawPicture(place, {picture: given, role, modes}) {
  const picture = {...given, runs: inNaturalOrder(given.runs)};
  const text = described(picture, role);
  const canvas = h('canvas', {class: 'picture', role: 'img', 'aria-label': text});
  const caption = h('figcaption', {class: 'caption'});
  place.append(h('figure', {}, canvas, caption));
  const again = () => {
    paint(canvas, picture);
    caption.replaceChildren(key(picture, modes), text);
  };
  again();
  onTheme(again);
  new ResizeObserver(() => paint(canvas, picture)).observe(canvas);
}
