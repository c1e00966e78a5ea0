// Local models and modes of all runs over two parameters.
import {figure} from './chart.js';
import {choice, controls, note} from './elements.js';
import {INK, palette} from './look.js';
import {section} from './page.js';
import {array} from './page_data.js';
import {colours, letters, pairLegend, symbols} from './pair.js';
import {usualRange} from './statistics.js';
import {titleOf} from './time_rows.js';

const title = 'Local models';

function windowPoints(k, x, y, look = {}) {
  const tip = (i) => `${letters[k]}: ${Number(x[i].toPrecision(4))}, ${Number(y[i].toPrecision(4))}`;
  return {kind: 'points', x, y, colour: colours[k], symbol: symbols[k], opacity: 0.4, ...look, tip};
}

const place = (mode, at) => at.map((a) => mode.mean[a]);

// The symbols of the first bank are filled. Those of the other banks are larger and hollow, so that equal modes stay
// visible.
function bankPoints(k, bank, at) {
  const places = bank.map((mode) => place(mode, at[k]));
  return {
    kind: 'points',
    name: `modes of ${letters[k]}`,
    x: places.map(([x]) => x),
    y: places.map(([, y]) => y),
    colour: colours[k],
    symbol: symbols[k],
    size: k ? 14 + 4 * k : 10,
    ...(k ? {open: true} : {edge: true}),
    tip: (mode) => `mode ${mode} of ${letters[k]}`,
  };
}

// A line from each mode of A to the matching mode of another bank.
function links(match, banks, at, k) {
  const x = [], y = [];
  for (const {first, second} of match.modes) {
    if (first < 0 || second < 0) continue;
    const from = place(banks[0][first], at[0]), to = place(banks[k][second], at[k]);
    x.push(from[0], to[0], NaN);
    y.push(from[1], to[1], NaN);
  }
  return {kind: 'line', name: 'matches', x, y, colour: INK, width: 1.5};
}

const axisOf = (windows, name) => windows.axes.findIndex((axis) => axis.name === name);
const alike = (lists) =>
    lists.every((list) => list.length === lists[0].length && list.every((v, i) => v === lists[0][i]));

// The modes that have both parameters, and the matches among these modes.
function modeMarks(data, chosen) {
  const list = data.runs.map((run) => run.windows);
  const at = list.map((windows) => [axisOf(windows, chosen.x), axisOf(windows, chosen.y)]);
  const banks = list.map(({bank, parameters}, k) => (bank && at[k].every((a) => a < parameters) ? bank : null));
  const matched = banks[0] ?
      data.matches.flatMap((match, i) => (banks[i + 1] && !match.difference ? [links(match, banks, at, i + 1)] : [])) :
      [];
  return [...matched, ...banks.flatMap((bank, k) => (bank && bank.length ? [bankPoints(k, bank, at)] : []))];
}

// `chosen`: names of the parameters on the x and y axis.
async function windowsDrawing(data, chosen) {
  const all = data.runs.map((run) => run.windows);
  const values = (name) => Promise.all(all.map((windows) => array(windows.values[axisOf(windows, name)])));
  const xs = await values(chosen.x), ys = await values(chosen.y);
  // Equal windows would hide each other, so they are drawn only once.
  const points = alike(xs) && alike(ys) ? [windowPoints(0, xs[0], ys[0], {colour: palette.unclustered})] :
                                          all.map((_, k) => windowPoints(k, xs[k], ys[k]));
  const axis = (name, lists) => ({title: titleOf(all[0].axes[axisOf(all[0], name)]), range: usualRange(...lists)});
  const panel = {x: axis(chosen.x, xs), y: axis(chosen.y, ys), marks: [...points, ...modeMarks(data, chosen)]};
  return {panels: [panel], height: 380};
}

// The parameters that are shown at first: those of A's page, if B also has them.
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
          'Large, where both axes are parameters of modes: those of the banks, A’s filled, the others’ hollow; lines ' +
          'join those that are matched.');
  const pick = (label, key) => choice(label, shared, shared.indexOf(chosen[key]), (i) => {
    chosen[key] = shared[i];
    element.update();
  });
  section('windows', title, pairLegend(data.runs), controls(pick('Across', 'x'), pick('Up', 'y')), element);
}
