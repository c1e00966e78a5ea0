// A figure is drawn shortly before it becomes visible. All others are drawn while the browser is idle, so that a page
// is complete when the browser prints it.

const soon_ms = 2000;  // latest start of the drawing, even in a busy browser

const whenIdle = () => new Promise((resolve) => {
  if (window.requestIdleCallback) {
    requestIdleCallback(() => resolve(), {timeout: soon_ms});
  } else {
    setTimeout(resolve, 200);
  }
});

/**
 * `tasks`: {finish, place}: `finish` draws and waits for the end, `place` is the element. Elements that a reader cannot
 * see, for example inside folded parts, are skipped.
 */
export async function finishWhenIdle(tasks) {
  for (const {finish, place} of tasks) {
    await whenIdle();
    if (place && !place.offsetParent) continue;
    await Promise.resolve(finish()).catch(
        () => null);  // errors are ignored here: the drawing code has already reported them
  }
}
