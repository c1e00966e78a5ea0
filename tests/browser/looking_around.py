"""Navigation in time: the plot of a run and its controls; tables as files."""
import base64
import csv
import io
import time

import archives
import h5py
import numpy
import session
from browser import PATIENCE_S
from session import PageTest

PLOT = "document.querySelector('#data div.plot')"
READOUT = """
    return Object.fromEntries([...document.querySelectorAll('#data .panel-head')].map((head) => [
      head.querySelector('.panel-title').textContent,
      Object.fromEntries([...head.querySelectorAll('li')].map((li) => [
        li.childNodes[1].textContent, JSON.parse(li.querySelector('.number')?.dataset.value ?? 'null')]))]));"""
# Intercepts the files that a page would save.
CATCH = """
    window.caught = {};
    URL.createObjectURL = (blob) => { window.last = blob; return '#'; };
    HTMLAnchorElement.prototype.click = function () { window.caught[this.download] = window.last; };"""
READ = """
    const [name, done] = arguments, reader = new FileReader();
    reader.onload = () => done(reader.result.split(',')[1]);
    reader.readAsDataURL(window.caught[name]);"""


class LookingAround(PageTest):
    def setUp(self):
        self.open(session.modebank.page("demo", session.made["demo"]))
        session.browser.draw_all("#data")

    def stored(self, *names):
        """The data of the visible run."""
        with h5py.File(session.made["demo"]) as file:
            run = session.browser.run(f"return {PLOT}.timePlot.state.current.name")
            return [file[name][archives.rows(file, run)] for name in names]

    def plot_range(self):
        """The visible range of a time plot: from and to."""
        return session.browser.run("return [...document.querySelector('#data div.plot').timePlot.range]")

    def plot_area(self):
        """The inside of its first panel, in pixels of the window."""
        return session.browser.run("""
            const plot = document.querySelector('#data div.plot'), canvas = plot.querySelector('canvas');
            canvas.scrollIntoView({block: 'center'});
            const box = canvas.getBoundingClientRect(), scale = plot.timePlot.scale(), [from, to] = scale.range.map(scale.to);
            return {left: box.x + from, top: box.y, width: to - from, height: box.height};""")

    def wait_range(self, what, test):
        """Waits until the visible range passes the test, and returns it."""
        end = time.monotonic() + PATIENCE_S
        while not test(shown := self.plot_range()):
            self.assertLess(time.monotonic(), end, f"waited for {what}: {shown}")
            time.sleep(0.05)
        return shown

    def press(self, label):
        session.browser.run("[...document.querySelectorAll('#data button')].find((b) => b.textContent === arguments[0]).click()", label)

    def crosshair(self):
        return session.browser.run(f"return {PLOT}.timePlot.state.at")

    def wait_readout(self, sample):
        session.browser.wait("return document.querySelector('#data .crosshair-time').textContent.endsWith(`sample ${arguments[0]}.`)", sample)
        return session.browser.run(READOUT)

    def test_zoom_by_drag_is_undone(self):
        first, last = self.plot_range()
        area = self.plot_area()
        middle = area["top"] + area["height"] / 2
        at = lambda share: area["left"] + share * area["width"]
        session.browser.drag(at(0.3), middle, at(0.5), middle)
        zoomed = self.wait_range("the drag to zoom", lambda shown: shown[1] - shown[0] < 0.5 * (last - first))
        self.assertAlmostEqual((zoomed[1] - zoomed[0]) / (last - first), 0.2, delta=0.01)
        self.assertAlmostEqual((zoomed[0] - first) / (last - first), 0.3, delta=0.01)
        self.press("All")
        self.wait_range("the whole run", lambda shown: shown == [first, last])
        self.assert_quiet()

    def test_the_crosshair_reads_the_archives_numbers(self):
        times, state, truth, inputs = self.stored("data/time", "data/state", "data/truth", "data/input")
        nis, innovation, prediction, probability, spread = self.stored(
            *(f"evaluation/bank/{name}" for name in ("nis", "innovation", "prediction", "mode_probability", "innovation_covariance")))
        area = self.plot_area()
        k = 148  # an event has whole pixels, which are less than half a sample
        session.browser.move(area["left"] + (times[k] - times[0]) / (times[-1] - times[0]) * area["width"] + 0.5, area["top"] + 20)
        session.browser.wait(f"return {PLOT}.timePlot.state.at !== null")
        self.assertAlmostEqual(self.crosshair(), times[k], places=6)
        shown = self.wait_readout(k)
        of_state, of_inputs = shown["wz [rad/s]"], shown["inputs [m/s]"]
        single = lambda value: float(numpy.float32(value))
        self.assertEqual(of_state["measured"], single(state[k, 0]))
        self.assertEqual(of_state["truth"], single(truth[k, 0]))
        self.assertEqual(of_state["predicted"], single(prediction[k, 0]))
        half = 1.959964 * numpy.sqrt(spread[k, 0, 0])
        for edge, wanted in zip(of_state["band"], (prediction[k, 0] - half, prediction[k, 0] + half)):
            self.assertAlmostEqual(edge, wanted, places=5)
        self.assertEqual(list(of_inputs.values()), [single(value) for value in inputs[k]])
        self.assertEqual(shown["innovation of wz [rad/s]"]["innovation"], single(innovation[k, 0]))
        self.assertEqual(shown["normalised innovation squared (NIS)"]["NIS"], single(nis[k]))
        likeliest = max(shown["probability of the modes"].values())  # the driver sorts by name
        self.assertAlmostEqual(likeliest, probability[k].max(), delta=2e-5)  # shares have sixteen bits
        self.assertIn("rad/s", session.browser.run("return document.querySelector('#data .readout').textContent"))

    def file(self, ending):
        name = session.browser.wait("return Object.keys(window.caught).find((name) => name.endsWith(arguments[0]))", ending)
        content = base64.b64decode(session.browser.driver.execute_async_script(READ, name))
        session.browser.run("delete window.caught[arguments[0]]", name)
        return content

    def test_tables_are_files(self):
        session.browser.run(CATCH)
        session.browser.run("[...document.querySelectorAll('button.download')].find((b) => b.ariaLabel === 'CSV of: Scores, all runs together').click()")
        rows = list(csv.DictReader(io.StringIO(self.file(".csv").decode())))
        table = self.table("Scores, all runs together")
        self.assertEqual([float(row["Log score [nats]"]) for row in rows], [row["Log score [nats]"][1] for row in table])
        self.assertEqual([row["Filter"] for row in rows], [row["Filter"][0] for row in table])
        self.assert_quiet()
