// Which states and inputs belong to which mode, where switches see them.
import {modeTitle} from './mode_names.js';
import {byUse, othersName} from './modes.js';
import {axisTitle, figure, modeColour, palette, plain} from './plots.js';

const shown = (share) => `${(100 * share).toFixed(0)} %`;

// The modes told one by one, and all others as one: {name, colour, holds: mode => bool}.
function groupsOf(bank) {
  const {told, others} = byUse(bank);
  const own = ({mode}) => ({name: plain(modeTitle(mode)), colour: modeColour(mode), holds: (k) => k === mode});
  const rest = new Set(others.map(({mode}) => mode));
  const list = told.map(own);
  return rest.size ? [...list, {name: othersName(rest.size), colour: palette.unclustered, holds: (k) => rest.has(k)}] :
                     list;
}

// The data's samples in their modes' colours: `at(i, row)` is where sample i of group `row` is drawn.
function sampleTraces(bank, x, y) {
  const {samples} = bank.guard;
  return groupsOf(bank).map(({name, colour, holds}, row) => {
    const own = samples.mode.map((mode, i) => i).filter((i) => holds(samples.mode[i]));
    return {
      type: 'scatter',
      mode: 'markers',
      name,
      x: own.map(x),
      y: own.map((i) => y(i, row)),
      hoverinfo: 'name+x+y',
      marker: {color: colour, size: 4, opacity: 0.8, line: {width: 0.5, color: '#ffffff'}},
    };
  });
}

// A colour per mode in steps: value k is between k - 1/2 and k + 1/2.
function modeScale(count) {
  const steps = [];
  for (let k = 0; k < count; ++k) steps.push([k / count, modeColour(k)], [(k + 1) / count, modeColour(k)]);
  return steps;
}

function mapTrace(guard, count) {
  return {
    type: 'heatmap',
    x: guard.axes[0].values,
    y: guard.axes[1].values,
    z: guard.modes,
    zmin: -0.5,
    zmax: count - 0.5,
    colorscale: modeScale(count),
    showscale: false,
    opacity: 0.35,
    hoverinfo: 'text',
    text: guard.modes.map(
        (row, i) => row.map((k, j) => `${plain(modeTitle(k))}: ${shown(guard.shares[i][j])} of the time`)),
  };
}

function map(bank) {
  const {guard} = bank, [x, y] = guard.samples.at;
  return {
    traces: [mapTrace(guard, bank.modes.length), ...sampleTraces(bank, (i) => x[i], (i) => y[i])],
    layout: {
      height: 420,
      legend: {orientation: 'h', y: 1.08},
      xaxis: {title: {text: axisTitle(guard.axes[0])}},
      yaxis: {title: {text: axisTitle(guard.axes[1])}},
    },
  };
}

function lineTrace(guard, k) {
  return {
    type: 'scatter',
    mode: 'lines',
    name: plain(modeTitle(k)),
    showlegend: false,
    x: guard.axes[0].values,
    y: guard.lines[k],
    line: {color: modeColour(k), width: 2},
  };
}

// Samples stand below the lines, a row per mode.
function lines(bank) {
  const {guard} = bank;
  const rows = sampleTraces(bank, (i) => guard.samples.at[0][i], (i, row) => -0.05 - 0.05 * row);
  return {
    // The most used modes last, or the others would hide them.
    traces: [...[...bank.order].reverse().map((k) => lineTrace(guard, k)), ...rows],
    layout: {
      height: 360,
      legend: {orientation: 'h', y: 1.08},
      xaxis: {title: {text: axisTitle(guard.axes[0])}},
      yaxis: {title: {text: 'share of the time'}, tickvals: [0, 0.25, 0.5, 0.75, 1]},
    },
  };
}

/** Of a bank whose switches see states and inputs. */
export function guardFigure(bank) {
  const {guard} = bank;
  const rest = guard.others ? ' Other states and inputs are at their training mean.' : '';
  const points = 'Points: samples of all runs, by the state and the input that the step into them started from, in ' +
      'the colour of the mode that the filter finds them in.';
  const means = guard.one ?
      'Lines: which share of the time each mode would have if state and input stayed there.' :
      'Ground: the mode that would have the largest share of the time if state and input stayed there.';
  return figure(
      'Which states and inputs belong to which mode', () => (guard.one ? lines(bank) : map(bank)),
      `${means}${rest} ${points}`);
}
