"""Navigation in time: the plot of a run, its controls, its link and its downloads."""
import base64
import csv
import io
import time
import xml.etree.ElementTree

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

    def wait_range(self, what, test):
        """Waits until the visible range passes the test, and returns it."""
        end = time.monotonic() + PATIENCE_S
        while not test(shown := self.plot_range("data")):
            self.assertLess(time.monotonic(), end, f"waited for {what}: {shown}")
            time.sleep(0.05)
        return shown

    def press(self, label):
        session.browser.run("[...document.querySelectorAll('#data button')].find((b) => b.textContent === arguments[0]).click()", label)

    def keys(self, *names):
        session.browser.run(f"{PLOT}.focus({{preventScroll: true}})")
        for name in names:
            session.browser.cdp("Input.dispatchKeyEvent", type="keyDown", key=name)
            session.browser.cdp("Input.dispatchKeyEvent", type="keyUp", key=name)

    def crosshair(self):
        return session.browser.run(f"return {PLOT}.timePlot.state.at")

    def wait_readout(self, sample):
        session.browser.wait("return document.querySelector('#data .crosshair-time').textContent.endsWith(`sample ${arguments[0]}.`)", sample)
        return session.browser.run(READOUT)

    def test_zoom_by_drag_wheel_and_fields_is_undone(self):
        first, last = self.plot_range("data")
        area = self.plot_area("data")
        middle = area["top"] + area["height"] / 2
        at = lambda share: area["left"] + share * area["width"]
        session.browser.drag(at(0.3), middle, at(0.5), middle)
        zoomed = self.wait_range("the drag to zoom", lambda shown: shown[1] - shown[0] < 0.5 * (last - first))
        self.assertAlmostEqual((zoomed[1] - zoomed[0]) / (last - first), 0.2, delta=0.01)
        self.assertAlmostEqual((zoomed[0] - first) / (last - first), 0.3, delta=0.01)
        session.browser.click(at(0.25), middle)
        session.browser.mouse("mouseWheel", at(0.25), middle, deltaX=0, deltaY=-400)
        wheeled = self.wait_range("the wheel to zoom", lambda shown: shown[1] - shown[0] < 0.9 * (zoomed[1] - zoomed[0]))
        self.assertAlmostEqual(wheeled[0] + 0.25 * (wheeled[1] - wheeled[0]), zoomed[0] + 0.25 * (zoomed[1] - zoomed[0]), places=2)
        session.browser.run("""
            const [from, to] = document.querySelectorAll('#data input.seconds');
            for (const [field, value] of [[from, 12.5], [to, 20]]) { field.value = value; field.dispatchEvent(new Event('change')); }""")
        self.wait_range("the fields", lambda shown: numpy.allclose(shown, [12.5, 20], rtol=1e-12))
        self.press("All")
        self.wait_range("the whole run", lambda shown: shown == [first, last])
        self.assert_quiet()

    def test_the_crosshair_reads_the_archives_numbers(self):
        times, state, truth, inputs = self.stored("data/time", "data/state", "data/truth", "data/input")
        nis, innovation, prediction, probability, spread = self.stored(
            *(f"evaluation/bank/{name}" for name in ("nis", "innovation", "prediction", "mode_probability", "innovation_covariance")))
        area = self.plot_area("data")
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

    def test_keys_choose_a_window_and_lead_the_crosshair(self):
        first, last = self.plot_range("data")
        self.keys("ArrowLeft", "[")
        begun = self.wait_range("[ to let the view begin at the crosshair", lambda shown: shown[0] > first)
        self.assertAlmostEqual(begun[0], self.crosshair(), places=9)
        session.browser.run(f"{PLOT}.dispatchEvent(new KeyboardEvent('keydown', {{key: 'ArrowRight', shiftKey: true}}))")
        session.browser.wait(f"return {PLOT}.timePlot.state.at > arguments[0]", begun[0])
        self.keys("]")
        chosen = self.wait_range("] to let it end there", lambda shown: shown[1] < last)
        self.assertAlmostEqual(chosen[1], self.crosshair(), places=9)
        self.keys("PageDown")
        moved = self.wait_range("Page down to move", lambda shown: shown[0] > chosen[0])
        self.assertAlmostEqual(moved[1] - moved[0], chosen[1] - chosen[0], places=9)
        self.keys("0", "Escape")
        self.wait_range("0 to show all", lambda shown: shown == [first, last])
        session.browser.wait(f"return {PLOT}.timePlot.state.at === null")
        self.assert_quiet()

    def test_a_link_restores_the_view(self):
        session.browser.run("const s = document.querySelectorAll('#data select'); s[0].selectedIndex = 2; s[0].dispatchEvent(new Event('change'));")
        session.browser.run(f"const {{state}} = {PLOT}.timePlot; return state.zoom([10, 20]).then(() => state.point(15))")
        at = self.crosshair()
        link = session.browser.wait("return location.hash.includes('at=') && location.href")
        session.browser.driver.get("about:blank")
        session.browser.driver.get(link)
        session.browser.wait("return document.documentElement.dataset.ready === 'true'")
        self.wait_range("the link's view", lambda shown: shown == [10, 20])
        state = session.browser.run(f"const {{state}} = {PLOT}.timePlot; return [state.run, state.at]")
        self.assertEqual(state[0], 2)
        self.assertAlmostEqual(state[1], at, places=5)
        self.assertEqual(session.browser.run("return document.querySelector('#data select').selectedIndex"), 2)

    def file(self, ending):
        name = session.browser.wait("return Object.keys(window.caught).find((name) => name.endsWith(arguments[0]))", ending)
        content = base64.b64decode(session.browser.driver.execute_async_script(READ, name))
        session.browser.run("delete window.caught[arguments[0]]", name)
        return content

    def test_figures_and_tables_are_files(self):
        session.browser.run(CATCH)
        self.press("SVG")
        svg = xml.etree.ElementTree.fromstring(self.file(".svg"))
        texts = [element.text for element in svg.iter("{http://www.w3.org/2000/svg}text")]
        for text in ("wz [rad/s]", "measured", "time [s]", "normalised innovation squared (NIS)"):
            self.assertIn(text, texts)
        longest = max(len(path.get("d")) for path in svg.iter("{http://www.w3.org/2000/svg}path"))
        self.assertGreater(longest, 1000)
        self.press("PNG")
        png = self.file(".png")
        self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
        self.assertGreater(int.from_bytes(png[16:20], "big"), 3000)
        session.browser.run("[...document.querySelectorAll('button.download')].find((b) => b.ariaLabel === 'CSV of: Scores, all runs together').click()")
        rows = list(csv.DictReader(io.StringIO(self.file(".csv").decode())))
        table = self.table("Scores, all runs together")
        self.assertEqual([float(row["Log score [nats]"]) for row in rows], [row["Log score [nats]"][1] for row in table])
        self.assertEqual([row["Filter"] for row in rows], [row["Filter"][0] for row in table])
        self.assert_quiet()
