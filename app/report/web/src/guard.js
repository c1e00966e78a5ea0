// Which states and inputs belong to which mode, where switches see them.
import {modeTitle} from './mode_names.js';
import {axisTitle, figure, modeColour, plain} from './plots.js';

const shown = (share) => `${(100 * share).toFixed(0)} %`;

// The data's samples in their modes' colours: `at(i)` is where sample i is drawn.
function sampleTraces(guard, count, x, y) {
  return Array.from({length: count}, (_, k) => {
    const own = guard.samples.mode.map((mode, i) => i).filter((i) => guard.samples.mode[i] === k);
    return {
      type: 'scatter',
      mode: 'markers',
      name: plain(modeTitle(k)),
      x: own.map(x),
      y: own.map(y),
      hoverinfo: 'name+x+y',
      marker: {color: modeColour(k), size: 4, opacity: 0.8, line: {width: 0.5, color: '#ffffff'}},
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

function map(guard, count) {
  const [x, y] = guard.samples.at;
  return {
    traces: [mapTrace(guard, count), ...sampleTraces(guard, count, (i) => x[i], (i) => y[i])],
    layout: {
      height: 420,
      legend: {orientation: 'h', y: 1.08},
      xaxis: {title: {text: axisTitle(guard.axes[0])}},
      yaxis: {title: {text: axisTitle(guard.axes[1])}},
    },
  };
}

// Samples stand below the lines, a row per mode.
function lines(guard, count) {
  const traces = guard.lines.map((share, k) => ({
                                   type: 'scatter',
                                   mode: 'lines',
                                   name: plain(modeTitle(k)),
                                   showlegend: false,
                                   x: guard.axes[0].values,
                                   y: share,
                                   line: {color: modeColour(k), width: 2},
                                 }));
  const rows = sampleTraces(guard, count, (i) => guard.samples.at[0][i], (i) => -0.05 - 0.05 * guard.samples.mode[i]);
  return {
    traces: [...traces, ...rows],
    layout: {
      height: 360,
      legend: {orientation: 'h', y: 1.08},
      xaxis: {title: {text: axisTitle(guard.axes[0])}},
      yaxis: {title: {text: 'share of the time'}, tickvals: [0, 0.25, 0.5, 0.75, 1]},
    },
  };
}

/** Of a bank of `count` modes. */
export function guardFigure(guard, count) {
  const rest = guard.others ? ' Other states and inputs are at their training mean.' : '';
  const points = 'Points: samples of all runs, by the state and the input that the step into them started from, in ' +
      'the colour of the mode that the filter finds them in.';
  const means = guard.one ?
      'Lines: which share of the time each mode would have if state and input stayed there.' :
      'Ground: the mode that would have the largest share of the time if state and input stayed there.';
  return figure(
      'Which states and inputs belong to which mode', () => (guard.one ? lines(guard, count) : map(guard, count)),
      `${means}${rest} ${points}`);
}
