// Plotly as the report uses it: one theme, one palette, text that stays text. Written for plotly.js 2.6.
import palette from '../palette.json';

import {onGround, paletteColour, translucent, usedColour} from './colour.js';
import {blobOf, downloads} from './downloads.js';
import {h} from './elements.js';
import {isOther, rankOf} from './mode_names.js';
import {beforePrint, dark, onTheme} from './page.js';
import {runPacked} from './page_data.js';
import {keepWhenPrinted} from './printing.js';

export {palette, translucent};

// Plotly reads <b>, <a> and &entities; in texts: what comes from an archive must not be read so.
export const plain = (text) => String(text).replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/>/g, '&gt;');
// A channel or parameter as an axis names it.
export const axisTitle = ({name, unit}) => plain(unit ? `${name} [${unit}]` : name);

export const ink = () => (dark() ? '#e8eaee' : '#16181d');
const faint = () => (dark() ? '#343a45' : '#dfe3e8');
export const ground = () => (dark() ? '#14161a' : '#ffffff');
// A mode's colour is by its use, so that the modes that matter differ; the ninth and later ones are "others".
export const rankColour = (rank) => usedColour(palette, rank);
export const modeColour = (k) => rankColour(isOther(k) ? Infinity : rankOf(k));
export const componentColour = (k) => paletteColour(palette, k);
export const lineColour = (colour) => onGround(colour, dark());
export const filterColour = (name) => lineColour(palette.filters[name] || ink());

// Grey ground of a plot between two heights, over its whole width, and a dashed line across it.
export const greyBand = (low, high, more) => ({
  type: 'rect',
  xref: 'paper',
  x0: 0,
  x1: 1,
  y0: low,
  y1: high,
  fillcolor: ink(),
  opacity: 0.14,
  line: {width: 0},
  ...more,
});
export const dashedLine = (height, more) => ({
  type: 'line',
  xref: 'paper',
  x0: 0,
  x1: 1,
  y0: height,
  y1: height,
  line: {color: ink(), width: 1.2, dash: 'dash'},
  ...more,
});

// A finger that drags over a plot means the page; it zooms by the buttons.
export const fingers = () => matchMedia('(pointer: coarse)').matches;

const axisTheme = () => ({
  gridcolor: faint(),
  zerolinecolor: faint(),
  linecolor: faint(),
  tickcolor: faint(),
  color: ink(),
});

// The layout with the theme's colours put into each of its axes.
function themed(layout) {
  const result = {
    ...layout,
    paper_bgcolor: ground(),
    plot_bgcolor: ground(),
    font: {family: 'system-ui, "Segoe UI", "DejaVu Sans", sans-serif', size: 12, color: ink()},
    hoverlabel: {bgcolor: ground(), bordercolor: ink(), font: {color: ink()}, align: 'left', ...layout.hoverlabel},
  };
  for (const key of new Set([...Object.keys(layout), 'xaxis', 'yaxis'])) {
    if (/^[xy]axis\d*$/.test(key)) result[key] = {automargin: true, ...axisTheme(), ...layout[key]};
  }
  return result;
}

const standardLayout = () => ({
  margin: {l: 60, r: 12, t: 12, b: 44},
  uirevision: 'kept',
  hovermode: 'closest',
  dragmode: fingers() ? false : 'zoom',
});
const config = {
  responsive: true,
  displaylogo: false,
  scrollZoom: false,
  modeBarButtonsToRemove: ['select2d', 'lasso2d', 'autoScale2d'],
  toImageButtonOptions: {format: 'svg'},
};

// Figures are drawn one after the other, so that the first is seen before a large one begins.
let turn = Promise.resolve();
export function inTurn(task) {
  turn = turn.then(task).then(() => new Promise((shown) => setTimeout(shown, 0)));
}

// Calls `begin` when the element comes near the window: a page of many figures opens at once.
export function whenNear(element, begin) {
  const near = (entries) => {
    if (entries.some((entry) => entry.isIntersecting)) begin();
  };
  const watcher = new IntersectionObserver(near, {rootMargin: '300px'});
  watcher.observe(element);
  return () => watcher.disconnect();
}

let loading = null;
// Plotly takes most of a second to start: it does when the first figure that needs it comes near the window.
async function plotly() {
  loading = loading || runPacked('plotly');
  await loading;
  return window.Plotly;
}

// A figure: `make` returns {traces, layout} and is called again when the theme changes. `label` is what a screen reader
// says. Returns the element; element.redraw() calls `make` anew and keeps zoom (layout.uirevision).
export function figure(label, make, caption) {
  const plot = h('div', {class: 'plot', role: 'img', 'aria-label': label});
  const file = (format) => async () => blobOf(await (await plotly()).toImage(plot, {format, scale: 2}));
  const files = downloads(label, {svg: file('svg'), png: file('png')});
  const element =
      h('figure', {}, plot, h('div', {class: 'below-plot'}, files),
        caption ? h('figcaption', {class: 'caption'}, caption) : null);
  let begun = false, drawn = false;
  element.plot = plot;
  element.redraw = async () => {
    const [Plotly, {traces, layout}] = await Promise.all([plotly(), make()]);
    const full = themed({...standardLayout(), ...layout});
    plot.style.height = `${full.height || 320}px`;
    await (drawn ? Plotly.react(plot, traces, full, config) : Plotly.newPlot(plot, traces, full, config));
    drawn = true;
  };
  // Anew where it was drawn at all; what was not will be as things are then.
  element.update = () => (plot.on ? element.redraw() : Promise.resolve());
  element.ready = new Promise((resolve, reject) => {
    let ignore = null;
    element.begin = () => {
      if (begun) return;
      begun = true;
      ignore();
      inTurn(() => element.redraw().then(resolve, (error) => {
        plot.dataset.failed = 'true';
        reject(error);
      }));
    };
    plot.style.minHeight = '200px';
    ignore = whenNear(plot, () => element.begin());
  });
  keepWhenPrinted();
  beforePrint(() => {
    element.begin();
    return element.ready;
  }, plot);
  onTheme(async () => {  // or of the width, when printing
    if (!drawn) return;
    await element.redraw();
    await window.Plotly.Plots.resize(plot);
  });
  return element;
}

// Calls `done` after the figure was drawn for the first time, when Plotly's events can be listened to.
export function onFirstDrawing(element, done) {
  const drawAnew = element.redraw;
  element.redraw = async () => {
    const fresh = !element.plot.on;
    await drawAnew();
    if (fresh) done();
  };
}
