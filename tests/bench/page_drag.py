#!/usr/bin/python3
"""How soon a page is painted, and how evenly its plot over time follows a drag: frame intervals of 5 s over six panels of a million samples.

Usage: page_drag.py PROGRAM FOLDER

Simulates one run of a million samples (two modes, two inputs of different units) and calls `PROGRAM run` and `report` once.
Drags the view over the run in headless Chromium. Pointer events come once per frame of the screen, like those of a mouse
that is held down. Prints the time from opening a page to its first paint, for the demo and for the million samples. The first
paint contains the verdict (a test checks this). Then prints a row per width of the view: median and
95th percentile of the intervals between frames, and of the time from an event to the picture that shows it.
"""
import json
import pathlib
import statistics
import subprocess
import sys

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "browser"))
from browser import Browser  # noqa: E402

SAMPLES = 1_000_000
CONFIG = """[data]
inputs = log.csv
state = wz
input = speed, steer
state_unit = rad/s
input_unit = m/s, rad
[window]
step = 100
[mixture]
components = 2
restarts = 1
[bank]
refine = none
[report]
size_mb = 200
"""
DRAG = """
const plot = document.querySelector('#data div.plot'), canvas = plot.querySelector('canvas'), done = arguments[1];
const {state} = plot.timePlot, box = canvas.getBoundingClientRect(), y = box.top + 40, [start, end] = state.whole();
const width = arguments[0] * (end - start), seconds = 5000, frames = [], lags = [];
const send = (type, x) => canvas.dispatchEvent(new PointerEvent(type, {
  bubbles: true, clientX: x, clientY: y, pointerId: 1, button: 0, buttons: 1, pointerType: 'mouse', shiftKey: true}));
plot.setPointerCapture = () => {};
const spread = (list) => {
  list.sort((a, b) => a - b);
  return [list[list.length >> 1], list[Math.floor(0.95 * list.length)]];
};
state.zoom([start, start + width]).then(() => {
  const begun = performance.now();
  let last = 0, x = box.right - 10, goal = x;
  send('pointerdown', x);
  const step = (now) => {
    if (last) frames.push(now - last);
    last = now;
    const share = (performance.now() - begun) / seconds;
    if (share > 1) {
      send('pointerup', x);
      done({frames: spread(frames), lags: spread(lags), count: frames.length, panels: plot.querySelectorAll('canvas').length, moved: state.shown()[0] - start});
      return;
    }
    const sent = performance.now();
    // To and fro over the plot: a hand reaches no further.
    x = box.right - 10 - (box.width - 80) * (0.5 - 0.5 * Math.cos(4 * Math.PI * share));
    send('pointermove', x);
    state.changed().then(() => lags.push(performance.now() - sent));
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
});
"""


def write_log(path):
    generator = numpy.random.default_rng(1)
    hold = generator.integers(20, 200, SAMPLES // 20)
    speed, steer = (numpy.repeat(generator.uniform(-1, 1, hold.size).round(2), hold)[:SAMPLES] for _ in range(2))
    mode = numpy.repeat(numpy.arange(hold.size) // 40 % 2, hold)[:SAMPLES]
    noise = generator.normal(0, [0.01, 0.05], (SAMPLES, 2))
    state = numpy.zeros(SAMPLES)
    for k in range(SAMPLES - 1):
        a, b = (0.8, 0.2) if mode[k] == 0 else (0.95, 0.04)
        state[k + 1] = a * state[k] + b * (speed[k] + 2 * steer[k]) + noise[k, mode[k]]
    numpy.savetxt(path, numpy.column_stack((0.01 * numpy.arange(SAMPLES), state, speed, steer)), "%.6g", ",", header="time,wz,speed,steer",
                  comments="")


def make_page(program, folder):
    page = folder / "page.html"
    if not page.exists():
        folder.mkdir(parents=True, exist_ok=True)
        write_log(folder / "log.csv")
        (folder / "big.ini").write_text(CONFIG)
        for command in (["run", "big.ini", "--archive.output", "big.h5"], ["report", "big.h5", "-o", "page.html", "--report.size_mb", "200"]):
            subprocess.run([program, *command], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return page


def make_demo(program, folder):
    page = folder / "demo.html"
    if not page.exists():
        subprocess.run([program, "demo", "-o", "demo"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        subprocess.run([program, "report", "demo/demo.h5", "-o", "demo.html"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return page


def paint_times(browser, page):
    """Seconds to the first paint in five openings."""
    times = []
    for _ in range(5):
        browser.driver.get("about:blank")
        browser.open(page)
        times.append(browser.wait("return performance.getEntriesByName('first-contentful-paint')[0]?.startTime") / 1000)
    return sorted(times)


def main():
    program, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    page = make_page(program, folder)
    browser = Browser(folder / "shots", 1440, 1100)
    try:
        print("| page | size | painted after: median of five, most |\n|---|---|---|")
        for name, made in (("demo", make_demo(program, folder)), ("a million samples", page)):
            times = paint_times(browser, made)
            print(f"| {name} | {made.stat().st_size / 1e6:.1f} MB | {statistics.median(times):.2f} s, {times[-1]:.2f} s |")
        browser.draw_all("#data")
        print("\n| view | frames | between frames: median, 95 % | event to picture: median, 95 % |\n|---|---|---|---|")
        for share in (0.5, 0.1, 0.01):
            got = browser.driver.execute_async_script(DRAG, share)
            assert got["panels"] == 6, json.dumps(got)
            print(f"| {100 * share:g} % of the run | {got['count']} | {got['frames'][0]:.1f} ms, {got['frames'][1]:.1f} ms | "
                  f"{got['lags'][0]:.1f} ms, {got['lags'][1]:.1f} ms |")
    finally:
        browser.close()


if __name__ == "__main__":
    main()
