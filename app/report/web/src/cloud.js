// Local models as a cloud of points: figures, their legend and controls, pointing and picking.
import {flatFigure, groupColour} from './cloud_figures.js';
import {check, choice, choiceIfAny, controls, h, swatch} from './elements.js';
import {array} from './page_data.js';
import {onFirstDrawing} from './plots.js';
import {digits, WindowCloud} from './window_cloud.js';

const still_px = 4;  // a press that moves less is a click

async function loadWindows(windows) {
  const all = (places) => Promise.all(places.map(array));
  const [run, begin, end, label, mode] =
      await all([windows.run, windows.begin, windows.end, windows.label, windows.mode]);
  const covariance = windows.covariance ? await all(windows.covariance) : null;
  return {run, begin, end, label, mode, covariance, values: await all(windows.values)};
}

// Number of the window under the pointer; -1 where there is none.
function windowAt(event) {
  const p = event.points && event.points[0];
  if (!p) return -1;
  const i = Number.isInteger(p.customdata) ? p.customdata : (p.data.customdata || [])[p.pointNumber];
  return Number.isInteger(i) ? i : -1;
}

// Text beside the pointer. A text per point would take seconds for many windows: the tip is made when it is needed.
function makeTip(cloud) {
  const tip = h('div', {class: 'tip', hidden: true});
  document.body.append(tip);
  return {
    hide: () => {
      tip.hidden = true;
    },
    follow: (event) => {
      tip.style.left = `${Math.min(event.clientX + 14, window.innerWidth - 240)}px`;
      tip.style.top = `${event.clientY + 14}px`;
    },
    show: (i) => {
      const line = (a) => h('div', {}, `${cloud.windows.axes[a].name} = ${digits(cloud.values[a][i])}`);
      tip.replaceChildren(cloud.place(i), ...cloud.axes.map(line));
      tip.hidden = false;
    },
  };
}

// Reads the window under the pointer and picks one by a click. `reader`: tell(i), pick(i), picked().
function listen(element, tip, reader) {
  const {plot} = element;
  let pointed = -1, down = null;
  plot.on('plotly_hover', (event) => {
    const i = windowAt(event);
    if (i < 0) return;
    pointed = i;
    reader.tell(i);
    tip.show(i);
  });
  plot.on('plotly_unhover', () => {
    tip.hide();
    pointed = -1;
  });
  plot.addEventListener('mousemove', tip.follow);
  plot.addEventListener('mouseleave', tip.hide);
  // A finger hovers over nothing: there Plotly's own click says where it was.
  plot.on('plotly_click', (event) => {
    const i = windowAt(event);
    if (i >= 0 && i !== reader.picked()) reader.pick(i);
  });
  // Plotly tells a click from a drag by luck while a page draws: a press that does not move is a click.
  plot.addEventListener('pointerdown', (event) => {
    down = {x: event.clientX, y: event.clientY, i: pointed};
  }, true);
  plot.addEventListener('pointerup', (event) => {
    const still = down && Math.hypot(event.clientX - down.x, event.clientY - down.y) < still_px;
    if (still && down.i >= 0) setTimeout(reader.pick, 0, down.i);
    down = null;
  }, true);
}

// The groups of windows with their colours; each hides and shows by its button.
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
  const names = windows.axes.map((axis) => (axis.unit ? `${axis.name} [${axis.unit}]` : axis.name));
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

// `windows`: C++'s windows_section. `runs`: names of runs. `goTo(run, begin, end)`: shows that stretch of data.
// Returns the elements, top to bottom.
export async function drawCloud(windows, runs, goTo) {
  const cloud = new WindowCloud(windows, await loadWindows(windows), runs);
  const flat = flatFigure(cloud);
  if (!flat) return [];
  const redraw = () => flat.update();
  const info =
      h('p', {class: 'note', id: 'window-info', 'aria-live': 'polite'},
        'Point at a window to read it; click it to see its stretch of the data.');
  const reader = {
    tell: (i) => {
      info.textContent = cloud.described(i);
    },
    picked: () => cloud.picked,
    pick: (i) => {
      cloud.picked = i;
      reader.tell(i);
      redraw();
      goTo(cloud.run[i], cloud.begin[i], cloud.end[i]);
    },
  };
  const tip = makeTip(cloud);
  onFirstDrawing(flat, () => listen(flat, tip, reader));
  const legend = makeLegend(cloud, redraw);
  return [makeControls(cloud, redraw, legend.fill), legend.list, info, flat];
}
