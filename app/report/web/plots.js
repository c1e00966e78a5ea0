// Plotly as the report uses it: one theme, one palette, text that stays text.
import palette from './palette.json';
import { beforePrint, dark, h, onTheme } from './common.js';

const Plotly = window.Plotly;
export { palette, Plotly };

// Plotly reads <b>, <a> and &entities; in texts: what comes from an archive must not be read so.
export const plain = (text) => String(text).replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/>/g, '&gt;');

export const ink = () => (dark() ? '#e8eaee' : '#16181d');
const faint = () => (dark() ? '#343a45' : '#dfe3e8');
const ground = () => (dark() ? '#14161a' : '#ffffff');

const mixed = (colour, other, share) => {
  const at = (text, i) => parseInt(text.slice(1 + 2 * i, 3 + 2 * i), 16);
  return '#' + [0, 1, 2].map((i) => Math.round((1 - share) * at(colour, i) + share * at(other, i)).toString(16).padStart(2, '0')).join('');
};
// Colour of mode k, the same in every plot; from the eighth on the palette comes again, darker, then lighter.
export function modeColour(k) {
  if (k < 0) return palette.unclustered;
  const base = palette.modes[k % palette.modes.length], round = Math.floor(k / palette.modes.length) % 3;
  return round === 0 ? base : mixed(base, round === 1 ? '#000000' : '#ffffff', 0.45);
}
// For thin lines: lighter on a dark ground.
export const lineColour = (colour) => (dark() && /^#[0-9a-f]{6}$/i.test(colour) ? mixed(colour, '#ffffff', 0.35) : colour);
export const filterColour = (name) => lineColour(palette.filters[name] || ink());
export const translucent = (colour, alpha) => colour + Math.round(255 * alpha).toString(16).padStart(2, '0');

// A finger that drags over a plot means the page; it zooms by the buttons.
export const fingers = () => matchMedia('(pointer: coarse)').matches;

const axisTheme = () => ({ gridcolor: faint(), zerolinecolor: faint(), linecolor: faint(), tickcolor: faint(), color: ink() });

// The layout with the theme's colours put into each of its axes and scenes.
function themed(layout) {
  const result = { ...layout, paper_bgcolor: ground(), plot_bgcolor: ground(),
    font: { family: 'system-ui, "Segoe UI", "DejaVu Sans", sans-serif', size: 12, color: ink() },
    hoverlabel: { bgcolor: ground(), bordercolor: ink(), font: { color: ink() }, align: 'left', ...layout.hoverlabel } };
  for (const key of new Set([...Object.keys(layout), 'xaxis', 'yaxis'])) {
    if (/^[xy]axis\d*$/.test(key)) result[key] = { automargin: true, ...axisTheme(), ...layout[key] };
    if (/^scene\d*$/.test(key)) {
      result[key] = { bgcolor: ground(), ...layout[key] };
      for (const axis of ['xaxis', 'yaxis', 'zaxis']) result[key][axis] = { ...axisTheme(), showbackground: false, ...(layout[key] || {})[axis] };
    }
  }
  return result;
}

// Figures are drawn one after the other, so that the first is seen before a large one begins.
let turn = Promise.resolve();

// A figure: `make` returns {traces, layout} and is called again when the theme changes. `label` is what a screen reader
// says. Returns the element; element.redraw() calls `make` anew and keeps zoom (layout.uirevision).
export function figure(label, make, caption) {
  const plot = h('div', { class: 'plot', role: 'img', 'aria-label': label });
  const element = h('figure', {}, plot, caption ? h('figcaption', { class: 'caption' }, caption) : null);
  const config = { responsive: true, displaylogo: false, scrollZoom: false, modeBarButtonsToRemove: ['select2d', 'lasso2d', 'autoScale2d'],
    toImageButtonOptions: { format: 'svg' } };
  let drawn = null;
  element.plot = plot;
  element.redraw = async () => {
    const { traces, layout } = await make();
    const full = themed({ margin: { l: 60, r: 12, t: 12, b: 44 }, uirevision: 'kept', hovermode: 'closest', dragmode: fingers() ? false : 'zoom', ...layout });
    plot.style.height = `${full.height || 320}px`;
    await (drawn ? Plotly.react(plot, traces, full, config) : Plotly.newPlot(plot, traces, full, config));
    drawn = true;
  };
  // Drawn when it comes near the window: a page of many figures opens at once.
  element.ready = new Promise((resolve, reject) => {
    const begin = () => {
      if (drawn !== null) return;
      drawn = false;
      watcher.disconnect();
      turn = turn.then(() => element.redraw()).then(resolve, (error) => { plot.dataset.failed = 'true'; reject(error); })
        .then(() => new Promise((shown) => setTimeout(shown, 0)));
    };
    const watcher = new IntersectionObserver((entries) => { if (entries.some((entry) => entry.isIntersecting)) begin(); }, { rootMargin: '300px' });
    plot.style.minHeight = '200px';
    watcher.observe(plot);
    element.begin = begin;
  });
  beforePrint(() => { element.begin(); return element.ready; });
  onTheme(async () => {  // or of the width, when printing
    if (!drawn) return;
    await element.redraw();
    await Plotly.Plots.resize(plot);
  });
  return element;
}

// A browser prints without waiting: what WebGL has drawn in three dimensions would be missing, so a copy is laid over it, and
// figures that were drawn for a wider window are made smaller.
const sheet_px = 700;
addEventListener('beforeprint', () => {
  for (const plot of document.querySelectorAll('div.js-plotly-plot')) {
    if (plot.clientWidth > sheet_px) plot.style.zoom = sheet_px / plot.clientWidth;
    const scene = plot._fullLayout?.scene?._scene;
    if (!scene?.glplot) continue;
    scene.glplot.redraw();
    const drawn = scene.glplot.canvas, copy = h('canvas', { class: 'still', width: drawn.width, height: drawn.height });
    copy.getContext('2d').drawImage(drawn, 0, 0);
    scene.container.append(copy);
  }
});
addEventListener('afterprint', () => {
  for (const copy of document.querySelectorAll('canvas.still')) copy.remove();
  for (const plot of document.querySelectorAll('div.js-plotly-plot')) plot.style.zoom = '';
});
