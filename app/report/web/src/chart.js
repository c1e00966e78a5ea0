// A figure of panels with axes as SVG: points, lines, bars. CSS sets the colours, so a change of theme needs no
// new drawing. chart_layout.js places the parts and chart_marks.js draws them.
import {layoutOf} from './chart_layout.js';
import {drawChart} from './chart_panel.js';
import {h, legend} from './elements.js';
import {inTurn, whenNear} from './turns.js';

/**
 * x and y have equal length; null or NaN leaves a gap. 'points': symbols; 'line': through the points; 'bars': from zero
 * to y at x; 'band': grey between two heights; 'rule': a horizontal line at y or a vertical one at x.
 * @typedef {{kind: string, x?: any, y?: any, colour?: string, size?: number,
 *   symbol?: string, opacity?: number, edge?: boolean, width?: number, dash?: string, step?: boolean,
 *   name?: string, low?: number, high?: number}} Mark
 * `levels`: names at 0, 1, 2, ...; `whole`: ticks at whole numbers; `zero`: from zero on.
 * @typedef {{title?: string, range?: number[]|null, levels?: string[], whole?: boolean, zero?: boolean}} Axis
 * @typedef {{title?: string, x: Axis, y: Axis, marks: Mark[]}} Panel
 * `wide`: smallest width of a panel in pixels, which decides how many are side by side; `height`: of its inside.
 * @typedef {{panels: Panel[], height?: number, wide?: number, legend?: any[]}} Drawing
 */

function oncePerFrame(work) {
  let wanted = false;
  return () => {
    if (wanted) return;
    wanted = true;
    requestAnimationFrame(() => {
      wanted = false;
      work();
    });
  };
}

/**
 * A figure: `make` returns a Drawing; redraw() calls it again. `label`: text for screen readers.
 * @param {string} label
 * @param {() => Drawing|Promise<Drawing>} make
 * @param {string} [caption]
 * @returns {any} the element
 */
export function figure(label, make, caption) {
  const plot = /** @type {any} */ (h('div', {class: 'plot chart', role: 'img', 'aria-label': label}));
  const keys = h('div');
  const element =
      /** @type {any} */ (h('figure', {}, keys, plot, caption ? h('figcaption', {class: 'caption'}, caption) : null));
  let begun = false;
  const show = () => {
    const width = plot.clientWidth;
    if (!plot.drawing || !width) return;
    plot.layout = layoutOf(plot.drawing, width);
    plot.replaceChildren(drawChart(plot.layout));
    plot.dataset.drawn = 'true';
  };
  element.plot = plot;
  element.redraw = async () => {
    plot.drawing = await make();
    keys.replaceChildren(...(plot.drawing.legend ? [legend(plot.drawing.legend)] : []));
    show();
  };
  // Draws a visible figure again. A hidden figure is drawn when it appears.
  element.update = () => (plot.drawing ? element.redraw() : Promise.resolve());
  element.ready = new Promise((resolve, reject) => {
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
    const ignore = whenNear(plot, () => element.begin());
  });
  const fit = oncePerFrame(show);
  new ResizeObserver(() => {
    if (plot.layout && plot.layout.width !== plot.clientWidth) fit();
  }).observe(plot);
  return element;
}
