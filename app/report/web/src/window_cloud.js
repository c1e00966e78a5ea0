// Local models as points of a cloud: their groups, Gaussians and visibility. This file does not draw.
import {part} from './ellipse.js';
import {modeTitle, rankOf} from './mode_names.js';

/**
 * @typedef {{label: Int32Array|null, mode: Int32Array|null, values: Float32Array[]}} WindowArrays
 */

export class WindowCloud {
  /**
   * @param {any} windows C++'s windows_section
   * @param {WindowArrays} arrays from loadWindows
   */
  constructor(windows, arrays) {
    this.windows = windows;
    this.label = arrays.label;
    this.mode = arrays.mode;
    this.values = arrays.values;
    this.count = this.values[0].length;
    this.axes = windows.default_axes;
    this.by = this.firstGrouping();
    this.showAll = false;  // whether outlying windows are also shown
    this.showBank = true;
    this.hidden = new Set();  // hidden groups
  }

  firstGrouping() {
    if (this.mode && (this.windows.refined || !this.label)) return 'mode';
    return this.label ? 'component' : 'none';
  }

  groupings() {
    return [['component', this.label], ['mode', this.mode]].filter(([, list]) => list).map(([name]) => name);
  }

  groupOf(i) {
    const list = {component: this.label, mode: this.mode, none: null}[this.by];
    return list ? list[i] : -1;
  }

  // [group, its windows]. Windows without a group come first, then components in order, or modes by use.
  groups() {
    const lists = new Map();
    for (let i = 0; i < this.count; ++i) {
      const key = this.groupOf(i);
      if (!lists.has(key)) lists.set(key, []);
      lists.get(key).push(i);
    }
    const place = (key) => (key >= 0 && this.by === 'mode' ? rankOf(key) : key);
    return [...lists.entries()].sort(([a], [b]) => place(a) - place(b));
  }

  groupName(key) {
    if (key >= 0) return this.by === 'mode' ? modeTitle(key) : `${this.by} ${key}`;
    return this.by === 'none' ? 'windows' : 'not clustered';
  }

  // The extent of a group along the axes.
  reach(list, axes) {
    const some = list.filter((_, j) => j % Math.max(1, Math.floor(list.length / 300)) === 0);
    return axes.reduce((product, a) => {
      const middle = some.reduce((sum, i) => sum + this.values[a][i], 0) / some.length;
      return (product * some.reduce((sum, i) => sum + Math.abs(this.values[a][i] - middle), 0)) / some.length;
    }, 1);
  }

  // The visible groups. Wide groups are drawn first, so that they do not hide narrow groups.
  shownGroups(axes) {
    return this.groups()
        .filter(([key]) => !this.hidden.has(key))
        .map(([key, list]) => ({key, list, reach: key < 0 ? Infinity : this.reach(list, axes)}))
        .sort((a, b) => b.reach - a.reach);
  }

  // Whether all axes are parameters. Only parameters exist in the bank.
  parametersOnly(axes) {
    return axes.every((a) => a < this.windows.parameters);
  }

  // The Gaussians of the visible groups: mixture components, or the bank's modes with their covariance.
  ellipses(axes) {
    const {components, bank, parameters, axes: named} = this.windows;
    if (this.by === 'none') return [];
    const ofComponents = this.by === 'component';
    const groups = ofComponents ? components.list : bank || [];
    const places = axes.map((a) => {
      if (ofComponents) return components.features.indexOf(named[a].name);
      return a < parameters ? a : -1;
    });
    if (places.some((place) => place < 0)) return [];
    return groups.map((group, k) => ({group, k}))
        .filter(({group, k}) => group.covariance && !this.hidden.has(k))
        .map(({group, k}) => ({k, mean: places.map((p) => group.mean[p]), covariance: part(group.covariance, places)}));
  }
}
