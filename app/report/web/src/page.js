// The parts that every page has: head, contents, theme.
import {h} from './elements.js';
import {finishWhenIdle} from './finishing.js';

// A section of the page, with its entry in the contents.
export function section(id, title, ...content) {
  const heading = h('h2', {id: `${id}-title`}, title);
  const element = h('section', {id, 'aria-labelledby': `${id}-title`}, heading, content);
  document.getElementById('main').append(element);
  let list = document.querySelector('#contents ul');
  if (!list) {
    list = h('ul');
    document.getElementById('contents').append(list);
  }
  list.append(h('li', {}, h('a', {href: `#${id}`}, title)));
  return element;
}

const darkWanted = () => matchMedia('(prefers-color-scheme: dark)');
const listeners = [];
export function onTheme(listener) {
  listeners.push(listener);
}
export function dark() {
  const forced = document.documentElement.dataset.theme;
  return forced ? forced === 'dark' : darkWanted().matches;
}
const markTheme = () => {
  document.documentElement.dataset.drawn = dark() ? 'dark' : 'light';
};
const announce = () => {
  markTheme();
  listeners.forEach((listener) => listener());
};

// Figures to draw while the browser is idle.
const unfinished = [];
// `place`: the element that contains the drawing.
export function drawWhenIdle(finish, place = null) {
  unfinished.push({finish, place});
}

function themeSwitch() {
  const button = h('button', {type: 'button', id: 'theme'});
  const label = () => {
    button.textContent = dark() ? 'Light' : 'Dark';
    button.setAttribute('aria-label', `Switch to ${dark() ? 'light' : 'dark'} colours`);
  };
  const change = () => {
    label();
    announce();
  };
  button.addEventListener('click', () => {
    document.documentElement.dataset.theme = dark() ? 'light' : 'dark';
    change();
  });
  darkWanted().addEventListener('change', change);
  label();
  return button;
}

export function head(title, subtitle) {
  const name =
      h('div', {style: 'min-width:0'}, h('h1', {}, title), subtitle ? h('div', {class: 'soft'}, subtitle) : null);
  document.getElementById('top').append(name, themeSwitch());
  markTheme();
}

// Resolves when the whole page is parsed. This script starts before the browser has read the arrays after it.
const parsed = () => new Promise((resolve) => {
  if (document.readyState !== 'loading') resolve();
  document.addEventListener('DOMContentLoaded', resolve);
});

// Resolves after the next painting, or after 300 ms, because a hidden page is never painted.
const painted = () => new Promise((resolve) => {
  requestAnimationFrame(() => setTimeout(resolve, 0));
  setTimeout(resolve, 300);
});

// Runs the script of a page. `first` is drawn and visible before the other data are read. Errors are shown and then
// thrown again, so that tests detect them.
export async function draw(body, first = () => undefined) {
  try {
    first();
    await painted();
    performance.mark('first screen');
    await parsed();
    await body();
    document.documentElement.dataset.ready = 'true';
    finishWhenIdle(unfinished);
  } catch (error) {
    const text = `This page could not be drawn: ${error.message}`;
    document.getElementById('main').append(h('p', {class: 'failure note bad', role: 'alert'}, text));
    throw error;
  }
}
