// Opens pages in Firefox, one after the other, scrolls until every figure is drawn, and fails where a page fails, a figure
// stays blank or the console has an error: firefox.cjs URL... ; puppeteer-core is found by NODE_PATH.
const puppeteer = require('puppeteer-core');

const isReady = () => document.documentElement.dataset.ready === 'true' || document.querySelector('.failure');

// Scrolls to the next figure that is not drawn; returns how many there are, and what is wrong.
const look = () => {
  const seen = (it) => it.offsetParent;
  const plots = [...document.querySelectorAll('div.plot')].filter(seen);
  const pending = plots.filter((it) => !it.dataset.failed && !it.dataset.drawn);
  if (pending.length) pending[0].scrollIntoView({block: 'center'});
  const inked = (canvas) => canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.some((v) => v);
  const blank = [...document.querySelectorAll('canvas.picture, .timeplot canvas')].filter((it) => seen(it) && !inked(it)).length;
  return {
    pending: pending.length,
    blank,
    drawn: plots.length,
    rows: document.querySelectorAll('tbody tr').length,
    said: document.querySelector('.failure')?.textContent ?? '',
    failed: plots.filter((it) => it.dataset.failed).map((it) => it.getAttribute('aria-label')),
    wide: document.documentElement.scrollWidth > innerWidth,
  };
};

async function check(browser, url) {
  const page = await browser.newPage(), errors = [], note = (text) => errors.push(String(text));
  await page.setViewport({width: 1200, height: 900});
  page.on('pageerror', note);
  page.on('console', (message) => message.type() === 'error' && note(message.text()));
  await page.goto(url);
  await page.waitForFunction(isReady, {timeout: 60000});
  const end = Date.now() + 120000;
  let found = await page.evaluate(look);
  while ((found.pending || found.blank || !found.rows) && Date.now() < end) {
    await new Promise((resolve) => setTimeout(resolve, 200));
    found = await page.evaluate(look);
  }
  const wrong = [...errors, found.said, ...found.failed.map((label) => `not drawn: ${label}`)].filter(Boolean);
  if (found.pending || found.blank) wrong.push(`${found.pending} figures not begun, ${found.blank} blank`);
  if (!found.rows) wrong.push('no table has a row');
  if (found.wide) wrong.push('the page is wider than its window');
  console.log(`${wrong.length ? 'FAILED' : 'ok'} ${await page.title()}: ${found.drawn} figures, ${found.rows} rows of tables`);
  wrong.forEach((text) => console.log(`  ${text}`));
  await page.close();
  return wrong.length === 0;
}

async function main(urls) {
  const browser = await puppeteer.launch({browser: 'firefox', executablePath: '/usr/bin/firefox-esr', headless: true});
  try {
    let good = true;
    for (const url of urls) good = (await check(browser, url)) && good;
    return good;
  } finally {
    await browser.close();
  }
}

main(process.argv.slice(2)).then((good) => process.exit(good ? 0 : 1));
