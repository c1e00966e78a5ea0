// A figure is drawn shortly before it becomes visible. All others are drawn while the browser is idle, so that printing
// finds a complete page.

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
  document.documentElement.dataset.finished = 'true';
}

/**
 * A browser that only prints (chromium --headless --print-to-pdf) prints when the page has loaded. An open document in
 * a frame delays this until the returned function is called.
 */
export function holdPrinting() {
  const prints = navigator.userAgent.includes('Headless') && !navigator.webdriver;
  if (!prints || document.readyState === 'complete') return () => null;
  const frame = document.createElement('iframe');
  frame.hidden = true;
  document.body.append(frame);
  frame.contentDocument.open();
  return () => {
    frame.contentDocument.close();
    frame.remove();
  };
}
