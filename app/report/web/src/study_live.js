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
  setInterval(() => {
    if (on && performance.now() - touched > quiet_ms) location.reload();
  }, 1000 * seconds);
}
