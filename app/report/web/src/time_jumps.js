// Buttons that jump to interesting samples: the largest errors of a filter, and changes of the most probable mode.
import {h} from './elements.js';
import {secondsText, shortNumber} from './number_text.js';
import {array} from './page_data.js';

const stretches = 2000;  // largest number of parts of a run; each part has one largest error
const most_worst = 20;

const finest = (signal) => (signal.raw ? {bucket: 1, low: signal.raw, high: signal.raw} : signal.levels[0]);

/**
 * The largest value of each part with its index, the largest first. @returns {{at: number, value: number}[]}
 */
export function greatest(values, count = most_worst) {
  const length = Math.max(1, Math.ceil(values.length / stretches)), found = [];
  for (let from = 0; from < values.length; from += length) {
    let at = -1;
    for (let i = from; i < Math.min(values.length, from + length); ++i) {
      if (!Number.isNaN(values[i]) && (at < 0 || values[i] > values[at])) at = i;
    }
    if (at >= 0) found.push({at, value: values[at]});
  }
  return found.sort((a, b) => b.value - a.value).slice(0, count);
}

/** Indices where another share becomes the largest. @returns {number[]} */
export function changes(shares) {
  const found = [], n = shares[0].length;
  let last = -1;
  for (let i = 0; i < n; ++i) {
    let best = 0;
    for (let k = 1; k < shares.length; ++k) {
      if (shares[k][i] > shares[best][i]) best = k;
    }
    if (Number.isNaN(shares[best][i])) continue;
    if (last >= 0 && best !== last) found.push(i);
    last = best;
  }
  return found;
}

/** Times of a filter's worst samples with their NIS, the worst first. */
async function worstOf(filter, clock) {
  const level = finest(filter.nis), values = await array(level.high);
  return greatest(values).map(({at, value}) => ({t: clock.at(at * level.bucket), value}));
}

async function switchesOf(filter, clock) {
  const levels = filter.probability.map(finest), shares = await Promise.all(levels.map((level) => array(level.low)));
  return changes(shares).map((i) => clock.at(i * levels[0].bucket));
}

/** In ascending times the next one after t, or the previous one; null if there is none. */
export function beside(times, t, direction) {
  const list = direction > 0 ? times.find((time) => time > t) : [...times].reverse().find((time) => time < t);
  return list === undefined ? null : list;
}

/**
 * Buttons and keys for jumps. `of`: run => its filter.\n@returns {{buttons: HTMLElement[], said: HTMLElement, keys:
 * {key: string, name: string, does: string, act: () =>\n    unknown}[]}}
 */
export function timeJumps(state, of) {
  const said = h('p', {class: 'soft', 'aria-live': 'polite'});
  let last = {filter: null, number: 0};
  const worst = async () => {
    const filter = of(state.current);
    if (!filter) return;
    const list = await worstOf(filter, await state.clock());
    if (!list.length) return;
    last = {filter, number: last.filter === filter ? (last.number + 1) % list.length : 0};
    const {t, value} = list[last.number];
    await state.jump(t);
    said.textContent =
        `Worst sample ${last.number + 1} of ${list.length}: NIS ${shortNumber(value, 4)} at ${secondsText(t)}.`;
  };
  const switching = (direction) => async () => {
    const filter = of(state.current);
    if (!filter || !filter.probability) return;
    const times = await switchesOf(filter, await state.clock()), [from, to] = state.shown();
    const t = beside(times, state.at === null ? (from + to) / 2 : state.at, direction);
    if (t !== null) await state.jump(t);
    const which = `${direction > 0 ? 'later' : 'earlier'} change of the likeliest mode`;
    said.textContent = t === null ? `No ${which}.` : `A ${which}, at ${secondsText(t)}; ${times.length} in this run.`;
  };
  const keys = [
    {key: 'w', name: 'w', does: 'the next of the worst samples, by NIS', act: worst},
    {key: 'n', name: 'n', does: 'the next change of the likeliest mode', act: switching(1)},
    {key: 'p', name: 'p', does: 'the previous one', act: switching(-1)},
  ];
  const button = (text, act) => h('button', {type: 'button', onclick: act}, text);
  const buttons = [
    button('Next worst sample', worst), button('Previous mode switch', switching(-1)),
    button('Next mode switch', switching(1))
  ];
  return {buttons, said, keys};
}
