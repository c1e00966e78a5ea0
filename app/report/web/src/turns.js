// Order in which figures are drawn: those near the visible part first, one after the other.

let turn = Promise.resolve();
/** Runs a task after the earlier ones, so that the first figure appears before a large one starts. */
export function inTurn(task) {
  turn = turn.then(task).then(() => new Promise((shown) => setTimeout(shown, 0)));
}

/** Calls `begin` when the element comes near the window, so that a page with many figures opens at once. */
export function whenNear(element, begin) {
  const near = (entries) => {
    if (entries.some((entry) => entry.isIntersecting)) begin();
  };
  const watcher = new IntersectionObserver(near, {rootMargin: '300px'});
  watcher.observe(element);
  return () => watcher.disconnect();
}
