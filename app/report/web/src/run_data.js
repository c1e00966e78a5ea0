// A run over time: data, prediction, inputs, modes, innovations and NIS on one time axis.
import {check, controls} from './elements.js';
import {innovationRow, inputRows, nisRow, probabilityRow, stateRow} from './time_rows.js';
import {timePlot} from './timeview.js';

const parts = {
  inputs: 'Inputs',
  modes: 'Modes',
  innovations: 'Innovations',
  nis: 'NIS',
};

// Rows of the parts that are visible.
function dataRows(runs, state, {layer}, shown) {
  const filter = layer.of(state.current);
  return [
    ...runs.states.map((_, i) => stateRow(runs, i, [layer])),
    ...(shown.inputs ? inputRows(runs) : []),
    ...(shown.modes && filter && filter.probability ? [probabilityRow(layer.of)] : []),
    ...(shown.innovations && filter ? runs.states.map((_, i) => innovationRow(runs, i, layer.of)) : []),
    ...(shown.nis && filter ? [nisRow(runs, layer.of)] : []),
  ];
}

/**
 * The plot with its controls, from top to bottom. `options`: layer and index of the visible filter; `filters`: their
 * names.
 */
export function dataPlot(runs, state, filters, options) {
  const shown = {inputs: true, modes: true, innovations: true, nis: true};
  const plot = timePlot(
      state, 'One run over time: data, prediction, inputs, modes, innovations and NIS',
      () => dataRows(runs, state, options, shown), runs.note);
  const part = (name) => check(parts[name], true, (on) => {
    shown[name] = on;
    state.changed();
  });
  const there = Object.keys(parts).filter((name) => (name === 'inputs' ? runs.inputs.length : filters.length));
  return [
    controls(there.map(part)),
    plot,
  ];
}
