// Figures that were drawn for a wider window are made smaller on paper.
const sheet_px = 800;  // at the page's scale on paper (page.css)

function beforePrinting() {
  for (const plot of /** @type {NodeListOf<any>} */ (document.querySelectorAll('div.js-plotly-plot'))) {
    if (plot.clientWidth > sheet_px) plot.style.zoom = sheet_px / plot.clientWidth;
  }
}

function afterPrinting() {
  for (const plot of /** @type {NodeListOf<any>} */ (document.querySelectorAll('div.js-plotly-plot'))) {
    plot.style.zoom = '';
  }
}

// Listening twice does no harm: the same function is kept once.
export function keepWhenPrinted() {
  addEventListener('beforeprint', beforePrinting);
  addEventListener('afterprint', afterPrinting);
}
