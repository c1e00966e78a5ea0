// Keys of a time plot that has the focus, and the list of these keys on the page.
import {details, facts} from './elements.js';

const coarse_steps = 10;
const pixels_across = 500;

// One step of the crosshair. It is a sample, or a share of the view if the view has more samples than pixels.
function step(state, direction, coarse) {
  const [from, to] = state.shown(), {start, end, samples} = state.current.time;
  const by = Math.max((end - start) / Math.max(1, samples - 1), (to - from) / pixels_across);
  const at = state.at === null || state.at < from || state.at > to ? (from + to) / 2 : state.at;
  state.point(Math.max(from, Math.min(to, at + direction * by * (coarse ? coarse_steps : 1))));
}

const edge = (state, which) => {
  if (state.at === null) return;
  const [from, to] = state.shown();
  if (which === 'from' && state.at < to) state.zoom([state.at, to]);
  if (which === 'to' && state.at > from) state.zoom([from, state.at]);
};

// [names of the keys in events, name for people, description, action]
/**
 * @type {[string[], string, string, (state: import('./time_state.js').TimeState, event: KeyboardEvent) => unknown][]}
 */
const actions = [
  [
    ['ArrowLeft', 'ArrowRight'], '← →', 'move the crosshair; with Shift ten times as far',
    (state, event) => step(state, event.key === 'ArrowLeft' ? -1 : 1, event.shiftKey)
  ],
  [
    ['[', ']'], '[ ]', 'start, end the view at the crosshair',
    (state, {key}) => edge(state, key === '[' ? 'from' : 'to')
  ],
  [
    ['+', '=', '-'], '+ −', 'zoom in, out about the crosshair',
    (state, {key}) => state.scale(key === '-' ? 2 : 0.5, state.at)
  ],
  [
    ['PageUp', 'PageDown'], 'Page ↑ ↓', 'half a view earlier, later',
    (state, {key}) => state.move(key === 'PageUp' ? -0.5 : 0.5)
  ],
  [['0'], '0', 'the whole run', (state) => state.showAll()],
  [['Escape'], 'Esc', 'take the crosshair away', (state) => state.point(null)],
];

/** Handles these keys. */
export function listenToKeys(plot, state) {
  plot.addEventListener('keydown', (event) => {
    if (event.target !== plot || event.ctrlKey || event.altKey || event.metaKey) return;
    const found = actions.find(([keys]) => keys.includes(event.key));
    if (!found) return;
    event.preventDefault();
    found[3](state, event);
  });
}

export function keyHelp() {
  const pointer = [
    ['drag', 'show a part of the time; with Shift, or by a finger: move'],
    ['wheel', 'zoom, once the plot was clicked, or with Ctrl; with Shift: move'],
    ['double click', 'the whole run'],
  ];
  const keys = actions.map(([, name, does]) => [name, does]);
  return details('Pointer and keys', facts([...pointer, ...keys]));
}
