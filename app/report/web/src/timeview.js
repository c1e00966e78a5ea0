// Plots over time that share one run and one stretch of time.
import {choice, h} from './elements.js';
import {roleOf} from './filters.js';
import {figure, fingers, greyBand, onFirstDrawing} from './plots.js';
import {clock, view} from './signals.js';

// What all time plots of a page show: {run, range: [from, to] in seconds, mark: [from, to] or null}. Changes reach
// every plot through `changed`.
export class TimeState {
  constructor(runs) {
    this.runs = runs;
    this.run = Math.max(0, runs.findIndex((run) => run.role === 'test'));
    this.range = null;
    this.mark = null;
    this.plots = [];
    this.clocks = new Map();
  }
  get current() {
    return this.runs[this.run];
  }
  async clock() {
    if (!this.clocks.has(this.run)) this.clocks.set(this.run, await clock(this.current.time));
    return this.clocks.get(this.run);
  }
  whole() {
    const {start, end} = this.current.time;
    return end > start ? [start, end] : [start - 0.5, start + 0.5];
  }
  shown() {
    return this.range || this.whole();
  }
  changed(except) {
    return Promise.all(this.plots.filter((plot) => plot !== except).map((plot) => plot.refresh()));
  }
  select(run, range = null, mark = null) {
    Object.assign(this, {run, range, mark});
    return this.changed();
  }
  // Keeps a range inside the run.
  zoom(range, except) {
    const [start, end] = this.whole(), width = Math.min(end - start, range[1] - range[0]);
    const from = Math.max(start, Math.min(end - width, range[0]));
    this.range = width >= end - start ? null : [from, from + width];
    return this.changed(except);
  }
  move(share) {
    const [a, b] = this.shown(), by = share * (b - a);
    return this.zoom([a + by, b + by]);
  }
  scale(factor) {
    const [a, b] = this.shown(), middle = (a + b) / 2, half = (factor * (b - a)) / 2;
    return this.zoom([middle - half, middle + half]);
  }
  showAll() {
    this.mark = null;
    return this.zoom(this.whole());
  }
  isShown([from, to]) {
    const same = (a, b) => Math.abs(a - b) < 1e-9;
    return this.range !== null && same(this.range[0], from) && same(this.range[1], to);
  }
}

// What a mouse does to a plot, for keys and screen readers.
export function timeControls(state) {
  const button = (text, label, act) =>
      h('button', {type: 'button', 'aria-label': label, title: label, onclick: act}, text);
  return [
    button('◀', 'Earlier', () => state.move(-0.5)),
    button('▶', 'Later', () => state.move(0.5)),
    button('+', 'Zoom in', () => state.scale(0.5)),
    button('−', 'Zoom out', () => state.scale(2)),
    button('All', 'The whole run', () => state.showAll()),
  ];
}

// A drop-down of the runs.
export function runChoice(state) {
  return choice('Run', state.runs.map((run) => `${run.name} (${roleOf(run.role)})`), state.run, (i) => state.select(i));
}

const gap = 26, below = 46, above = 30;  // pixels between, below and above the rows

const timeAxis = (range, last) => ({
  title: {text: 'time [s]', standoff: 4},
  range: [...range],
  anchor: `y${last > 1 ? last : ''}`,
  hoverformat: '.6~g',
  exponentformat: 'none',
  uirevision: range.join(),
});

// What Plotly draws of the rows, one above the other.
async function rowsDrawing(state, rows) {
  const inner = rows.reduce((sum, row) => sum + row.height, 0) + gap * (rows.length - 1),
        uirevision = `run ${state.run}`;
  const margin = {l: window.innerWidth < 600 ? 62 : 82, r: 14, t: above, b: below};
  const layout = {
    height: inner + below + above,
    margin,
    showlegend: false,
    shapes: [],
    annotations: [],
    uirevision,
    dragmode: fingers() ? false : 'zoom',
    hovermode: 'closest',
  };
  const traces = [], run = state.current, clockOf = await state.clock(), range = state.shown();
  const seen = {run, clock: clockOf, shown: view(clockOf, range), range};
  let top = 1;
  for (const [i, row] of rows.entries()) {
    const n = i === 0 ? '' : i + 1, size = row.height / inner;
    for (const trace of await row.draw(seen)) traces.push({...trace, xaxis: 'x', yaxis: `y${n}`});
    const title = {text: row.title, standoff: 6, font: {size: 11}};
    layout[`yaxis${n}`] = {title, domain: [Math.max(0, top - size), top], zeroline: false, ...row.axis, uirevision};
    for (const shape of row.shapes ? row.shapes() : []) {
      layout.shapes.push({xref: 'paper', x0: 0, x1: 1, ...shape, yref: `y${n}`});
    }
    top -= size + gap / inner;
  }
  layout.xaxis = timeAxis(range, rows.length);
  if (state.mark) {
    const [x0, x1] = state.mark;
    layout.shapes.push(greyBand(0, 1, {xref: 'x', x0, x1, yref: 'paper', layer: 'below'}));
  }
  return {traces, layout};
}

// Zooming in one plot zooms them all.
function followZoom(plot, state) {
  plot.on('plotly_relayout', (change) => {
    if (change['xaxis.autorange']) return state.zoom(state.whole());
    const [from, to] = change['xaxis.range'] || [change['xaxis.range[0]'], change['xaxis.range[1]']];
    if (from === undefined || state.isShown([from, to])) return undefined;
    return state.zoom([Number(from), Number(to)]);
  });
}

// `rows()`: {title, height, draw: async ({run, clock, shown, range}) => traces, axis: {...}, shapes: () => []} one
// above the other.
export function timePlot(state, label, rows, caption) {
  const element = figure(label, () => rowsDrawing(state, rows()), caption);
  onFirstDrawing(element, () => followZoom(element.plot, state));
  let busy = false, again = false;
  element.refresh = async () => {  // one redraw at a time, the last state wins
    again = true;
    if (busy) return;
    busy = true;
    while (again) {
      again = false;
      await element.update();
    }
    busy = false;
  };
  state.plots.push(element);
  return element;
}
