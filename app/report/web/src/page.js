// The parts that every page has: head, contents, theme.
import {h} from './elements.js';

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
export const dark = () => darkWanted().matches;
export function onTheme(listener) {
  darkWanted().addEventListener('change', listener);
}

// The theme in which canvases are drawn, for paper.
const markTheme = () => {
  document.documentElement.dataset.drawn = dark() ? 'dark' : 'light';
};

export function head(title, subtitle) {
  const name =
      h('div', {style: 'min-width:0'}, h('h1', {}, title), subtitle ? h('div', {class: 'soft'}, subtitle) : null);
  document.getElementById('top').append(name);
  markTheme();
  onTheme(markTheme);
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
  } catch (error) {
    const text = `This page could not be drawn: ${error.message}`;
    document.getElementById('main').append(h('p', {class: 'failure note bad', role: 'alert'}, text));
    throw error;
  }
}
