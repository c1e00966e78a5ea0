// State that all time plots of a page share.
import {clock} from './signals.js';

const fewest_samples = 4;  // smallest number of visible samples

/**
 * @typedef {{refresh: () => Promise<unknown>, point?: () => void}} View a plot, which shows the state
 */

// Members:
// run;
// range: [from, to] in seconds, or null for the whole run;
// at: time of the crosshair or null.
// `changed` notifies views of all changes, `pointed` only of changes of the crosshair.
export class TimeState {
  constructor(runs) {
    this.runs = runs;
    this.run = Math.max(0, runs.findIndex((run) => run.role === 'test'));
    /** @type {[number, number]|null} */
    this.range = null;
    /** @type {number|null} */
    this.at = null;
    /** @type {View[]} */
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
  /** @returns {[number, number]} */
  whole() {
    const {start, end} = this.current.time;
    return end > start ? [start, end] : [start - 0.5, start + 0.5];
  }
  shown() {
    return this.range || this.whole();
  }
  changed() {
    return Promise.all(this.plots.map((plot) => plot.refresh()));
  }
  pointed() {
    for (const plot of this.plots) {
      if (plot.point) plot.point();
    }
  }
  select(run) {
    Object.assign(this, {run, range: null, at: null});
    return this.changed();
  }
  // Limits a range to the run.
  inside(range) {
    const [start, end] = this.whole(), samples = Math.max(1, this.current.time.samples);
    const least = Math.min(end - start, fewest_samples * (end - start) / samples);
    const asked = range[1] - range[0], width = Math.max(least, Math.min(end - start, asked));
    const begin = width === asked ? range[0] : (range[0] + range[1] - width) / 2;
    const from = Math.max(start, Math.min(end - width, begin));
    return width >= end - start ? null : /** @type {[number, number]} */ ([from, from + width]);
  }
  zoom(range) {
    this.range = this.inside(range);
    return this.changed();
  }
  move(share) {
    const [a, b] = this.shown(), by = share * (b - a);
    return this.zoom([a + by, b + by]);
  }
  // `about`: the time that stays at the same place on the screen.
  scale(factor, about = null) {
    const [a, b] = this.shown(), center = about === null ? (a + b) / 2 : about;
    return this.zoom([center - factor * (center - a), center + factor * (b - center)]);
  }
  showAll() {
    return this.zoom(this.whole());
  }
  // Moves the crosshair to the sample nearest to time t; null removes the crosshair.
  async point(t) {
    const clockOf = await this.clock();
    this.at = t === null ? null : clockOf.at(clockOf.near(t));
    this.pointed();
  }
}
