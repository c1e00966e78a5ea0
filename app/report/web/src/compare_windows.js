// Local models of two runs in two parameters.
import {choice, controls, note} from './elements.js';
import {section} from './page.js';
import {array} from './page_data.js';
import {colours, letters, pairLegend, symbols} from './pair.js';
import {axisTitle, figure, ink} from './plots.js';
import {usualRange} from './statistics.js';

const title = 'Local models';

function windowPoints(k, x, y) {
  return {
    type: 'scattergl',
    mode: 'markers',
    x,
    y,
    name: letters[k],
    marker: {size: 4, color: colours[k], symbol: symbols[k], opacity: 0.35},
    hovertemplate: `${letters[k]}: %{x:.4g}, %{y:.4g}<extra></extra>`,
  };
}

function bankPoints(k, bank, x, y) {
  return {
    type: 'scatter',
    mode: 'markers',
    x: bank.map((theta) => theta[x]),
    y: bank.map((theta) => theta[y]),
    text: bank.map((_, mode) => `mode ${mode} of ${letters[k]}`),
    hoverinfo: 'text',
    marker: {symbol: k ? 'square' : 'star', size: 12, color: colours[k], line: {color: ink(), width: 1.5}},
  };
}

const axisOf = (windows, name) => windows.axes.findIndex((axis) => axis.name === name);

// `chosen`: names of the parameters across (x) and up (y).
async function windowsDrawing(both, chosen) {
  const values = (name) => Promise.all(both.map((windows) => array(windows.values[axisOf(windows, name)])));
  const xs = await values(chosen.x), ys = await values(chosen.y);
  const traces = both.map((_, k) => windowPoints(k, xs[k], ys[k]));
  both.forEach((windows, k) => {
    const {bank, parameters} = windows, at = [axisOf(windows, chosen.x), axisOf(windows, chosen.y)];
    if (bank && bank.length && at.every((a) => a < parameters)) traces.push(bankPoints(k, bank, ...at));
  });
  const axis = (name, lists) =>
      ({title: {text: axisTitle(both[0].axes[axisOf(both[0], name)])}, range: usualRange(...lists)});
  const layout = {height: 460, showlegend: false, xaxis: axis(chosen.x, xs), yaxis: axis(chosen.y, ys)};
  return {traces, layout};
}

// The parameters that are shown first: the page of A's, where B has them, too.
function firstAxes(windows, shared) {
  const begin = windows.default_axes.map((a) => windows.axes[a].name).filter((name) => shared.includes(name));
  const x = begin[0] || shared[0];
  return {x, y: [...begin, ...shared].find((name) => name !== x)};
}

export async function drawWindows(data) {
  const both = data.runs.map((run) => run.windows);
  if (!both[0] || !both[1]) {
    section('windows', title, note('Not both hold windows.'));
    return;
  }
  const shared = both[0].axes.map((axis) => axis.name).filter((name) => axisOf(both[1], name) >= 0);
  if (shared.length < 2) {
    section('windows', title, note('Their models share fewer than two parameters.'));
    return;
  }
  const chosen = firstAxes(both[0], shared);
  const element = figure(
      'Local models of both runs in two parameters', () => windowsDrawing(both, chosen),
      'Small: windows. Large with an outline: modes of the bank.');
  const pick = (label, key) => choice(label, shared, shared.indexOf(chosen[key]), (i) => {
    chosen[key] = shared[i];
    element.redraw();
  });
  section('windows', title, pairLegend(data.runs), controls(pick('Across', 'x'), pick('Up', 'y')), element);
}
