// Panels over time, one above the other. Above each panel is the readout of its signals.
import {h, swatch} from './elements.js';
import {canvasLook, coloured} from './look.js';
import {rangeText, secondsText} from './number_text.js';
import {onTheme} from './page.js';
import {canvasPen} from './pens.js';
import {view} from './signals.js';
import {margins, timeScale} from './time_axes.js';
import {axis_px, drawPanel} from './time_drawing.js';
import {listenToPointer} from './time_gestures.js';
import {inTurn, whenNear} from './turns.js';

/** Resolves at the next frame, or at once in a hidden page, which has no frames. */
const nextFrame = () => new Promise((done) => (document.hidden ? done() : requestAnimationFrame(() => done())));

/** Calls `work` at most once per frame, with the last state. */
function oncePerFrame(work) {
  let wanted = false, running = null;
  const run = async () => {
    while (wanted) {
      await nextFrame();
      wanted = false;
      await work();
    }
    running = null;
  };
  return () => {
    wanted = true;
    running = running || run();
    return running;
  };
}

function entryItem({name, colour, unit, value, band}) {
  const item = h('li', {}, swatch(colour), name, ' ');
  if (value) {
    const {low, high} = value, exact = Number.isNaN(low) ? null : JSON.stringify(low === high ? low : [low, high]);
    item.append(h('span', {class: band ? 'number wide' : 'number', 'data-value': exact}, rangeText(value, unit)));
  }
  return item;
}

class TimePlot {
  constructor(state, label, rows) {
    this.state = state;
    this.rows = rows;
    this.panels = [];
    this.crosshair = h('div', {class: 'crosshair', hidden: true});
    this.chosen = h('div', {class: 'chosen-span', hidden: true});
    this.time = h('p', {class: 'soft crosshair-time'}, 'Point at the plot to read its signals.');
    this.plot = h('div', {class: 'plot timeplot', role: 'group', 'aria-label': label}, this.crosshair, this.chosen);
    this.drawn = false;
    this.said = '';  // last readout, to detect changes
    this.saidIn = null;
  }

  // Makes a heading with a readout and a canvas for each row. They are made again only if the rows have changed.
  fit(rows) {
    const same = rows.length === this.panels.length && rows.every((row, i) => row.title === this.panels[i].title);
    if (same) return;
    this.panels = rows.map((row) => {
      const readout = h('ul', {class: 'readout', 'aria-label': row.title}),
            canvas = h('canvas', {'aria-hidden': 'true'});
      return {
        title: row.title,
        readout,
        canvas,
        head: h('div', {class: 'panel-head'}, h('span', {class: 'panel-title'}, row.title), readout)
      };
    });
    this.plot.replaceChildren(...this.panels.flatMap(({head, canvas}) => [head, canvas]), this.crosshair, this.chosen);
  }

  // Content of the rows for a plot of `width` pixels.
  async contents(rows, width) {
    const {state} = this, range = state.shown(), clock = await state.clock(), {left, right} = margins(width);
    const seen = {run: state.current, clock, shown: view(clock, range, width - left - right), range};
    const all = await Promise.all(rows.map(async (row) => ({
                                             traces: (await row.draw(seen)).map(coloured),
                                             range: row.range || null,
                                             log: Boolean(row.log),
                                             levels: (row.levels ? row.levels() : []).map(coloured),
                                           })));
    const frame = (i) => ({width, height: rows[i].height, last: i === rows.length - 1, range});
    return all.map((content, i) => ({content, frame: frame(i)}));
  }

  async draw() {
    const rows = this.rows(), width = this.plot.clientWidth;
    if (!width) return;
    const parts = await this.contents(rows, width), colours = canvasLook();
    this.fit(rows);
    parts.forEach(({content, frame}, i) => this.paint(this.panels[i].canvas, content, frame, colours));
    this.range = this.state.shown();
    this.drawn = true;
    this.plot.dataset.drawn = 'true';
    this.showCrosshair();
    await this.read();
  }

  paint(canvas, content, frame, colours) {
    const ratio = window.devicePixelRatio || 1, height = frame.height + (frame.last ? axis_px : 0);
    const size = [Math.round(frame.width * ratio), Math.round(height * ratio)];
    if (canvas.width !== size[0]) [canvas.width] = size;
    if (canvas.height !== size[1]) [, canvas.height] = size;
    const context = canvas.getContext('2d');
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, frame.width, height);
    drawPanel(canvasPen(context), frame, content, colours);
  }

  scale() {
    return timeScale(this.state.shown(), this.plot.clientWidth);
  }

  showCrosshair() {
    const {at} = this.state, [from, to] = this.state.shown(), hidden = at === null || at < from || at > to;
    this.crosshair.hidden = hidden;
    if (!hidden) this.crosshair.style.left = `${this.scale().to(at)}px`;
  }

  // Writes the readout: the value of every signal at the crosshair. Without a crosshair it has only names.
  async read() {
    const {at, current} = this.state, clock = await this.state.clock(), k = at === null ? -1 : clock.near(at);
    const rows = this.rows();
    const entries = await Promise.all(rows.map((row) => row.read(current, k)));
    if (rows.length !== this.panels.length) return;
    // Writes only changes. Otherwise every frame of a drag would cause a new layout of the page.
    const said = JSON.stringify([at, k, entries]);
    if (said === this.said && this.panels === this.saidIn) return;
    Object.assign(this, {said, saidIn: this.panels});
    entries.forEach((list, i) => this.panels[i].readout.replaceChildren(...list.map(entryItem)));
    this.time.textContent =
        at === null ? 'Point at the plot to read its signals.' : `Crosshair at ${secondsText(at)}, sample ${k}.`;
  }

  choose(span) {
    this.chosen.hidden = !span;
    if (!span) return;
    const {left} = this.plot.getBoundingClientRect();
    this.chosen.style.left = `${Math.min(...span) - left}px`;
    this.chosen.style.width = `${Math.abs(span[1] - span[0])}px`;
  }
}

// `rows()`: the rows of time_rows.js, from top to bottom.
export function timePlot(state, label, rows, caption) {
  const it = new TimePlot(state, label, rows), {plot} = it;
  const element = h('figure', {}, plot, it.time, caption ? h('figcaption', {class: 'caption'}, caption) : null);
  const redraw = oncePerFrame(() => it.draw()), read = oncePerFrame(() => it.read());
  element.plot = plot;
  plot.timePlot = it;
  element.ready = new Promise((resolve, reject) => {
    element.begin = () => {
      ignore();
      element.begin = () => {};
      inTurn(() => it.draw().then(resolve, (error) => {
        plot.dataset.failed = 'true';
        reject(error);
      }));
    };
    plot.style.minHeight = '200px';
    const ignore = whenNear(plot, () => element.begin());
  });
  element.refresh = () => (it.drawn ? redraw() : Promise.resolve());
  element.point = () => {
    if (!it.drawn) return;
    it.showCrosshair();
    read();
  };
  listenToPointer(plot, state, {
    time: (x) => it.scale().from(x - plot.getBoundingClientRect().left),
    choose: (span) => it.choose(span),
  });
  new ResizeObserver(() => element.refresh()).observe(plot);
  onTheme(() => (it.drawn ? it.draw() : undefined));
  state.plots.push(element);
  return element;
}
