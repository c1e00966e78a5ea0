// Local models and modes of the runs in two parameters.
import {choice, controls, note} from './elements.js';
import {section} from './page.js';
import {array} from './page_data.js';
import {colours, letters, pairLegend, symbols} from './pair.js';
import {axisTitle, figure, ink, palette} from './plots.js';
import {usualRange} from './statistics.js';

const title = 'Local models';

function windowPoints(k, x, y, look = {}) {
  return {
    type: 'scattergl',
    mode: 'markers',
    x,
    y,
    name: letters[k],
    marker: {size: 4, color: colours[k], symbol: symbols[k], opacity: 0.35, ...look},
    hovertemplate: `${letters[k]}: %{x:.4g}, %{y:.4g}<extra></extra>`,
  };
}

const place = (mode, at) => at.map((a) => mode.mean[a]);

function bankPoints(k, bank, at) {
  return {
    type: 'scatter',
    mode: 'markers',
    meta: `modes of ${letters[k]}`,
    x: bank.map((mode) => place(mode, at[k])[0]),
    y: bank.map((mode) => place(mode, at[k])[1]),
    text: bank.map((_, mode) => `mode ${mode} of ${letters[k]}`),
    hoverinfo: 'text',
    // The first's full, the others' open around them: modes that agree are both seen.
    marker: k ? {symbol: `${symbols[k]}-open`, size: 14 + 4 * k, color: colours[k], line: {width: 3}} :
                {symbol: symbols[0], size: 10, color: colours[0], line: {color: ink(), width: 1}},
  };
}

// A line from each mode of A to the one of another that is matched with it.
function links(match, banks, at, k) {
  const x = [], y = [];
  for (const {first, second} of match.modes) {
    if (first < 0 || second < 0) continue;
    const from = place(banks[0][first], at[0]), to = place(banks[k][second], at[k]);
    x.push(from[0], to[0], null);
    y.push(from[1], to[1], null);
  }
  return {type: 'scatter', mode: 'lines', x, y, line: {color: ink(), width: 1.5}, hoverinfo: 'skip', meta: 'matches'};
}

const axisOf = (windows, name) => windows.axes.findIndex((axis) => axis.name === name);
const alike = (lists) =>
    lists.every((list) => list.length === lists[0].length && list.every((v, i) => v === lists[0][i]));

// The modes of the banks with parameters on both axes, and which are matched.
function modeTraces(data, chosen) {
  const list = data.runs.map((run) => run.windows);
  const at = list.map((windows) => [axisOf(windows, chosen.x), axisOf(windows, chosen.y)]);
  const banks = list.map(({bank, parameters}, k) => (bank && at[k].every((a) => a < parameters) ? bank : null));
  const matched = banks[0] ?
      data.matches.flatMap((match, i) => (banks[i + 1] && !match.difference ? [links(match, banks, at, i + 1)] : [])) :
      [];
  return [...matched, ...banks.flatMap((bank, k) => (bank && bank.length ? [bankPoints(k, bank, at)] : []))];
}

// `chosen`: names of the parameters across (x) and up (y).
async function windowsDrawing(data, chosen) {
  const all = data.runs.map((run) => run.windows);
  const values = (name) => Promise.all(all.map((windows) => array(windows.values[axisOf(windows, name)])));
  const xs = await values(chosen.x), ys = await values(chosen.y);
  // The same windows in all would hide each other.
  const points = alike(xs) && alike(ys) ? [windowPoints(0, xs[0], ys[0], {color: palette.unclustered})] :
                                          all.map((_, k) => windowPoints(k, xs[k], ys[k]));
  const axis = (name, lists) =>
      ({title: {text: axisTitle(all[0].axes[axisOf(all[0], name)])}, range: usualRange(...lists)});
  const layout = {height: 460, showlegend: false, xaxis: axis(chosen.x, xs), yaxis: axis(chosen.y, ys)};
  return {traces: [...points, ...modeTraces(data, chosen)], layout};
}

// The parameters that are shown first: the page of A's, where B has them, too.
function firstAxes(windows, shared) {
  const begin = windows.default_axes.map((a) => windows.axes[a].name).filter((name) => shared.includes(name));
  const x = begin[0] || shared[0];
  return {x, y: [...begin, ...shared].find((name) => name !== x)};
}

export function drawWindows(data) {
  const all = data.runs.map((run) => run.windows);
  if (!all.every(Boolean)) {
    section('windows', title, note('Not all hold windows.'));
    return;
  }
  const shared =
      all[0].axes.map((axis) => axis.name).filter((name) => all.every((windows) => axisOf(windows, name) >= 0));
  if (shared.length < 2) {
    section('windows', title, note('Their models share fewer than two parameters.'));
    return;
  }
  const chosen = firstAxes(all[0], shared);
  const element = figure(
      'Local models and modes of all runs in two parameters', () => windowsDrawing(data, chosen),
      'Small: windows, grey where they are the same in all. ' +
          'Large, where both axes are parameters of modes: those of the banks, A’s full, the others’ open; lines ' +
          'join those that are matched.');
  const pick = (label, key) => choice(label, shared, shared.indexOf(chosen[key]), (i) => {
    chosen[key] = shared[i];
    element.redraw();
  });
  section('windows', title, pairLegend(data.runs), controls(pick('Across', 'x'), pick('Up', 'y')), element);
}
