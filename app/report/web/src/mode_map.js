// Maps of the modes over states and inputs, for state-dependent transition probabilities.
import {figure} from './chart.js';
import {modeColour, palette} from './look.js';
import {modeTitle} from './mode_names.js';
import {byUse, othersName} from './modes.js';
import {titleOf} from './time_rows.js';

const percent = (share) => `${(100 * share).toFixed(0)} %`;

// The modes with their own entry, and all other modes as one entry: {name, colour, holds: mode => bool}.
function groupsOf(bank) {
  const {told, others} = byUse(bank);
  const own = ({mode}) => ({name: modeTitle(mode), colour: modeColour(mode), holds: (k) => k === mode});
  const rest = new Set(others.map(({mode}) => mode));
  const list = told.map(own);
  return rest.size ? [...list, {name: othersName(rest.size), colour: palette.unclustered, holds: (k) => rest.has(k)}] :
                     list;
}

// The samples in the colours of their modes. `y(i, row)`: the height of sample i in group `row`.
function sampleMarks(bank, x, y) {
  const {samples} = bank.modeMap;
  return groupsOf(bank).map(({name, colour, holds}, row) => {
    const own = samples.mode.map((mode, i) => i).filter((i) => holds(samples.mode[i]));
    return {kind: 'points', name, x: own.map(x), y: own.map((i) => y(i, row)), colour, opacity: 0.8, tip: () => name};
  });
}

// Background in the colour of the mode with the largest share.
function groundMark({axes, modes, shares}) {
  const [x, y] = axes.map(({values}) => values);
  const tip = (n) => {
    const i = Math.floor(n / x.length), j = n % x.length;
    return `${modeTitle(modes[i][j])}: ${percent(shares[i][j])} of the time`;
  };
  return {kind: 'cells', x, y, colours: modes.map((row) => row.map(modeColour)), opacity: 0.35, tip};
}

function map(bank) {
  const {modeMap} = bank, [x, y] = modeMap.samples.at;
  return {
    x: {title: titleOf(modeMap.axes[0])},
    y: {title: titleOf(modeMap.axes[1])},
    marks: [groundMark(modeMap), ...sampleMarks(bank, (i) => x[i], (i) => y[i])],
  };
}

// The samples are drawn below the lines, one row per mode. The most used modes are drawn last, so that other modes do
// not hide them.
function lines(bank) {
  const {modeMap} = bank, {values} = modeMap.axes[0];
  const rows = sampleMarks(bank, (i) => modeMap.samples.at[0][i], (i, row) => -0.05 - 0.05 * row);
  const curves = [...bank.order].reverse().map(
      (k) => ({kind: 'line', name: modeTitle(k), x: values, y: modeMap.lines[k], colour: modeColour(k), width: 2}));
  return {x: {title: titleOf(modeMap.axes[0])}, y: {title: 'share of the time'}, marks: [...curves, ...rows]};
}

/** `bank`: with state-dependent transitions. */
export function modeMapFigure(bank) {
  const {modeMap} = bank;
  const rest = modeMap.others ? ' Other states and inputs are at their training mean.' : '';
  const points = 'Points: samples of all runs, at the state and input before their step, in ' +
      'the colour of their most probable mode.';
  const means = modeMap.one ?
      'Lines: share of the time in each mode if state and input stayed there.' :
      'Background: the mode with the largest share of the time if state and input stayed there.';
  const keys = groupsOf(bank).map(({name, colour}) => [colour, name]);
  return figure(
      'Which states and inputs belong to which mode',
      () => ({panels: [modeMap.one ? lines(bank) : map(bank)], height: 340, legend: keys}),
      `${means}${rest} ${points}`);
}
