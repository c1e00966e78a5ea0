// Local models as a cloud of points: the figure, its legend, its controls, and the choice of a window.
import {cloudFigure, groupColour} from './cloud_figures.js';
import {check, choice, choiceIfAny, controls, h, swatch} from './elements.js';
import {array} from './page_data.js';
import {titleOf} from './time_rows.js';
import {WindowCloud} from './window_cloud.js';

async function loadWindows(windows) {
  const all = (places) => Promise.all(places.map(array));
  const [run, begin, end, label, mode] =
      await all([windows.run, windows.begin, windows.end, windows.label, windows.mode]);
  const covariance = windows.covariance ? await all(windows.covariance) : null;
  return {run, begin, end, label, mode, covariance, values: await all(windows.values)};
}

// The groups of windows with their colours. Each group has a button that shows or hides it.
function makeLegend(cloud, redraw) {
  const list = h('ul', {class: 'legend', 'aria-label': 'Groups of windows; press to hide or show'});
  const entry = ([key, members]) => {
    const pressed = () => String(!cloud.hidden.has(key));
    const button =
        h('button', {
          type: 'button',
          'aria-pressed': pressed(),
          onclick: () => {
            if (!cloud.hidden.delete(key)) cloud.hidden.add(key);
            button.setAttribute('aria-pressed', pressed());
            redraw();
          }
        },
          swatch(groupColour(cloud, key)), `${cloud.groupName(key)} (${members.length})`);
    return h('li', {}, button);
  };
  const fill = () => list.replaceChildren(...cloud.groups().map(entry));
  fill();
  return {list, fill};
}

function makeControls(cloud, redraw, fillLegend) {
  const {windows} = cloud, bys = cloud.groupings();
  const names = windows.axes.map(titleOf);
  const set = (key) => (value) => {
    cloud[key] = value;
    redraw();
  };
  const axis = (a, j) => choice('XYZ'[j], names, a, (chosen) => {
    cloud.axes[j] = chosen;
    redraw();
  });
  const by = (i) => {
    cloud.by = bys[i];
    cloud.hidden.clear();
    fillLegend();
    redraw();
  };
  const groups = {mode: 'mode of the filter', component: 'mixture component'};
  return controls(
      names.length > 3 ? cloud.axes.map(axis) : null,
      choiceIfAny('Colour by', bys.map((name) => groups[name]), bys.indexOf(cloud.by), by),
      check('Outlying windows, too', false, set('showAll')),
      windows.bank ? check('Modes of the bank', true, set('showBank')) : null);
}

// `windows`: made by windows_section in C++. `runs`: names of the runs. `goTo(run, begin, end)`: shows this part of the
// data. Returns the elements from top to bottom.
export async function drawCloud(windows, runs, goTo) {
  const cloud = new WindowCloud(windows, await loadWindows(windows), runs);
  const info =
      h('p', {class: 'note', id: 'window-info', 'aria-live': 'polite'},
        'Point at a window to read it; click it to see its stretch of the data.');
  const flat = cloudFigure(cloud, (i) => {
    cloud.picked = i;
    info.textContent = cloud.described(i);
    redraw();
    goTo(cloud.run[i], cloud.begin[i], cloud.end[i]);
  });
  if (!flat) return [];
  const redraw = () => flat.update();
  const legend = makeLegend(cloud, redraw);
  return [makeControls(cloud, redraw, legend.fill), legend.list, info, flat];
}
