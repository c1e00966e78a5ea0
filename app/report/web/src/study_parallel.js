// Parallel coordinates of a study: every run is a line through its varied keys and its score.
import {controls} from './elements.js';
import {section} from './page.js';
import {figure, ink} from './plots.js';
import {isNumber} from './statistics.js';
import {axisOf, isDrawn, levelTicks, namesOf, scoreChoice, sideTitle} from './study_axes.js';

// Levels of keys stand at equal distances: keys such as 1, 10, 100 or words would otherwise crowd.
function dimensionOf(axis, rows, kept, isScore) {
  const label = {label: axis.label}, constraint = kept.has(axis.name) ? {constraintrange: kept.get(axis.name)} : {};
  if (isScore) return {...label, values: rows.map(axis.of), ...constraint};
  return {
    ...label,
    ...levelTicks(axis),
    range: [0, Math.max(1, axis.levels.length - 1)],
    values: rows.map((row) => axis.position.get(axis.of(row))),
    ...constraint,
  };
}

function parallelDrawing(axes, base, kept) {
  const score = axes[axes.length - 1], rows = base.filter((row) => isNumber(score.of(row)));
  const colorbar = {title: {...sideTitle(score), side: 'right'}, thickness: 12};
  const trace = {
    type: 'parcoords',
    dimensions: axes.map((axis) => dimensionOf(axis, rows, kept, axis === score)),
    labelangle: -12,
    labelfont: {color: ink()},
    tickfont: {color: ink()},
    rangefont: {color: ink()},
    line: {color: rows.map(score.of), colorscale: 'Cividis', showscale: true, colorbar},
  };
  return {traces: [trace], layout: {height: 440, margin: {l: 70, r: 30, t: 90, b: 30}}};
}

// Does a run pass all ranges that were dragged along the axes? Null where there are none.
function testOf(axes, kept) {
  const score = axes[axes.length - 1];
  const tests = axes.filter((axis) => kept.has(axis.name)).map((axis) => {
    const range = kept.get(axis.name), ranges = Array.isArray(range[0]) ? range : [range];
    const of = axis === score ? axis.of : (row) => axis.position.get(axis.of(row));
    return (row) => ranges.some(([low, high]) => of(row) >= low && of(row) <= high);
  });
  return tests.length ? (row) => tests.every((test) => test(row)) : null;
}

export function drawParallel({study, shown, restrict}) {
  const keys = namesOf(study, 'varied'), kept = new Map();  // ranges dragged along an axis, by its name
  let score = study.standard_score, axes = [];
  const element = figure('Parallel coordinates: every run is a line through its varied keys and its score', () => {
    axes = [...keys, score].map((key) => axisOf(study, key));
    return parallelDrawing(axes, shown.base, kept);
  }, 'Drag along an axis to keep the runs that pass there; click the axis to keep all again.');
  // What was dragged filters the table and the plots below.
  const dragged = () => {
    kept.clear();
    element.plot.data[0].dimensions.forEach(({constraintrange}, i) => {
      if (constraintrange && constraintrange.length) kept.set(axes[i].name, constraintrange);
    });
    restrict(testOf(axes, kept));
  };
  element.ready.then(() => element.plot.on('plotly_restyle', dragged));
  const pick = scoreChoice(study, score, (name) => {
    kept.delete(score);
    score = name;
    element.redraw();
  });
  section('parallel', 'Parallel coordinates', controls(pick), element);
  shown.listeners.push((own) => {
    if (!own && isDrawn(element)) element.redraw();
  });
}
