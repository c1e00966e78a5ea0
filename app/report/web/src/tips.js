// Shows the definition of a term on hover and on focus, in the same words as `modebank help TERM`.
import {h} from './elements.js';
import {meaningOf, termsIn} from './terms.js';

let shown = null;

function tip() {
  let element = document.getElementById('term-tip');
  if (!element) {
    element = h('div', {id: 'term-tip', class: 'tip', role: 'tooltip', hidden: true});
    document.body.append(element);
    addEventListener('keydown', (event) => {
      if (event.key === 'Escape') hide();
    });
    addEventListener('scroll', () => hide(), {passive: true, capture: true});
  }
  return element;
}

function hide() {
  shown = null;
  tip().hidden = true;
}

function show(element, meaning) {
  const box = element.getBoundingClientRect(), label = tip();
  shown = element;
  label.textContent = meaning;
  label.hidden = false;
  label.style.left = `${Math.max(8, Math.min(box.left, innerWidth - label.offsetWidth - 8))}px`;
  const below = box.bottom + 6;
  label.style.top =
      `${below + label.offsetHeight < innerHeight ? below : Math.max(8, box.top - label.offsetHeight - 6)}px`;
}

/** Gives `element`, which must be focusable, a tip with its meaning; screen readers read it as the description. */
export function describe(element, meaning) {
  if (!meaning) return element;
  element.classList.add('term');
  element.setAttribute('aria-description', meaning);
  element.addEventListener('pointerenter', () => show(element, meaning));
  element.addEventListener('focus', () => show(element, meaning));
  element.addEventListener('click', () => show(element, meaning));
  for (const end of ['pointerleave', 'blur']) {
    element.addEventListener(end, () => {
      if (shown === element) hide();
    });
  }
  return element;
}

const term = (text, meaning) => describe(h('span', {tabindex: 0}, text), meaning);

/** A heading with a tip: the whole text is the term, apart from its unit. */
export const headingWithTip = (text) => (meaningOf(text) ? term(text, meaningOf(text)) : text);

/** A sentence in parts: the first mention of each term has a tip. */
export const withTips = (text) =>
    termsIn(String(text || '')).map(({part, meaning}) => (meaning ? term(part, meaning) : part));
