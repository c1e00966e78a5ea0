// Local models as a cloud: rotatable in three parameters, flat in their three projections.
import { array, check, choice, dark, h } from './common.js';
import { figure, ink, modeColour, palette, plain, translucent } from './plots.js';

const most = 6;  // significant digits of what a pointer shows

// Lower Cholesky factor of a small covariance; null when it is not one (a window that data do not determine).
function factor(matrix) {
  const n = matrix.length, L = matrix.map((row) => row.map(() => 0));
  for (let i = 0; i < n; ++i)
    for (let j = 0; j <= i; ++j) {
      let rest = matrix[i][j];
      for (let k = 0; k < j; ++k) rest -= L[i][k] * L[j][k];
      if (i === j && !(rest > 0)) return null;
      L[i][j] = i === j ? Math.sqrt(rest) : rest / L[j][j];
    }
  return L;
}
const sub = (matrix, axes) => axes.map((i) => axes.map((j) => matrix[i][j]));
const image = (center, L, scale, unit) => center.map((c, i) => c + scale * L[i].reduce((sum, l, j) => sum + l * unit[j], 0));
const circle = (steps) => Array.from({ length: steps + 1 }, (_, i) => [Math.cos((2 * Math.PI * i) / steps), Math.sin((2 * Math.PI * i) / steps)]);

// Three great circles of an ellipsoid, each followed by a gap.
function wires(center, matrix, limit, to) {
  const L = factor(matrix);
  if (!L) return;
  for (const [a, b] of [[0, 1], [0, 2], [1, 2]]) {
    for (const [c, s] of circle(28)) {
      const unit = [0, 0, 0];
      unit[a] = c; unit[b] = s;
      image(center, L, Math.sqrt(limit), unit).forEach((v, i) => to[i].push(v));
    }
    to.forEach((list) => list.push(null));
  }
}

// An ellipsoid's surface as a mesh of triangles.
function surface(center, matrix, limit, colour) {
  const L = factor(matrix);
  if (!L) return null;
  const rings = 10, sides = 18, x = [], y = [], z = [], i = [], j = [], k = [];
  for (let r = 0; r <= rings; ++r)
    for (let s = 0; s < sides; ++s) {
      const polar = (Math.PI * r) / rings, turn = (2 * Math.PI * s) / sides;
      const p = image(center, L, Math.sqrt(limit), [Math.sin(polar) * Math.cos(turn), Math.sin(polar) * Math.sin(turn), Math.cos(polar)]);
      x.push(p[0]); y.push(p[1]); z.push(p[2]);
      if (r === rings) continue;
      const a = r * sides + s, b = r * sides + ((s + 1) % sides);
      i.push(a, b); j.push(b, b + sides); k.push(a + sides, a + sides);
    }
  return { type: 'mesh3d', x, y, z, i, j, k, color: colour, opacity: 0.16, hoverinfo: 'skip', showlegend: false };
}

// Where nearly all values lie: some windows say nothing of a parameter and would hide the others.
function usualRange(values) {
  const step = Math.max(1, Math.floor(values.length / 20000)), sorted = values.filter((_, i) => i % step === 0).filter(Number.isFinite).sort();
  if (!sorted.length) return [-1, 1];
  const at = (share) => sorted[Math.round(share * (sorted.length - 1))], low = at(0.01), high = at(0.99), pad = 0.12 * (high - low) || 1e-9;
  return [low - pad, high + pad];
}

// `windows`: C++'s windows_section. `runs`: names of runs. `goTo(run, begin, end)`: shows that stretch of data.
export async function cloud(windows, runs, goTo) {
  const names = windows.axes.map((axis) => (axis.unit ? `${axis.name} [${axis.unit}]` : axis.name));
  const values = await Promise.all(windows.values.map(array));
  const [run, begin, end, label, mode] = await Promise.all([windows.run, windows.begin, windows.end, windows.label, windows.mode].map(array));
  const covariance = windows.covariance ? await Promise.all(windows.covariance.map(array)) : null;
  const features = windows.components ? windows.axes.map((axis) => windows.components.features.indexOf(axis.name)) : [];
  const dims = Math.min(3, names.length), state = { axes: windows.default_axes, shells: Math.max(windows.components?.list.length || 0, windows.bank?.length || 0) <= 6, by: mode && (windows.refined || !label) ? 'mode' : label ? 'component' : 'none', all: false, errors: false, bank: true, picked: -1, hidden: new Set() };
  const colourOf = () => (state.by === 'component' ? label : state.by === 'mode' ? mode : null);
  const digits = (v) => (Number.isFinite(v) ? Number(v.toPrecision(most)).toString() : '–');
  const place = (i) => `run ${runs[run[i]]}, ${begin[i].toFixed(3)} to ${end[i].toFixed(3)} s`;

  // Window numbers group by group: components or modes in order, those without one first.
  function groups() {
    const by = colourOf(), lists = new Map();
    for (let i = 0; i < run.length; ++i) {
      const key = by ? by[i] : -1;
      if (!lists.has(key)) lists.set(key, []);
      lists.get(key).push(i);
    }
    return [...lists.entries()].sort((a, b) => a[0] - b[0]);
  }
  const groupName = (key) => (key < 0 ? (state.by === 'none' ? 'windows' : 'not clustered') : `${state.by} ${key}`);
  const groupColour = (key) => (key < 0 ? palette.unclustered : modeColour(key));
  const entry = (i, a, b) => { const [row, column] = a >= b ? [a, b] : [b, a]; return covariance[(row * (row + 1)) / 2 + column][i]; };
  const windowMatrix = (i, axes) => axes.map((a) => axes.map((b) => entry(i, a, b)));
  const within = (axes) => axes.every((a) => a < windows.parameters);
  // The Gaussians behind the groups that are shown: mixture components, or the spread of the bank's modes.
  function shownEllipses(axes) {
    const from = state.by === 'component' ? windows.components.list : state.by === 'mode' ? windows.bank || [] : [];
    const position = (a) => (state.by === 'component' ? features[a] : a < windows.parameters ? a : -1);
    return from.map((group, k) => ({ ...group, k })).filter(({ k, covariance: c }) => c && !state.hidden.has(k) && axes.every((a) => position(a) >= 0))
      .map((group) => ({ k: group.k, mean: axes.map((a) => group.mean[position(a)]), covariance: sub(group.covariance, axes.map(position)) }));
  }

  // How far a group reaches over the axes: wide ones are drawn first, or they would hide the narrow ones.
  function reach(list, axes) {
    const some = list.filter((_, j) => j % Math.max(1, Math.floor(list.length / 300)) === 0);
    return axes.reduce((product, a) => {
      const mean = some.reduce((sum, i) => sum + values[a][i], 0) / some.length;
      return product * some.reduce((sum, i) => sum + Math.abs(values[a][i] - mean), 0) / some.length;
    }, 1);
  }
  function points(axes, type) {
    const order = groups().filter(([key]) => !state.hidden.has(key)).map(([key, list]) => [key, list, key < 0 ? Infinity : reach(list, axes)]).sort((a, b) => b[2] - a[2]);
    return order.map(([key, list]) => {
      const trace = { type, mode: 'markers', name: groupName(key), customdata: list, hoverinfo: 'none',
        marker: { size: type === 'scatter3d' ? 2.2 : run.length > 20000 ? 2.5 : 4, color: groupColour(key), opacity: key < 0 ? 0.3 : run.length > 20000 ? 0.35 : 0.65, line: { width: 0 } } };
      axes.forEach((a, j) => { trace['xyz'[j]] = Float32Array.from(list, (i) => values[a][i]); });
      return trace;
    });
  }
  function bankPoints(axes, type) {
    if (!windows.bank || !state.bank || !within(axes)) return [];
    const trace = { type, mode: 'markers', customdata: windows.bank.map(() => -1), hovertext: windows.bank.map((_, k) => `mode ${k} of the bank`), hoverinfo: 'text',
      marker: { symbol: 'diamond', size: type === 'scatter3d' ? 6 : 11, color: windows.bank.map((_, k) => modeColour(k)), line: { width: type === 'scatter3d' ? 1 : 1.5, color: ink() } } };
    axes.forEach((a, j) => { trace['xyz'[j]] = windows.bank.map((group) => group.mean[a]); });
    return [trace];
  }
  // Error ellipsoids: of the picked window, and of some dozens spread over all when asked for.
  function errorWires(axes) {
    if (!covariance || !within(axes)) return [];
    const some = state.errors ? Array.from({ length: Math.min(60, run.length) }, (_, j) => Math.floor((j * run.length) / Math.min(60, run.length))) : [];
    return [[some, translucent(ink(), 0.45), 1], [state.picked >= 0 ? [state.picked] : [], ink(), 4]].filter(([list]) => list.length).map(([list, color, width]) => {
      const to = [[], [], []];
      for (const i of list) wires(axes.map((a) => values[a][i]), windowMatrix(i, axes), windows.limit3, to);
      return { type: 'scatter3d', mode: 'lines', x: to[0], y: to[1], z: to[2], line: { color, width }, hoverinfo: 'skip' };
    });
  }
  const rangeOf = (a) => (state.all ? undefined : usualRange(values[a]));

  const solid = dims < 3 ? null : figure('Local models of all windows in three parameters; the tables of modes below hold the same information', () => {
    const axes = state.axes, scene = { dragmode: 'orbit', aspectmode: 'cube', camera: { eye: { x: 1.5, y: 1.5, z: 1 }, center: { x: 0, y: 0, z: -0.12 } }, uirevision: axes.join() };
    ['xaxis', 'yaxis', 'zaxis'].forEach((name, j) => { scene[name] = { title: { text: plain(names[axes[j]]) }, range: rangeOf(axes[j]), nticks: 5 }; });
    const meshes = (state.shells ? shownEllipses(axes) : []).map((c) => surface(c.mean, c.covariance, windows.limit3, modeColour(c.k))).filter(Boolean);
    return { traces: [...points(axes, 'scatter3d'), ...meshes, ...errorWires(axes), ...bankPoints(axes, 'scatter3d')], layout: { height: 520, margin: { l: 0, r: 0, t: 0, b: 0 }, scene, showlegend: false } };
  }, `Turn with the mouse or a finger. Shells hold ${100 * windows.level} % of a mixture component (of the spread of a mode, when coloured so); wires are the error ellipsoid of a window's estimate; diamonds are the modes of the bank.`);

  function ellipsePath(mean, matrix, limit) {
    const L = factor(matrix);
    return L ? circle(48).map((unit, i) => `${i ? 'L' : 'M'}${image(mean, L, Math.sqrt(limit), unit).join(',')}`).join('') + 'Z' : null;
  }
  const pairs = () => (state.axes.length < 2 ? [[0, 0]] : state.axes.length < 3 ? [state.axes] : [[0, 1], [0, 2], [1, 2]].map(([a, b]) => [state.axes[a], state.axes[b]]));
  const narrow = () => window.innerWidth < 700;
  const flat = names.length < 2 ? null : figure('The local models in two parameters at a time, with the ellipses of the mixture components', () => {
    const list = pairs(), type = run.length > 3000 ? 'scattergl' : 'scatter', traces = [], stacked = narrow();
    const layout = { height: stacked ? 330 * list.length : 380, margin: { l: 66, r: 12, t: 32, b: 48 }, showlegend: false, shapes: [] };
    list.forEach(([a, b], s) => {
      const n = s === 0 ? '' : s + 1, share = 1 / list.length, gap = stacked ? 0.06 : 0.05;
      const span = [s * share + (s ? gap : 0), (s + 1) * share - (s < list.length - 1 ? gap / 3 : 0)];
      layout[`xaxis${n}`] = { title: { text: plain(names[a]) }, range: rangeOf(a), anchor: `y${n}`, domain: stacked ? [0, 1] : span, nticks: 6, zeroline: false };
      layout[`yaxis${n}`] = { title: { text: plain(names[b]), standoff: 4 }, range: rangeOf(b), anchor: `x${n}`, domain: stacked ? [1 - span[1], 1 - span[0]] : [0, 1], nticks: 6, zeroline: false };
      for (const trace of [...points([a, b], type), ...bankPoints([a, b], type)]) traces.push({ ...trace, xaxis: `x${n}`, yaxis: `y${n}` });
      for (const c of shownEllipses([a, b])) {
        const path = ellipsePath(c.mean, c.covariance, windows.limit2);
        if (path) layout.shapes.push({ type: 'path', path, xref: `x${n}`, yref: `y${n}`, line: { color: modeColour(c.k), width: 2 }, layer: 'above' });
      }
      if (state.picked >= 0 && covariance && within([a, b])) {
        const path = ellipsePath([a, b].map((c) => values[c][state.picked]), windowMatrix(state.picked, [a, b]), windows.limit2);
        if (path) layout.shapes.push({ type: 'path', path, xref: `x${n}`, yref: `y${n}`, line: { color: ink(), width: 2, dash: 'dot' } });
      }
    });
    return { traces, layout };
  }, `Ellipses hold ${100 * windows.level} % of a mixture component, or of the spread of a mode’s windows.`);

  const figures = [solid, flat].filter(Boolean), redraw = () => Promise.all(figures.filter((f) => f.plot.on).map((f) => f.redraw()));
  const info = h('p', { class: 'note', id: 'window-info', 'aria-live': 'polite' }, 'Point at a window to read it; click it to see its stretch of the data.');
  const tell = (i) => info.replaceChildren(`Window in ${place(i)}: `,
    windows.axes.map((axis, a) => `${axis.name} = ${digits(values[a][i])}` + (covariance && a < windows.parameters ? ` ± ${digits(Number(Math.sqrt(entry(i, a, a)).toPrecision(2)))}` : '')).join(', '),
    label ? `; component ${label[i] < 0 ? 'none' : label[i]}` : '', mode ? `; mode of the filter ${mode[i] < 0 ? 'none' : mode[i]}` : '');
  let pointed = -1;
  const tip = h('div', { class: 'tip', hidden: true });
  document.body.append(tip);
  const pick = (i) => { state.picked = i; tell(i); redraw(); goTo(run[i], begin[i], end[i]); };
  for (const element of figures) {
    const first = element.redraw;
    element.redraw = async () => {
      const fresh = !element.plot.on;
      await first();
      if (!fresh) return;
      const numberOf = (event) => { const p = event.points?.[0]; if (!p) return -1; const i = p.customdata ?? p.data.customdata?.[p.pointNumber]; return Number.isInteger(i) ? i : -1; };
      // A text per point would take seconds for many windows: the tip is made when it is needed.
      element.plot.on('plotly_hover', (event) => {
        const i = numberOf(event);
        if (i < 0) return;
        tell(i);
        pointed = i;
        tip.replaceChildren(place(i), ...state.axes.map((a) => h('div', {}, `${windows.axes[a].name} = ${digits(values[a][i])}`)));
        tip.hidden = false;
      });
      element.plot.on('plotly_unhover', () => { tip.hidden = true; pointed = -1; });
      element.plot.addEventListener('mousemove', (event) => { tip.style.left = `${Math.min(event.clientX + 14, window.innerWidth - 240)}px`; tip.style.top = `${event.clientY + 14}px`; });
      element.plot.addEventListener('mouseleave', () => { tip.hidden = true; });
      // A finger hovers over nothing: there Plotly's own click says where it was.
      if (element !== solid) element.plot.on('plotly_click', (event) => { const i = numberOf(event); if (i >= 0 && i !== state.picked) pick(i); });
      // Plotly tells a click from a turn or a drag by luck while a page draws: a press that does not move is a click.
      let down = null;
      element.plot.addEventListener('pointerdown', (event) => { down = { x: event.clientX, y: event.clientY, i: pointed }; }, true);
      element.plot.addEventListener('pointerup', (event) => {
        if (down && down.i >= 0 && Math.hypot(event.clientX - down.x, event.clientY - down.y) < 4) setTimeout(pick, 0, down.i);
        down = null;
      }, true);
    };
  }

  const legend = h('ul', { class: 'legend', 'aria-label': 'Groups of windows; press to hide or show' });
  const fillLegend = () => legend.replaceChildren(...groups().map(([key, list]) => {
    const button = h('button', { type: 'button', 'aria-pressed': String(!state.hidden.has(key)), onclick: () => {
      if (!state.hidden.delete(key)) state.hidden.add(key);
      button.setAttribute('aria-pressed', String(!state.hidden.has(key)));
      redraw();
    } }, h('span', { class: 'swatch', style: `background:${groupColour(key)}` }), `${groupName(key)} (${list.length})`);
    return h('li', {}, button);
  }));
  fillLegend();
  const bys = [['component', label], ['mode', mode]].filter(([, list]) => list).map(([name]) => name);
  const controls = h('div', { class: 'controls' },
    names.length > 3 ? state.axes.map((a, j) => choice('XYZ'[j], names, a, (chosen) => { state.axes[j] = chosen; redraw(); })) : null,
    bys.length > 1 ? choice('Colour by', bys.map((name) => (name === 'mode' ? 'mode of the filter' : 'mixture component')), bys.indexOf(state.by), (i) => { state.by = bys[i]; state.hidden.clear(); fillLegend(); redraw(); }) : null,
    check('Outlying windows, too', false, (on) => { state.all = on; redraw(); }),
    (windows.components || windows.bank) && dims === 3 ? check('Shells', state.shells, (on) => { state.shells = on; redraw(); }) : null,
    covariance && dims === 3 ? check('Error ellipsoids of 60 windows', false, (on) => { state.errors = on; redraw(); }) : null,
    windows.bank ? check('Modes of the bank', true, (on) => { state.bank = on; redraw(); }) : null);
  return { elements: [controls, legend, solid, info, flat], pick };
}
