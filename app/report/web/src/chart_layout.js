// Positions of a chart's panels, with their scales and ticks.
import {extent, linearScale} from './time_axes.js';

export const text_px = 12, line_px = 15;
const gap_px = 14, right_px = 10, top_px = 8, tick_px = 6;
const tilted = Math.sin(Math.PI / 4);

let pen = null;
/** The width of a text on the page. */
function textWidth(text) {
  if (typeof document === 'undefined') return 6.5 * text.length;
  if (!pen) {
    pen = document.createElement('canvas').getContext('2d');
    pen.font = `${text_px}px system-ui, "Segoe UI", "DejaVu Sans", sans-serif`;
  }
  return pen.measureText(text).width;
}

/** The end of a text wider than `most` pixels, after dots. Names differ at their ends. */
export function endOf(text, most, measure = textWidth) {
  if (measure(text) <= most) return text;
  let kept = text.slice(1);
  while (kept.length > 1 && measure(`…${kept}`) > most) kept = kept.slice(1);
  return `…${kept}`;
}

/** The lines of a text, of at most `most` pixels, broken between words. */
export function wrapped(text, most, measure = textWidth) {
  const lines = [];
  for (const word of text.split(' ')) {
    const last = lines.length - 1;
    if (last >= 0 && measure(`${lines[last]} ${word}`) <= most) {
      lines[last] += ` ${word}`;
    } else {
      lines.push(word);
    }
  }
  return lines.map((line) => endOf(line, most, measure));
}

// The range of all marks of a panel along one axis.
function reachOf(panel, key) {
  const axis = panel[key];
  if (axis.range) return axis.range;
  if (axis.levels) return [-0.5, axis.levels.length - 0.5];
  const lists = panel.marks.flatMap((mark) => {
    const values = mark[key] === undefined ? [] : [{y: typeof mark[key] === 'number' ? [mark[key]] : mark[key]}];
    const half = mark.kind === 'bars' && key === 'x' ? mark.width / 2 : 0;
    const sides = half ? [-half, half].map((by) => ({y: mark.x.map((v) => v + by)})) : [];
    const heights = mark.kind === 'band' && key === 'y' ? [{y: [mark.low, mark.high]}] : [];
    return [...values, ...sides, ...heights];
  });
  const [low, high] = extent(lists);
  return axis.zero ? [0, high] : [low, high];
}

const wholeTick = ({at}) => ({at, text: String(at)});

/**
 * An axis from pixel `first` to `last`: its scale, one tick for each `room` pixels, and the size of the texts.
 * @param {import('./chart.js').Axis} axis
 */
function scaleOf(axis, range, first, last, room, need) {
  const length = Math.abs(last - first);
  if (axis.levels) {
    const scale = linearScale(range, first, last, 2);
    return {...scale, ticks: axis.levels.map((text, at) => ({at, text})), slot: length / axis.levels.length};
  }
  for (let count = Math.max(2, Math.floor(length / room));; --count) {
    const scale = linearScale(range, first, last, count);
    const ticks = axis.whole ? scale.ticks.filter(({at}) => Number.isInteger(at)).map(wholeTick) : scale.ticks;
    const apart = ticks.length > 1 ? Math.abs(scale.to(ticks[1].at) - scale.to(ticks[0].at)) : Infinity;
    if (count <= 2 || need(ticks.map(({text}) => text)) <= apart) return {...scale, ticks, slot: apart};
  }
}

const widest = (texts) => Math.max(0, ...texts.map((text) => textWidth(text)));

// If the names of levels do not fit side by side, they are tilted, and long names are cut.
function acrossTicks(axis, scale) {
  const texts = scale.ticks.map(({text}) => text);
  if (!axis.levels || widest(texts) + 8 <= scale.slot) return {ticks: scale.ticks, tilt: false, deep: line_px};
  const short = texts.map((text) => endOf(text, 110)), every = Math.ceil(line_px / scale.slot);
  const ticks = scale.ticks.map(({at}, i) => ({at, text: short[i]})).filter((_, i) => i % every === 0);
  return {ticks, tilt: true, deep: widest(short) * tilted + line_px};
}

/**
 * @param {import('./chart.js').Drawing} drawing
 * width of its place on the page
 */
export function layoutOf(drawing, width) {
  const {panels, height = 250, wide = width} = drawing;
  const columns = Math.max(1, Math.min(panels.length, Math.floor(width / wide)));
  const place = (width - gap_px * (columns - 1)) / columns;
  const ranges = panels.map((panel) => [reachOf(panel, 'x'), reachOf(panel, 'y')]);
  const ups = panels.map((panel, i) => scaleOf(panel.y, ranges[i][1], height, 0, 38, () => 24));
  const titles = panels.map(({y}) => wrapped(y.title || '', height));
  const sides = panels.map((_, i) => titles[i].length * line_px + widest(ups[i].ticks.map(({text}) => text)));
  const left = Math.max(...sides) + tick_px + 6, inside = place - left - right_px;
  let top = 0, total = 0;
  const boxes = panels.map((panel, i) => {
    const across = scaleOf(panel.x, ranges[i][0], 0, inside, 64, (texts) => widest(texts) + 12);
    return {panel, across, ...acrossTicks(panel.x, across), titles: wrapped(panel.x.title || '', inside)};
  });
  const placed = boxes.map((box, i) => {
    const column = i % columns, row = boxes.slice(i - column, i - column + columns);
    if (column === 0) top = total;
    const above = row.some(({panel}) => panel.title) ? line_px + top_px : top_px;
    const below = Math.max(...row.map(({deep, titles: lines}) => deep + line_px * lines.length)) + tick_px + 6;
    total = top + above + height + below;
    const at = {x: column * (place + gap_px) + left, y: top + above, width: inside, height};
    return {
      ...box,
      up: ups[i],
      side: titles[i],
      left,
      at,
      to: {
        x: (v) => at.x + box.across.to(v),
        y: (v) => at.y + ups[i].to(v),
      }
    };
  });
  return {width, height: total, panels: placed};
}
