// The paper's figure 5: samples outside the interval, above and below, training and held out, over the values of a key.
import {choice, controls, h} from './elements.js';
import {kindNames, otherFilters, shortNames, sidesOf} from './filters.js';
import {section} from './page.js';
import {dashedLine, figure, ink, palette, plain} from './plots.js';
import {isNumber, mean} from './statistics.js';
import {axisOf, follow, namesOf, positionOf} from './study_axes.js';

const title = 'Samples outside the interval';
const true_share = 2.5;  // per cent on either side, as a true filter has
const sides = [['above', 1], ['below', -1]];
const roles = [['train', 'training', palette.modes[0]], ['test', 'held out', palette.modes[1]]];

// [name, filter, its runs]: competitors over all runs, the bank by level of a key.
function groupsOf(axis, filters, rows) {
  const ofLevel = (level) => rows.filter((row) => axis.of(row) === level);
  return [
    ...filters.map((name) => [shortNames[name], name, rows]),
    ...axis.levels.map((level) => [String(level), 'bank', ofLevel(level)]),
  ];
}

// Mean share in per cent; null where the study has no such score.
function averageOf(study, rows, score) {
  if (!namesOf(study, 'score').includes(score)) return null;
  const values = rows.map(axisOf(study, score).of).filter(isNumber);
  return values.length ? 100 * mean(values) : null;
}

/**
 * @param {any} study
 * @param {any[]} groups
 * @param {string} measure
 * @param {any[]} side
 * @param {string[]} role
 */
function coverageBars(study, groups, measure, [side, sign], [role, name, colour]) {
  const y = groups.map(([, filter, rows]) => averageOf(study, rows, `${filter}_${role}_${sidesOf[measure][side]}`));
  const said = (v, i) => `${plain(groups[i][0])}, ${name}, ${side}: ${v === null ? '–' : v.toPrecision(4)} %`;
  return {
    type: 'bar',
    name,
    legendgroup: name,
    showlegend: sign > 0,
    offsetgroup: role,
    x: groups.map((_, i) => i),
    y: y.map((v) => (v === null ? null : sign * v)),
    meta: `${role} ${side}`,
    text: y.map(said),
    textposition: 'none',
    hoverinfo: 'text',
    marker: {color: colour},
  };
}

/**
 * @param {any} study
 * @param {any} axis
 * @param {string[]} measure
 * @param {any[]} rows
 */
function coverageDrawing(study, axis, [measure, measureName], rows) {
  const scores = namesOf(study, 'score');
  const filters = otherFilters.filter((name) => scores.includes(`${name}_train_${sidesOf[measure].above}`));
  const groups = groupsOf(axis, filters, rows), line = {color: ink(), width: 1, dash: 'dash'};
  const traces = sides.flatMap((side) => roles.map((role) => coverageBars(study, groups, measure, side, role)));
  const layout = {
    height: 380,
    barmode: 'group',
    legend: {orientation: 'h', y: 1.1},
    margin: {l: 60, r: 10, t: 30, b: 60},
    shapes: [dashedLine(true_share, {line}), dashedLine(-true_share, {line})],
    xaxis: {
      tickvals: groups.map((_, i) => i),
      ticktext: groups.map(([name]) => plain(name)),
      title: {text: `filter, then the bank by ${axis.label}`},
    },
    yaxis: {title: {text: `${measureName} below | above [%]`}, zeroline: true, zerolinewidth: 2},
  };
  return {traces, layout};
}

export function drawCoverage(context) {
  const {study, shown} = context;
  const scores = namesOf(study, 'score'), keys = namesOf(study, 'varied');
  const known = ([key]) => ['test', 'train'].some((role) => scores.includes(`bank_${role}_${sidesOf[key].above}`));
  const measures = kindNames.filter(known);
  if (!measures.length || !keys.length) {
    section('coverage', title, h('p', {}, 'The study has no such scores.'));
    return;
  }
  let key = keys[positionOf(keys, 'mixture.components')], [measure] = measures;
  const label =
      'Shares of samples outside the 95 % interval, above and below, training and held out, for the baseline, ' +
      'noise only and each value of a key';
  const element = figure(
      label, () => coverageDrawing(study, axisOf(study, key), measure, shown.rows),
      'Means over the runs shown. Dashed: 2.5 % on either side, as a true filter has.');
  const pickKey = choice('Over', keys, keys.indexOf(key), (i) => {
    key = keys[i];
    element.redraw();
  });
  const pickMeasure = choice('By', measures.map(([, name]) => name), 0, (i) => {
    measure = measures[i];
    element.redraw();
  });
  section('coverage', title, controls(pickKey, pickMeasure), element);
  follow(context, element);
}
