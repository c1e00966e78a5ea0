// Figures are drawn when they come near the window; those that are still out of sight are drawn when the browser has
// nothing else to do, so that it can print the whole page at any time: it does not wait for drawing.

const soon_ms = 2000;  // at the latest, also in a busy browser

const whenIdle = () => new Promise((resolve) => {
  if (window.requestIdleCallback) {
    requestIdleCallback(() => resolve(), {timeout: soon_ms});
  } else {
    setTimeout(resolve, 200);
  }
});

/**
 * `tasks`: {finish, place}: what begins a drawing and waits for it, and the element it is in; what nobody can open the
 * page and see, e.g. inside folded parts, is left.
 */
export async function finishWhenIdle(tasks) {
  for (const {finish, place} of tasks) {
    await whenIdle();
    if (place && !place.offsetParent) continue;
    await Promise.resolve(finish()).catch(() => null);  // who drew it has said so
  }
  document.documentElement.dataset.finished = 'true';
}

/**
 * A browser that is only to print (chromium --headless --print-to-pdf) does so when the page has loaded. An open
 * document in a frame keeps it loading until the function that comes back is called.
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
