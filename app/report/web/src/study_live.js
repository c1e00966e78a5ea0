// The page of a study that still runs is written anew every few seconds; it reloads itself unless somebody is reading.
import {check, controls, h} from './elements.js';

const quiet_ms = 8000;  // since somebody last did something
const key = 'modebank-live';

// Where a file may not store anything, the choice lasts as long as the page.
function stored() {
  try {
    return sessionStorage.getItem(key) !== 'off';
  } catch {
    return true;
  }
}
function store(on) {
  try {
    sessionStorage.setItem(key, on ? 'on' : 'off');
  } catch {
    // then not
  }
}

// Filters would be lost, and with them what somebody looks at.
const filtered = () => [...document.querySelectorAll('tr.filters input')].some(
    (input) => /** @type {HTMLInputElement} */ (input).value);

// The section at the top of the window and how far it has been scrolled: heights are others until figures are drawn.
function placeNow() {
  const sections = [...document.querySelectorAll('main > section')];
  const section = sections.find((one) => one.getBoundingClientRect().bottom > 0) || sections[0];
  return {id: section.id, above: section.getBoundingClientRect().top};
}

// The place from before the last reload, until somebody scrolls. Figures that are drawn above it move it, and a slow
// machine reloads before they are all drawn: then the next page gets this place, not the one measured meanwhile.
/** @type {{id: string, above: number} | null} */
let kept = null;

function restorePlace() {
  const {place} = history.state || {}, section = place && document.getElementById(place.id);
  if (!section) return;
  kept = place;
  const settle = () => scrollBy(0, section.getBoundingClientRect().top - place.above);
  const watcher = new ResizeObserver(settle);
  watcher.observe(document.getElementById('main'));
  const release = () => {
    watcher.disconnect();
    kept = null;
  };
  for (const event of ['pointerdown', 'keydown', 'wheel', 'touchstart']) addEventListener(event, release, {once: true});
  settle();
}

// `live`: {finished, all, seconds}.
export function keepLive({finished, all, seconds}) {
  let on = stored(), touched = -Infinity;
  for (const event of ['pointerdown', 'keydown', 'wheel', 'touchstart']) {
    addEventListener(event, () => {
      touched = performance.now();
    }, {passive: true});
  }
  const box = check('Reload by itself while nobody touches the page', on, (chosen) => {
    on = chosen;
    store(on);
  });
  const text =
      `The study is running: ${finished} of ${all} runs are finished; the page is written anew every ${seconds} s.`;
  document.getElementById('verdict').append(h('p', {class: 'note', role: 'status', id: 'live'}, text), controls(box));
  history.scrollRestoration = 'manual';
  setTimeout(restorePlace, 0);  // once all sections are there
  setInterval(() => {
    if (!on || performance.now() - touched <= quiet_ms || filtered()) return;
    history.replaceState({place: kept || placeNow()}, '');
    location.reload();
  }, 1000 * seconds);
}
