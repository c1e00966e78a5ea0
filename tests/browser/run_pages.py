"""Pages of runs."""

import accessible
import archives
import h5py
import session
from session import PageTest, pooled

RUN_SECTIONS = ["verdict", "data", "bank", "filter", "windows", "selection", "origin"]


class RunPages(PageTest):
    def test_every_section_of_every_page_draws(self):
        """Pages of the demo and of hostile names are in tests below."""
        for name in ("one_mode", "no_truth", "none_held_out", "ice", "drive"):
            if name not in session.made:
                continue
            with self.subTest(name):
                plots = self.assert_whole(session.modebank.page(name, session.made[name]), RUN_SECTIONS)
                self.assertGreaterEqual(plots, 5)
                self.assert_legible(360, 1400)

    def test_all_runs_are_counted_where_not_all_are_drawn(self):
        if "drive" not in session.made:
            self.skipTest("real data are absent: set MODEBANK_DATA to a folder that holds borealtc/ICE")
        self.open(session.modebank.page("drive", session.made["drive"]))
        with h5py.File(session.made["drive"]) as file:
            runs = len(file["data/runs"])
        drawn = session.browser.run("return document.querySelector('#data select').options.length")
        self.assertLess(drawn, runs)
        self.assertIn(f"Of {runs} runs {drawn} are drawn", session.browser.run("return document.getElementById('data').textContent"))

    def test_numbers_are_the_archives(self):
        for name in ("demo", "ice", "drive"):
            if name not in session.made:
                continue
            with self.subTest(name):
                self.open(session.modebank.page(name, session.made[name]))
                self.check_scores(session.made[name])
                self.check_bank(session.made[name])
                self.check_candidates(session.made[name])

    def check_scores(self, archive):
        rows = pooled(archive)
        names = {name.replace("_", " "): name for name, _ in rows}
        table = self.table("Scores, all runs together")
        self.assertEqual(len(table), len(rows))
        for line in table:
            row = rows[names[line["Filter"][0]], "test" if line["Runs"][0] == "held out" else "train"]
            for heading, key in (("Samples", "samples"), ("Log score [nats]", "log_score"), ("NIS above", "nis_above"), ("NIS below", "nis_below"),
                                 ("in 95 %", "coverage_95"), ("too far", "too_far"), ("too close", "too_close"), ("mean NIS", "nis_mean")):
                self.same(line[heading][1], row[key])

    def test_free_runs_are_the_archives(self):
        self.open(session.modebank.page("no_truth", session.made["no_truth"]))
        with h5py.File(session.made["no_truth"]) as file:
            rows = {(row["filter"].decode(), row["role"].decode()): row for row in file["evaluation/free_run"][:] if row["run"] == b"*"}
        table = self.table("Free run, all runs together")
        self.assertEqual(len(table), len(rows))
        for line in table:
            row = rows[line["Filter"][0].replace(" ", "_"), "test" if line["Runs"][0].startswith("held") else "train"]
            for heading, key in (("Samples", "samples"), ("Log score [nats]", "log_score"), ("NRMSE", "nrmse"), ("FIT [%]", "fit"), ("in 95 %", "coverage_95")):
                self.same(line[heading][1], float(row[key].ravel()[0]))

    def test_every_filter_has_a_name(self):
        self.open(session.modebank.page("demo", session.made["demo"]))
        with h5py.File(session.made["demo"]) as file:
            filters = {row["filter"].decode().replace("_", " ") for row in file["evaluation/horizon"][:]}
        self.assertIn("combined", filters)
        self.assertEqual({row["Filter"][0] for row in self.table("Predictions several samples ahead")}, filters)

    def test_histograms_of_all_filters_are_of_one_height(self):
        self.open(session.modebank.page("demo", session.made["demo"]))
        session.browser.draw_all("#filter")
        heights = session.browser.run("""
            const plot = [...document.querySelectorAll('#filter div.plot')].find((p) => p.ariaLabel.startsWith('Histogram'));
            return plot.layout.panels.map(({at}) => at.height);""")
        with h5py.File(session.made["demo"]) as file:
            shown = sum(isinstance(group, h5py.Group) and "pit" in group for group in file["evaluation"].values())
        self.assertEqual(len(heights), shown)
        self.assertLess(max(heights) - min(heights), 1)
        self.assertGreater(min(heights), 60)

    def check_bank(self, archive):
        with h5py.File(archive) as file:
            theta, error, weight = (file[f"bank/{name}"][:] for name in ("parameters", "parameter_standard_error", "weight"))
            transition = file["bank/transition"][:]
        table = self.table("Parameters")
        self.assertGreaterEqual(len(table), len(theta))
        for line in table[:len(theta)]:
            k = int(line["Mode"][0].split()[0])
            exact = [value for _, value in line.values()]
            self.assertIn(float(weight[k]), exact)
            for value in theta[k]:
                self.assertIn(float(value), exact)
        shown = session.browser.run("""
            return [...document.querySelectorAll('#bank [data-value]')].map((e) => JSON.parse(e.dataset.value)).filter((v) => typeof v === 'number');""")
        if len(theta) > 1:
            for value in transition.ravel():
                self.assertIn(float(value), shown)

    def check_candidates(self, archive):
        with h5py.File(archive) as file:
            candidates = file["mixture/candidates"][:]
        table = self.table("Candidates")
        self.assertEqual(len(table), len(candidates))
        for line, row in zip(table, candidates):
            self.assertEqual(int(line["K"][0]), row["components"])
            self.assertEqual(line["Status"][0] == "chosen", bool(row["selected"]))
            for heading, key in (("BIC", "bic"), ("AIC", "aic"), ("log likelihood", "log_likelihood")):
                self.same(line[heading][1], row[key])

    def window_point(self):
        """The place of a window in the flat cloud, in pixels of the browser's window, and its number."""
        return session.browser.run("""
            const plot = document.querySelector('#windows div.plot');
            plot.scrollIntoView({block: 'center'});
            const box = plot.querySelector('svg').getBoundingClientRect(), [{panel, at, to}] = plot.layout.panels;
            let best = null;
            for (const {which, x, y} of panel.marks) {
              if (!which) continue;
              for (let i = 0; i < x.length; ++i) {
                const px = to.x(x[i]), py = to.y(y[i]);
                if (px < at.x + 20 || py < at.y + 20 || px > at.x + at.width - 20 || py > at.y + at.height - 20) continue;
                // The leftmost: nothing else may be nearer to the pointer.
                if (!best || px < best.px) best = {px, left: box.x + px, top: box.y + py, window: which[i]};
              }
            }
            return best;""")

    def test_hover_names_a_window_and_a_click_goes_to_its_data(self):
        self.open(session.modebank.page("demo", session.made["demo"]))
        session.browser.draw_all()
        point = self.window_point()
        session.browser.move(point["left"], point["top"])
        tip = session.browser.wait("return [...document.querySelectorAll('.tip')].find((tip) => !tip.hidden)?.textContent", what="hover to tell of the window")
        self.assertRegex(tip, r"run \w+, [\d.]+ to [\d.]+ s")
        session.browser.click(point["left"], point["top"])
        session.browser.wait("return document.querySelector('#data div.plot').timePlot.state.mark",
                     what="the click to mark the window's stretch of the data")
        told = session.browser.run("return document.getElementById('window-info').textContent")
        self.assertRegex(told, r"Window in run \w+, [\d.]+ to [\d.]+ s: wz <- wz \(lag 1\) = ")
        mark = session.browser.run("return document.querySelector('#data div.plot').timePlot.state.mark")
        begin, end = (float(word) for word in told.split(", ")[1].split(" s")[0].split(" to "))
        self.assertAlmostEqual(mark[0], begin, places=2)
        self.assertAlmostEqual(mark[1], end, places=2)
        session.browser.wait("""
            const {range: [from, to], state} = document.querySelector('#data div.plot').timePlot, [start, end] = state.whole();
            return to - from < end - start;""", what="the view to follow")
        shown = self.plot_range("data")
        self.assertTrue(shown[0] <= begin and end <= shown[1])
        self.assert_quiet()

    def test_light_dark_print_and_phone(self):
        page = session.modebank.page("demo", session.made["demo"])
        for scheme in ("dark", "light"):
            session.browser.scheme(scheme)
            self.assertGreaterEqual(self.assert_whole(page, RUN_SECTIONS), 5)
            session.browser.screenshot(f"demo_{scheme}")
            self.assertEqual(session.browser.run("return getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)", scheme == "light")
        self.check_print()
        session.browser.run("document.getElementById('theme').click()")
        self.assertEqual(session.browser.run("return document.documentElement.dataset.theme"), "dark")
        session.browser.run("document.getElementById('theme').click(); delete document.documentElement.dataset.theme")
        accessible.assert_accessible(self)
        self.assert_quiet()
        session.browser.size(390, 800)
        try:
            self.assertGreaterEqual(self.assert_whole(page, RUN_SECTIONS), 5)
            session.browser.screenshot("demo_phone")
            self.assertLessEqual(session.browser.run("return document.documentElement.scrollWidth"), 390)
        finally:
            session.browser.size(1200, 900)

    def check_print(self):
        """On paper a figure drawn for the window is reduced to the sheet's width."""
        pdf = session.browser.cdp("Page.printToPDF", printBackground=True)["data"]
        self.assertGreater(len(pdf), 100_000)
        sheet = 700
        widths = session.browser.run("""
            const main = document.getElementById('main');
            main.style.width = `${arguments[0]}px`;
            const widths = [...document.querySelectorAll('.chart svg')].map((svg) => [svg.getBoundingClientRect().width, svg.viewBox.baseVal.width]);
            main.style.width = '';
            return widths;""", sheet)
        self.assertGreater(max(drawn for _, drawn in widths), sheet)
        self.assertLessEqual(max(shown for shown, _ in widths), sheet)

    def test_a_lines_colour_is_its_legends(self):
        """In light and in dark."""
        page = session.modebank.page("demo", session.made["demo"])
        for scheme in ("light", "dark"):
            session.browser.scheme(scheme)
            self.open(page)
            session.browser.draw_all("#filter")
            keys, lines = session.browser.run(session.BYTES + """
                const of = (selector, key) => [...document.querySelectorAll(selector)].map((it) => bytes(getComputedStyle(it)[key]));
                const figure = [...document.querySelectorAll('#filter figure')].find((it) => it.textContent.includes('band of white residuals'));
                figure.id = 'residuals';
                return [of('#residuals .legend .swatch', 'backgroundColor'), of('#residuals svg path[fill="none"][stroke-linejoin]', 'stroke')];""")
            self.assertEqual(lines, keys)
        session.browser.scheme("light")

    def test_keyboard_and_names_for_screen_readers(self):
        self.open(session.modebank.page("demo", session.made["demo"]))
        session.browser.key("Tab")
        self.assertEqual(session.browser.run("return document.activeElement.className"), "skip")
        session.browser.key("Enter")
        self.assertEqual(session.browser.run("return document.activeElement.id"), "main")
        self.assertEqual(session.browser.run("return [...document.querySelectorAll('div.plot')].filter((p) => !p.getAttribute('aria-label')).length"), 0)
        self.assertEqual(session.browser.run("return [...document.querySelectorAll('select, input, textarea')].filter((e) => !e.labels?.length && !e.getAttribute('aria-label')).length"), 0)
        self.assertEqual(session.browser.run("return document.querySelectorAll('h1').length"), 1)
        self.assertEqual(session.browser.run("return [...document.querySelectorAll('section')].every((s) => document.getElementById(s.getAttribute('aria-labelledby')))"), True)

    def test_the_configuration_is_copied_whole(self):
        self.open(session.modebank.page("demo", session.made["demo"]))
        with h5py.File(session.made["demo"]) as file:
            config = file["config"][()].decode()
        session.browser.run("""
            window.copied = null;
            Object.defineProperty(navigator, 'clipboard', {value: {writeText: (text) => { window.copied = text; return Promise.resolve(); }}});
            [...document.querySelectorAll('button')].find((b) => b.textContent.includes('Copy the configuration')).click();""")
        self.assertEqual(session.browser.run("return window.copied"), config)

    def test_hostile_names_are_text(self):
        self.assertGreaterEqual(self.assert_whole(session.modebank.page("hostile", session.made["hostile"]), RUN_SECTIONS), 5)
        self.assertIsNone(session.browser.run("return window.hostile ?? null"))
        self.assertEqual(session.browser.run("return document.querySelectorAll('main script, main img, main b, main i').length"), 0)
        text = session.browser.run("return document.body.textContent")
        self.assertIn(archives.HOSTILE_STATE, text)
        self.assertIn("漢 ${x} {{data}}", text)
        self.assertIn("0 " + archives.HOSTILE_MODE, text)
        titles = session.browser.run("return [...document.querySelectorAll('#data .panel-title')].map((t) => t.textContent)")
        self.assertIn(f"{archives.HOSTILE_STATE} [{archives.HOSTILE_UNIT}]", titles)
        session.browser.screenshot("hostile")
        self.assert_quiet()

    def test_scripts_of_others_do_not_run(self):
        """A page to which somebody has added a script must not run it."""
        page = session.work / "written_into.html"
        text = session.modebank.page("demo", session.made["demo"]).read_text(encoding="utf-8")
        page.write_text(text.replace("</body>", "<script>window.hostile = 7</script><img src='data:,' onerror='window.hostile = 8'></body>"), encoding="utf-8")
        self.open(page)
        self.assertIsNone(session.browser.run("return window.hostile ?? null"))
        refused, _ = session.browser.messages()
        self.assertGreaterEqual(len([message for message in refused if "Content Security Policy" in message]), 1)

    def test_what_an_archive_lacks_is_said(self):
        plots = self.assert_whole(session.modebank.page("windows_only", session.made["windows_only"]), RUN_SECTIONS)
        self.assertGreaterEqual(plots, 2)
        for section in ("selection", "bank", "filter"):
            self.assertRegex(session.browser.run("return document.getElementById(arguments[0]).textContent", section), "holds no|nothing|no ")
