// Local models as a cloud of points: the figure, its legend and its controls.
import {cloudFigure, groupColour} from './cloud_figures.js';
import {check, choice, choiceIfAny, controls, h, swatch} from './elements.js';
import {array} from './page_data.js';
import {titleOf} from './time_rows.js';
import {WindowCloud} from './window_cloud.js';

async function loadWindows(windows) {
  const all = (places) => Promise.all(places.map(array));
  const [label, mode] = await all([windows.label, windows.mode]);
  return {label, mode, values: await all(windows.values)};
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

// `windows`: made by windows_section in C++. Returns the elements from top to bottom.
export async function drawCloud(windows) {
  const cloud = new WindowCloud(windows, await loadWindows(windows));
  const flat = cloudFigure(cloud);
  if (!flat) return [];
  const redraw = () => flat.update();
  const legend = makeLegend(cloud, redraw);
  return [makeControls(cloud, redraw, legend.fill), legend.list, flat];
}
