// When figures are drawn: near the window, and one after the other.

let turn = Promise.resolve();
/** Runs the task after those before it, so that the first figure is seen before a large one begins. */
export function inTurn(task) {
  turn = turn.then(task).then(() => new Promise((shown) => setTimeout(shown, 0)));
}

/** Calls `begin` when the element comes near the window: a page of many figures opens at once. */
export function whenNear(element, begin) {
  const near = (entries) => {
    if (entries.some((entry) => entry.isIntersecting)) begin();
  };
  const watcher = new IntersectionObserver(near, {rootMargin: '300px'});
  watcher.observe(element);
  return () => watcher.disconnect();
}
