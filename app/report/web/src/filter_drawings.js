// What plots of one run and of two runs draw alike of how true a filter's uncertainty is.
import {dashedLine, greyBand} from './plots.js';

// Residual autocorrelation by lag, from one sample on; `look`: more of the trace.
export function autocorrelationTrace(series, look) {
  const y = series.slice(1);
  return {type: 'scatter', mode: 'lines+markers', x: y.map((_, lag) => lag + 1), y, ...look};
}

export const autocorrelationLayout = (band, layout) => ({
  height: 350,
  xaxis: {title: {text: 'lag [samples]'}},
  yaxis: {title: {text: 'autocorrelation'}},
  shapes: band === undefined ? [] : [greyBand(-band, band, {layer: 'below'})],
  ...layout,
});

// Counts of the bars of a histogram of probability integral transforms (PIT), each with its middle and what it says.
export function pitBars({counts}) {
  const bins = counts.length;
  return {
    x: counts.map((_, b) => (b + 0.5) / bins),
    y: counts,
    width: 0.94 / bins,
    text: counts.map((count, b) => `${b / bins} to ${(b + 1) / bins}: ${count} samples`),
  };
}

// The same histogram as a density: edges of steps for a line of shape hv.
export function pitSteps({counts, expected}) {
  const bins = counts.length;
  return {
    x: Array.from({length: bins + 1}, (_, i) => i / bins),
    y: [...counts, counts[bins - 1]].map((count) => count / expected),
  };
}

// Bars of the samples outside an interval, in per cent; `cells`: shares as C++ formatted them, `texts`: whose they are.
export function outsideBars(cells, texts) {
  return {
    type: 'bar',
    y: cells.map((cell) => 100 * cell.v),
    text: cells.map((cell, i) => `${texts[i]}: ${cell.t}`),
    textposition: 'none',
    hoverinfo: 'text',
  };
}

export const outsideLayout = (tail, title, layout) => ({
  barmode: 'group',
  xaxis: {type: 'category'},
  yaxis: {title: {text: title}, rangemode: 'tozero'},
  shapes: [dashedLine(100 * tail)],
  ...layout,
});
