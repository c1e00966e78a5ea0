// Time plots that share a run and a view, and their controls.
import {choice, h} from './elements.js';
import {roleOf} from './filters.js';
import {shortName} from './run_names.js';

export {timePlot} from './time_plot.js';
export {TimeState} from './time_state.js';

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
  ];
}

// A drop-down list of the runs.
export function runChoice(state) {
  return choice(
      'Run', state.runs.map((run) => `${shortName(run.name)} (${roleOf(run.role)})`), state.run,
      (i) => state.select(i));
}
