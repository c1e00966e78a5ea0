// Time plots that share a run and a view, and their controls.
import {choice, h} from './elements.js';
import {roleOf} from './filters.js';
import {shortName} from './run_names.js';

export {timePlot} from './time_plot.js';
export {TimeState} from './time_state.js';

const shortTime = (t) => String(Number(t.toFixed(4)));

// Two fields for the start and the end of the visible time.
function windowFields(state) {
  const field = (label, i) => {
    const input = h('input', {type: 'number', step: 'any', class: 'seconds', 'aria-label': `${label}, in seconds`});
    input.addEventListener('change', () => {
      const range = [...state.shown()];
      range[i] = Number(input.value);
      if (input.value !== '' && range[1] > range[0]) return state.zoom(range);
      return refresh();
    });
    return input;
  };
  const fields = [field('Shown from', 0), field('Shown to', 1)];
  const refresh = () => {
    state.shown().forEach((t, i) => {
      fields[i].value = shortTime(t);
    });
    return Promise.resolve();
  };
  state.plots.push({refresh});
  refresh();
  return h('span', {class: 'window-fields'}, fields[0], ' to ', fields[1], ' s');
}

// Buttons for the mouse actions of a plot, for users of keyboards and screen readers.
export function timeControls(state) {
  const button = (text, label, act) =>
      h('button', {type: 'button', 'aria-label': label, title: label, onclick: act}, text);
  return [
    button('◀', 'Earlier', () => state.move(-0.5)),
    button('▶', 'Later', () => state.move(0.5)),
    button('+', 'Zoom in', () => state.scale(0.5)),
    button('−', 'Zoom out', () => state.scale(2)),
    button('All', 'All of the run', () => state.showAll()),
    windowFields(state),
  ];
}

// A drop-down list of the runs.
export function runChoice(state) {
  return choice(
      'Run', state.runs.map((run) => `${shortName(run.name)} (${roleOf(run.role)})`), state.run,
      (i) => state.select(i));
}
