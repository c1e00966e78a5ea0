// Pointer actions on a time plot. Dragging with the mouse selects a window of time. Dragging with Shift, or with a
// finger, moves the view.
const still_px = 4;  // a press with less movement counts as a click
const wheel_rate = 0.0015;

/**
 * @param {HTMLElement} plot
 * @param {import('./time_state.js').TimeState} state
 * @param {{time: (x: number) => number, choose: (span: [number, number]|null) => void}} place `time`: pixels to times;
 * `choose`: shows the part of the view that is being chosen
 */
export function listenToPointer(plot, state, place) {
  /** @type {{x: number, t: number, range: [number, number], moves: boolean}|null} */
  let press = null;
  const isPicture = (event) => event.target instanceof HTMLCanvasElement;
  plot.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || !isPicture(event)) return;
    plot.setPointerCapture(event.pointerId);
    const range = /** @type {[number, number]} */ ([...state.shown()]);
    press =
        {x: event.clientX, t: place.time(event.clientX), range, moves: event.shiftKey || event.pointerType === 'touch'};
  });
  plot.addEventListener('pointermove', (event) => {
    if (!press) {
      if (isPicture(event)) state.point(place.time(event.clientX));
    } else if (press.moves) {
      const box = plot.getBoundingClientRect();
      const per = (press.range[1] - press.range[0]) / box.width, by = (press.x - event.clientX) * per;
      state.zoom([press.range[0] + by, press.range[1] + by]);
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
    } else if (!begun.moves) {
      const t = place.time(event.clientX);
      state.zoom([Math.min(t, begun.t), Math.max(t, begun.t)]);
    }
  });
  plot.addEventListener('pointercancel', () => {
    press = null;
    place.choose(null);
  });
  plot.addEventListener('dblclick', () => state.showAll());
  listenToWheel(plot, state, place);
}

// The wheel scrolls the page until the user clicks on the plot. With Ctrl it always acts on the plot.
function listenToWheel(plot, state, place) {
  plot.addEventListener('wheel', (event) => {
    if (!event.ctrlKey && document.activeElement !== plot) return;
    event.preventDefault();
    if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
      state.move((event.deltaX || event.deltaY) * wheel_rate);
    } else {
      state.scale(Math.exp(event.deltaY * wheel_rate), place.time(event.clientX));
    }
  }, {passive: false});
}
