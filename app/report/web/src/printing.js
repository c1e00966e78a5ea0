// A browser prints without waiting: what WebGL has drawn in three dimensions would be missing, so a copy is laid over
// it, and figures that were drawn for a wider window are made smaller. Reaches into what plotly.js 2.6 keeps to itself.
import {h} from './elements.js';

const sheet_px = 800;  // at the page's scale on paper (page.css)

function still(scene) {
  scene.glplot.redraw();
  const drawn = scene.glplot.canvas;
  const copy = h('canvas', {class: 'still', width: drawn.width, height: drawn.height});
  copy.getContext('2d').drawImage(drawn, 0, 0);
  scene.container.append(copy);
}

function beforePrinting() {
  for (const plot of /** @type {NodeListOf<any>} */ (document.querySelectorAll('div.js-plotly-plot'))) {
    if (plot.clientWidth > sheet_px) plot.style.zoom = sheet_px / plot.clientWidth;
    const layout = plot._fullLayout;
    const scene = layout && layout.scene && layout.scene._scene;
    if (scene && scene.glplot) still(scene);
  }
}

function afterPrinting() {
  for (const copy of document.querySelectorAll('canvas.still')) copy.remove();
  for (const plot of /** @type {NodeListOf<any>} */ (document.querySelectorAll('div.js-plotly-plot'))) {
    plot.style.zoom = '';
  }
}

// Listening twice does no harm: the same function is kept once.
export function keepWhenPrinted() {
  addEventListener('beforeprint', beforePrinting);
  addEventListener('afterprint', afterPrinting);
}
