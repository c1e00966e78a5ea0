// Pointer actions on a time plot: dragging selects a window of time, a double click shows the whole run.
const still_px = 4;  // a press with less movement counts as a click

/**
 * @param {HTMLElement} plot
 * @param {import('./time_state.js').TimeState} state
 * @param {{time: (x: number) => number, choose: (span: [number, number]|null) => void}} place `time`: pixels to times;
 * `choose`: shows the part of the view that is being chosen
 */
export function listenToPointer(plot, state, place) {
  /** @type {{x: number, t: number}|null} */
  let press = null;
  const isPicture = (event) => event.target instanceof HTMLCanvasElement;
  plot.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || !isPicture(event)) return;
    plot.setPointerCapture(event.pointerId);
    press = {x: event.clientX, t: place.time(event.clientX)};
  });
  plot.addEventListener('pointermove', (event) => {
    if (!press) {
      if (isPicture(event)) state.point(place.time(event.clientX));
    } else {
      place.choose([press.x, event.clientX]);
    }
  });
  plot.addEventListener('pointerup', (event) => {
    const begun = press;
    press = null;
    place.choose(null);
    if (!begun) return;
    if (Math.abs(event.clientX - begun.x) < still_px) {
      state.point(begun.t);
    } else {
      const t = place.time(event.clientX);
      state.zoom([Math.min(t, begun.t), Math.max(t, begun.t)]);
    }
  });
  plot.addEventListener('pointercancel', () => {
    press = null;
    place.choose(null);
  });
  plot.addEventListener('dblclick', () => state.showAll());
}
