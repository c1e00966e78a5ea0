// Plots over time that share one run and one stretch of time.
import { h } from './common.js';
import { figure, fingers, ink } from './plots.js';
import { clock, view } from './signals.js';

// What all time plots of a page show: {run, range: [from, to] in seconds, mark: [from, to] or null}. Changes reach every
// plot through `changed`.
export class TimeState {
  constructor(runs) {
    this.runs = runs;
    this.run = Math.max(0, runs.findIndex((run) => run.role === 'test'));
    this.range = null;
    this.mark = null;
    this.plots = [];
    this.clocks = new Map();
  }
  get current() { return this.runs[this.run]; }
  async clock() {
    if (!this.clocks.has(this.run)) this.clocks.set(this.run, await clock(this.current.time));
    return this.clocks.get(this.run);
  }
  whole() { const { start, end } = this.current.time; return end > start ? [start, end] : [start - 0.5, start + 0.5]; }
  shown() { return this.range || this.whole(); }
  changed(except) { return Promise.all(this.plots.filter((plot) => plot !== except).map((plot) => plot.refresh())); }
  select(run, range = null, mark = null) { Object.assign(this, { run, range, mark }); return this.changed(); }
  // Keeps a range inside the run.
  zoom(range, except) {
    const [start, end] = this.whole(), width = Math.min(end - start, range[1] - range[0]);
    const from = Math.max(start, Math.min(end - width, range[0]));
    this.range = width >= end - start ? null : [from, from + width];
    return this.changed(except);
  }
  move(share) { const [a, b] = this.shown(), by = share * (b - a); return this.zoom([a + by, b + by]); }
  scale(factor) { const [a, b] = this.shown(), middle = (a + b) / 2, half = factor * (b - a) / 2; return this.zoom([middle - half, middle + half]); }
}

// What a mouse does to a plot, for keys and screen readers.
export function timeControls(state) {
  const button = (text, label, act) => h('button', { type: 'button', 'aria-label': label, title: label, onclick: act }, text);
  return [button('◀', 'Earlier', () => state.move(-0.5)), button('▶', 'Later', () => state.move(0.5)),
    button('+', 'Zoom in', () => state.scale(0.5)), button('−', 'Zoom out', () => state.scale(2)),
    button('All', 'The whole run', () => { state.mark = null; return state.zoom(state.whole()); })];
}

// `rows`: {title, height, draw: async ({run, clock, shown}) => traces, axis: {...}, shapes: async () => []} one above the other;
// `rows` may be a function for plots whose rows change.
export function timePlot(state, label, rows, caption) {
  const rowsNow = () => (typeof rows === 'function' ? rows() : rows);
  const make = async () => {
    const list = rowsNow(), total = list.reduce((sum, row) => sum + row.height, 0), run = state.current;
    const gap = 26, below = 46, above = 30, height = total + gap * (list.length - 1) + below + above, inner = height - below - above;
    const clockOf = await state.clock(), range = state.shown(), shown = view(clockOf, range);
    const traces = [], layout = { height, margin: { l: window.innerWidth < 600 ? 62 : 82, r: 14, t: above, b: below }, showlegend: false, shapes: [], annotations: [],
      uirevision: `run ${state.run}`, dragmode: fingers() ? false : 'zoom', hovermode: 'closest' };
    let top = 1;
    for (let i = 0; i < list.length; ++i) {
      const row = list[i], n = i === 0 ? '' : i + 1, size = row.height / inner;
      for (const trace of await row.draw({ run, clock: clockOf, shown, range })) traces.push({ ...trace, xaxis: 'x', yaxis: `y${n}` });
      layout[`yaxis${n}`] = { title: { text: row.title, standoff: 6, font: { size: 11 } }, domain: [Math.max(0, top - size), top], zeroline: false, ...row.axis, uirevision: `run ${state.run}` };
      for (const shape of row.shapes ? row.shapes() : []) layout.shapes.push({ xref: 'paper', x0: 0, x1: 1, yref: `y${n}`, ...shape });
      top -= size + gap / inner;
    }
    layout.xaxis = { title: { text: 'time [s]', standoff: 4 }, range: [...range], anchor: `y${list.length > 1 ? list.length : ''}`, hoverformat: '.6~g', exponentformat: 'none', uirevision: range.join() };
    if (state.mark) {
      layout.shapes.push({ type: 'rect', xref: 'x', x0: state.mark[0], x1: state.mark[1], yref: 'paper', y0: 0, y1: 1, fillcolor: ink(), opacity: 0.12, line: { width: 0 }, layer: 'below' });
    }
    return { traces, layout };
  };
  const element = figure(label, make, caption);
  let busy = false, again = false;
  element.refresh = async () => {  // one redraw at a time, the last state wins
    if (busy) { again = true; return; }
    busy = true;
    do { again = false; await element.redraw(); } while (again);
    busy = false;
  };
  const drawFirst = element.redraw;
  element.redraw = async () => {
    const fresh = !element.plot.on;
    await drawFirst();
    if (!fresh) return;
    element.plot.on('plotly_relayout', (change) => {
      if (change['xaxis.autorange']) return state.zoom(state.whole());
      const from = change['xaxis.range[0]'] ?? change['xaxis.range']?.[0], to = change['xaxis.range[1]'] ?? change['xaxis.range']?.[1];
      if (from === undefined) return undefined;
      const same = state.range && Math.abs(state.range[0] - from) < 1e-9 && Math.abs(state.range[1] - to) < 1e-9;
      return same ? undefined : state.zoom([Number(from), Number(to)]);
    });
  };
  const refresh = element.refresh;
  element.refresh = () => (element.plot.on ? refresh() : Promise.resolve());  // not drawn yet: it will be as things are then
  state.plots.push(element);
  return element;
}
