// A run over time: data, prediction, inputs, modes, innovations and NIS on one time axis. A link restores the view.
import {check, controls, copyButton, h} from './elements.js';
import {keyHelp} from './time_keys.js';
import {innovationRow, inputRows, nisRow, probabilityRow, stateRow} from './time_rows.js';
import {timePlot} from './timeview.js';
import {linkOf, viewIn} from './view_link.js';

const link_delay_ms = 300;  // browsers limit how often a page may change its address

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

// Writes the present view into the address, and restores the view from the address.
function followLink(state, filters, options) {
  const view = () => ({run: state.current.name, filter: filters[options.chosen], range: state.range, at: state.at});
  const follow = () => {
    const said = viewIn(location.hash);
    if (!said) return;
    const run = state.runs.findIndex(({name}) => name === said.run), filter = filters.indexOf(said.filter);
    if (run >= 0) state.run = run;
    if (filter >= 0) options.chosen = filter;
    state.range = said.range && state.inside(said.range);
    state.at = said.at;
    state.changed();
    state.pointed();
    document.getElementById('data').scrollIntoView();
  };
  let timer = null;
  const keep = () => {
    clearTimeout(timer);
    timer = setTimeout(() => history.replaceState(null, '', linkOf(view())), link_delay_ms);
    return Promise.resolve();
  };
  addEventListener('hashchange', follow);
  // Called after the first view is set. This view is the default, so the address stays unchanged.
  Promise.resolve().then(() => {
    follow();
    state.plots.push({refresh: keep, point: keep});
  });
  return () => location.href.replace(/#.*$/, '') + linkOf(view());
}

/**
 * The plot with its controls, from top to bottom. `options`: layer and index of the visible filter; `filters`: their
 * names.
 */
export function dataPlot(runs, state, filters, options) {
  const shown = {inputs: true, modes: true, innovations: true, nis: true};
  const link = followLink(state, filters, options);
  const plot = timePlot(
      state, 'One run over time: data, prediction, inputs, modes, innovations and NIS',
      () => dataRows(runs, state, options, shown), runs.note);
  const part = (name) => check(parts[name], true, (on) => {
    shown[name] = on;
    state.changed();
  });
  const there = Object.keys(parts).filter((name) => (name === 'inputs' ? runs.inputs.length : filters.length));
  return [
    controls(there.map(part), copyButton('Copy a link to this view', link)),
    plot,
    h('div', {class: 'keys'}, keyHelp()),
  ];
}
