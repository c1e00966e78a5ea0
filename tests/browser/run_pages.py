"""Pages of runs."""
import archives
import h5py
import session
from session import PageTest, pooled

RUN_SECTIONS = ["verdict", "data", "bank", "filter", "windows", "selection", "origin"]


class RunPages(PageTest):
    def test_numbers_are_the_archives(self):
        self.open(session.modebank.page("demo", session.made["demo"]))
        self.check_scores(session.made["demo"])
        self.check_bank(session.made["demo"])
        self.check_candidates(session.made["demo"])

    def test_the_answers_numbers_are_the_archives(self):
        self.open(session.modebank.page("demo", session.made["demo"]))
        rows = pooled(session.made["demo"])
        shown = {name: (value, text) for name, value, text in session.browser.run("""
            return [...document.querySelectorAll('#verdict .numbers > li')].map((card) =>
                [card.querySelector('.name').textContent, JSON.parse(card.querySelector('.big span').dataset.value ?? 'null'), card.textContent]);""")}
        bank = rows["bank", "test"]
        best = max((row for (_, role), row in rows.items() if role == "test" and row["filter"] not in (b"bank", b"combined")), key=lambda row: row["log_score"])
        competitor = best["filter"].decode()
        self.assertEqual(shown["In the 95 % band"][0], bank["coverage_95"])
        with h5py.File(session.made["demo"]) as file:
            (verdict,) = {row["verdict"].decode() for row in file["evaluation/diagnostics"][:]
                          if (row["filter"], row["role"], row["mode"]) == (b"bank", b"test", -1)}
        self.assertIn(verdict, shown["In the 95 % band"][1])
        self.assertAlmostEqual(shown[f"Gain over {competitor}"][0], bank["log_score"] - best["log_score"], places=9)
        self.assertIn("±", shown[f"Gain over {competitor}"][1])
        self.assertEqual(shown["RMSE one step ahead"][0], float(bank["rmse"].ravel()[0]))
        self.assertIn(f"{competitor} {best['rmse'].ravel()[0]:.3g}", shown["RMSE one step ahead"][1])

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

    def check_bank(self, archive):
        with h5py.File(archive) as file:
            theta, weight = file["bank/parameters"][:], file["bank/weight"][:]
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

    def test_light_dark_and_phone(self):
        page = session.modebank.page("demo", session.made["demo"])
        for scheme in ("dark", "light"):
            session.browser.scheme(scheme)
            self.assertGreaterEqual(self.assert_whole(page, RUN_SECTIONS), 5)
            session.browser.screenshot(f"demo_{scheme}")
            self.assertEqual(session.browser.run("return getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)", scheme == "light")
        session.browser.size(390, 800)
        try:
            self.assertGreaterEqual(self.assert_whole(page, RUN_SECTIONS), 5)
            session.browser.screenshot("demo_phone")
            self.assertLessEqual(session.browser.run("return document.documentElement.scrollWidth"), 390)
        finally:
            session.browser.size(1200, 900)

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
