// What every page of the report is made with: its data, elements, tables, sections, theme.
// Whatever comes from an archive enters the page as text (textContent), never as markup.

export const data = JSON.parse(document.getElementById('page-data').textContent);

const types = { f4: [Float32Array, 4], f8: [Float64Array, 8], i4: [Int32Array, 4], share: [Uint16Array, 2] };
const unpacked = new Map();

function bytesOf(base64) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(base64);
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

async function unpack(place) {
  const stored = bytesOf(document.getElementById(place.id).textContent);
  const stream = new Blob([stored]).stream().pipeThrough(new DecompressionStream('deflate'));
  const planes = new Uint8Array(await new Response(stream).arrayBuffer());
  const [Type, width] = types[place.type], count = place.size, bytes = new Uint8Array(count * width);
  for (let b = 0; b < width; ++b)
    for (let i = 0, from = b * count, to = b; i < count; ++i, ++from, to += width) bytes[to] = planes[from];
  const values = new Type(bytes.buffer);
  return place.type === 'share' ? Float32Array.from(values, (v) => (v === 65535 ? NaN : v / 65534)) : values;
}

// The typed array that C++ (page_arrays.hpp) put into the page; unpacked once, on first need.
export function array(place) {
  if (!place) return Promise.resolve(null);
  if (!unpacked.has(place.id)) unpacked.set(place.id, unpack(place));
  return unpacked.get(place.id);
}

// h('p', {class: 'soft'}, 'text', child, ...): an element. Strings become text; null and undefined are left out.
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? '' : value);
  }
  for (const child of children.flat(Infinity))
    if (child !== null && child !== undefined) element.append(child);
  return element;
}

// A value as C++ formatted it (numbers.hpp), with the exact one in data-value.
export function value(cell, tag = 'span') {
  if (cell === null || cell === undefined) return h(tag, {}, '–');
  if (typeof cell !== 'object') return h(tag, {}, String(cell));
  return h(tag, { 'data-value': JSON.stringify(cell.v) }, cell.t);
}

const compare = (a, b) => {
  const x = a && typeof a === 'object' ? a.v : a, y = b && typeof b === 'object' ? b.v : b;
  if (x === null || x === undefined) return y === null || y === undefined ? 0 : 1;  // unknown values come last
  if (y === null || y === undefined) return -1;
  return typeof x === 'number' && typeof y === 'number' ? x - y : String(x).localeCompare(String(y), 'en', { numeric: true });
};

// columns: {name, text: true for words, prose: true for sentences, of: row => cell, swatch: row => colour}. options: caption, chosen: row => bool,
// sortable, onclick: row => {}.
export function table(columns, rows, options = {}) {
  const body = h('tbody');
  const headers = columns.map((column) => h('th', { scope: 'col', class: column.text || column.prose ? 'text' : null }));
  const fill = (list) => body.replaceChildren(...list.map((row) => {
    const line = h('tr', { class: options.chosen && options.chosen(row) ? 'chosen' : null });
    for (const column of columns) {
      const cell = value(column.of(row), 'td');
      if (column.text) cell.classList.add('text');
      if (column.prose) cell.classList.add('text', 'prose');
      if (column.swatch) cell.prepend(h('span', { class: 'swatch', style: `background:${column.swatch(row)}` }));
      line.append(cell);
    }
    if (options.onclick) {
      line.tabIndex = 0;
      line.addEventListener('click', () => options.onclick(row));
      line.addEventListener('keydown', (event) => { if (event.key === 'Enter') options.onclick(row); });
    }
    return line;
  }));
  headers.forEach((header, i) => {
    if (!options.sortable) return header.append(columns[i].name);
    header.append(h('button', { type: 'button', onclick: () => {
      const down = header.getAttribute('aria-sort') === 'ascending';
      headers.forEach((other) => other.removeAttribute('aria-sort'));
      header.setAttribute('aria-sort', down ? 'descending' : 'ascending');
      fill([...rows].sort((a, b) => (down ? -1 : 1) * compare(columns[i].of(a), columns[i].of(b))));
    } }, columns[i].name));
  });
  fill(rows);
  const element = h('table', {}, options.caption ? h('caption', {}, options.caption) : null, h('thead', {}, h('tr', {}, headers)), body);
  const scroll = h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': options.caption || 'table' }, element);
  scroll.show = fill;  // shows these rows instead, e.g. filtered ones
  return scroll;
}

export function facts(pairs) {
  return h('dl', { class: 'facts' }, pairs.filter(([, text]) => text !== null && text !== undefined && text !== '')
    .map(([name, text]) => [h('dt', {}, name), h('dd', {}, text instanceof Node ? text : String(text))]));
}

export function note(text, bad = false) { return h('p', { class: bad ? 'note bad' : 'note' }, text); }

export function copyButton(label, text) {
  const button = h('button', { type: 'button', class: 'copy' }, label);
  const done = (word) => { button.textContent = word; setTimeout(() => { button.textContent = label; }, 1500); };
  const byHand = () => {  // pages opened from a file may be refused the clipboard
    const area = h('textarea', { style: 'position:fixed;opacity:0' });
    area.value = text;
    document.body.append(area);
    area.select();
    const copied = document.execCommand('copy');
    area.remove();
    done(copied ? 'Copied' : 'Not allowed');
  };
  button.addEventListener('click', () => {
    if (!navigator.clipboard) return byHand();
    navigator.clipboard.writeText(text).then(() => done('Copied'), byHand);
  });
  return button;
}

// A drop-down; `choices` are texts, onchange gets the chosen position.
export function choice(label, choices, chosen, onchange) {
  const select = h('select', { onchange: () => onchange(select.selectedIndex) }, choices.map((text, i) => h('option', { value: i, selected: i === chosen }, text)));
  return h('label', {}, label, select);
}

export function check(label, chosen, onchange) {
  const box = h('input', { type: 'checkbox', checked: chosen, onchange: () => onchange(box.checked) });
  return h('label', {}, box, label);
}

// A section of the page with its entry in the contents.
export function section(id, title, ...content) {
  const element = h('section', { id, 'aria-labelledby': `${id}-title` }, h('h2', { id: `${id}-title` }, title), content);
  document.getElementById('main').append(element);
  let list = document.querySelector('#contents ul');
  if (!list) document.getElementById('contents').append(list = h('ul'));
  list.append(h('li', {}, h('a', { href: `#${id}` }, title)));
  return element;
}

const listeners = [];
export const dark = () => {
  const forced = document.documentElement.dataset.theme;
  return forced ? forced === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
};
export function onTheme(listener) { listeners.push(listener); }
const announce = () => {
  document.documentElement.dataset.drawn = dark() ? 'dark' : 'light';
  return Promise.all(listeners.map((listener) => listener()));
};

// What must be done before the page can be printed, e.g. drawing what is still out of sight.
const unfinished = [];
export function beforePrint(finish) { unfinished.push(finish); }

function printButton() {
  return h('button', { type: 'button', id: 'print', onclick: async () => {
    const root = document.documentElement, theme = root.dataset.theme;
    root.dataset.theme = 'light';
    root.dataset.printing = 'true';
    await Promise.all(unfinished.map((finish) => finish()));
    await announce();
    window.print();
    delete root.dataset.printing;
    if (theme) root.dataset.theme = theme; else delete root.dataset.theme;
    await announce();
  } }, 'Print');
}

function themeSwitch() {
  const button = h('button', { type: 'button', id: 'theme' });
  const label = () => { button.textContent = dark() ? 'Light' : 'Dark'; button.setAttribute('aria-label', `Switch to ${dark() ? 'light' : 'dark'} colours`); };
  button.addEventListener('click', () => { document.documentElement.dataset.theme = dark() ? 'light' : 'dark'; label(); announce(); });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { label(); announce(); });
  label();
  return button;
}

export function head(title, subtitle) {
  document.getElementById('top').append(h('div', { style: 'min-width:0' }, h('h1', {}, title), subtitle ? h('div', { class: 'soft' }, subtitle) : null), h('div', { class: 'buttons' }, printButton(), ' ', themeSwitch()));
  document.documentElement.dataset.drawn = dark() ? 'dark' : 'light';
}

// Runs what draws the page; a failure is shown and thrown on, so that tests see it.
export async function draw(body) {
  try {
    await body();
    document.documentElement.dataset.ready = 'true';
  } catch (error) {
    document.getElementById('main').append(h('p', { class: 'failure note bad', role: 'alert' }, `This page failed to draw itself: ${error.message}`));
    throw error;
  }
}
