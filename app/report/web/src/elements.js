// Functions that make elements of the pages. Data from archives become text (textContent), never markup.
import {shade} from './colour.js';

function fill(element, attributes, children) {
  for (const [name, given] of Object.entries(attributes)) {
    if (given === null || given === undefined || given === false) continue;
    if (name.startsWith('on')) {
      element.addEventListener(name.slice(2), given);
    } else {
      element.setAttribute(name, given === true ? '' : given);
    }
  }
  for (const child of children.flat(Infinity)) {
    if (child !== null && child !== undefined) element.append(child);
  }
  return element;
}

// Makes an HTML element: h('p', {class: 'soft'}, 'text', child, ...). Strings become text. null and undefined are
// skipped.
export function h(tag, attributes = {}, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

// Makes an SVG element: s('circle', {r: 2}, 'text', child).
export function s(tag, attributes = {}, ...children) {
  return fill(document.createElementNS('http://www.w3.org/2000/svg', tag), attributes, children);
}

// An element with the text from C++ (numbers.hpp). Its data-value is the exact value.
export function value(cell, tag = 'span') {
  if (cell === null || cell === undefined) return h(tag, {}, '–');
  if (cell instanceof Node || typeof cell !== 'object') return h(tag, {}, cell instanceof Node ? cell : String(cell));
  return h(tag, {'data-value': JSON.stringify(cell.v)}, cell.t);
}

export function facts(pairs) {
  const said = pairs.filter(([, text]) => text !== null && text !== undefined && text !== '');
  return h(
      'dl', {class: 'facts'},
      said.map(
          ([name, text]) =>
              [h('dt', {}, name),
               h('dd', {}, text instanceof Node ? text : String(text)),
  ]));
}

export function note(text, bad = false) {
  return h('p', {class: bad ? 'note bad' : 'note'}, text);
}

/** A swatch in a colour of look.js; `opacity`: that of the drawing. */
export const swatch = (colour, opacity = 1) =>
    h('span', {class: 'swatch', style: `background:${shade(colour)};opacity:${opacity}`});

// `entries`: a list of [colour, text, opacity].
export function legend(entries, label = 'Colours') {
  return h(
      'ul', {class: 'legend', 'aria-label': label},
      entries.map(([colour, text, opacity]) => h('li', {}, swatch(colour, opacity), text)));
}

// For a page that has no access to the clipboard, such as one opened from a file.
function copyByHand(text) {
  const area = h('textarea', {style: 'position:fixed;opacity:0'});
  area.value = text;
  document.body.append(area);
  area.select();
  const copied = document.execCommand('copy');
  area.remove();
  return copied;
}

// `given`: the text, or a function that makes it on demand.
export function copyButton(label, given) {
  const button = h('button', {type: 'button', class: 'copy'}, label);
  const done = (word) => {
    button.textContent = word;
    setTimeout(() => {
      button.textContent = label;
    }, 1500);
  };
  const byHand = (text) => done(copyByHand(text) ? 'Copied' : 'Not allowed');
  button.addEventListener('click', () => {
    const text = typeof given === 'function' ? given() : given;
    if (!navigator.clipboard) return byHand(text);
    return navigator.clipboard.writeText(text).then(() => done('Copied'), () => byHand(text));
  });
  return button;
}

export const controls = (...children) => h('div', {class: 'controls'}, children);

// A drop-down list. `choices`: texts. onchange receives the index of the choice.
export function choice(label, choices, chosen, onchange) {
  const options = choices.map((text, i) => h('option', {value: i, selected: i === chosen}, text));
  const select = h('select', {onchange: () => onchange(select.selectedIndex)}, options);
  return h('label', {}, label, select);
}

// Same as `choice` if there are at least two choices, else nothing.
export function choiceIfAny(label, choices, chosen, onchange) {
  return choices.length > 1 ? choice(label, choices, chosen, onchange) : null;
}

export function check(label, chosen, onchange) {
  const box = h('input', {type: 'checkbox', checked: chosen, onchange: () => onchange(box.checked)});
  return h('label', {}, box, label);
}

export function details(summary, ...content) {
  return h('details', {}, h('summary', {}, summary), content);
}
