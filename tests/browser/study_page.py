"""The page of a study."""
import accessible
import h5py
import session
from session import PageTest

STUDY_SECTIONS = ["verdict", "better", "runs", "effects", "origin"]


class StudyPage(PageTest):
    def page(self):
        return session.modebank.page("study", session.made["study"], options=("--report.runs", "2"))

    def stored(self):
        with h5py.File(session.made["study"] / "study.h5") as file:
            return file["study"][:]

    def column(self, name):
        return [row[name][1] for row in self.rows()]

    def rows(self):
        """A column by its name in the study; the headings have it in words."""
        names = session.browser.run("return [...document.querySelectorAll('#study-table thead tr:first-child th')].map((th) => th.dataset.column)")
        table = self.table("Every run")
        return [dict(zip(names, row.values())) for row in table]

    def sort_by(self, name):
        session.browser.run("document.querySelector(`#study-table th[data-column='${arguments[0]}'] button`).click()", name)

    def filter(self, name, text):
        session.browser.run("""
            const input = document.querySelector(`#study-table input[data-column="${arguments[0]}"]`);
            input.value = arguments[1];
            input.dispatchEvent(new Event('input', {bubbles: true}));""", name, text)

    def test_every_section_draws_in_light_and_dark(self):
        page = self.page()
        for scheme in ("dark", "light"):
            session.browser.scheme(scheme)
            self.assert_whole(page, STUDY_SECTIONS)
            session.browser.screenshot(f"study_{scheme}")
            self.assert_legible(360, 1400)
        accessible.assert_accessible(self)

    def test_numbers_are_the_tables(self):
        self.open(self.page())
        session.browser.run("document.querySelectorAll('#runs details input[type=checkbox]').forEach((box) => { if (!box.checked) box.click(); })")
        stored = self.stored()
        rows = self.rows()
        self.assertEqual(len(rows), len(stored))
        scores = [name for name in stored.dtype.names if name.startswith(("bank_", "baseline_", "noise_only_", "one_motion_", "drifting_")) or name == "modes"]
        self.assertGreater(len(scores), 20)
        best_first = stored[(-stored["bank_test_log_score"]).argsort(kind="stable")]
        for line, row in zip(rows, best_first):
            self.assertEqual(line["status"][0], row["status"].decode())
            self.assertEqual(line["seed"][0], str(row["seed"]))
            self.assertEqual(line["window.length"][1], row["window.length"])
            self.assertEqual(line["mixture.covariance"][0], row["mixture.covariance"].decode())
            for name in scores:
                self.same(line[name][1], row[name])

    def test_whether_the_best_is_better(self):
        self.open(self.page())
        stored = self.stored()
        order = (-stored["bank_test_log_score"]).argsort(kind="stable")
        best = stored[order[0]]
        rivals = self.table("The next best settings")
        self.assertEqual(len(rivals), 8)
        for rival, row in zip(rivals, stored[order[1:9]]):
            gain = rival["Best is ahead by [nats/sample]"]
            # The mean difference over the same samples equals the difference of scores.
            self.assertAlmostEqual(gain[1], float(best["bank_test_log_score"] - row["bank_test_log_score"]), places=9)
            self.assertIn("±", gain[0])
            self.assertEqual(rival["error from"][0], "6 runs")

    def test_sorting(self):
        self.open(self.page())
        self.assertEqual(self.column("bank_test_log_score"), sorted(self.stored()["bank_test_log_score"], reverse=True))  # the initial order
        self.sort_by("bank_test_log_score")
        self.assertEqual(self.column("bank_test_log_score"), sorted(self.stored()["bank_test_log_score"]))
        self.sort_by("bank_test_log_score")
        self.assertEqual(self.column("bank_test_log_score"), sorted(self.stored()["bank_test_log_score"], reverse=True))
        self.assertEqual(session.browser.run("return document.querySelectorAll('#study-table th[aria-sort=descending]').length"), 1)

    def test_filtering_and_what_follows_it(self):
        self.open(self.page())
        session.browser.draw_all("#effects")
        stored = self.stored()
        points = "return document.querySelector('#effects div.plot').drawing.panels[0].marks[0].x.length"
        self.assertEqual(session.browser.run(points), len(stored))
        self.filter("mixture.components", ">= 2")
        self.assertEqual(len(self.rows()), sum(stored["mixture.components"] >= 2))
        self.filter("mixture.covariance", "diag")
        wanted = (stored["mixture.components"] >= 2) & (stored["mixture.covariance"] == b"diagonal")
        self.assertEqual(sorted(self.column("bank_test_log_score")), sorted(stored["bank_test_log_score"][wanted]))
        session.browser.wait(points + " === arguments[0]", int(sum(wanted)), what="the effects to follow")
        self.filter("mixture.components", "1 | 3")
        self.assertEqual({row["mixture.components"][1] for row in self.rows()}, {1, 3})
        self.filter("mixture.components", "")
        self.filter("mixture.covariance", "")
        self.assertEqual(len(self.rows()), len(stored))
        self.assert_quiet()

    def test_main_effects(self):
        self.open(self.page())
        session.browser.draw_all()
        stored = self.stored()
        score = stored["bank_test_log_score"]
        effects = "return document.querySelector('#effects div.plot').drawing.panels.map(({marks}) => marks.find(({name}) => name === 'main effect').y)"
        choose = """const select = [...document.querySelectorAll(arguments[0] + ' label')].find((l) => l.textContent.startsWith('Show')).querySelector('select');
            select.selectedIndex = arguments[1]; select.dispatchEvent(new Event('change'));"""
        keys = ["window.length", "mixture.components", "mixture.covariance"]
        for way, of in ((0, lambda values: values.max()), (1, lambda values: values.mean())):
            session.browser.run(choose, "#effects", way)
            first = stored[keys[0]] == min(stored[keys[0]])
            session.browser.wait(f"{effects.replace('return', 'return Math.abs(')}[0][0] - arguments[0]) < 1e-9", float(of(score[first])), what="the main effects")
            for key, shown in zip(keys, session.browser.run(effects)):
                levels = list(dict.fromkeys(stored[key].tolist()))
                levels = levels if key == "mixture.covariance" else sorted(levels)
                for level, value in zip(levels, shown):
                    self.assertAlmostEqual(value, float(of(score[stored[key] == level])), places=10)
                if way == 0:
                    self.assertEqual(max(shown), score.max())  # the plots agree with the verdict

    def test_a_run_is_a_click_away(self):
        self.open(self.page())
        session.browser.run("document.getElementById('show-best').click()")
        detail = session.browser.run("return document.getElementById('run-detail').textContent")
        stored = self.stored()
        best = stored[stored["bank_test_log_score"].argmax()]
        self.assertIn(best["key"].decode(), detail)
        self.assertIn("mixture.components", detail)
        link = session.browser.run("return document.getElementById('run-page').href")
        session.browser.driver.get(link)
        session.browser.wait("return document.documentElement.dataset.ready === 'true'", what="the best run's page")
        rows = [row for row in self.table("Scores, all runs together") if (row["Filter"][0], row["Runs"][0]) == ("bank", "held out")]
        self.assertEqual([row["Log score [nats]"][1] for row in rows], [best["bank_test_log_score"]])
        self.open(self.page())
        session.browser.run("document.querySelector('#study-table tbody tr').click()")
        self.assertIn(best["key"].decode(), session.browser.run("return document.getElementById('run-detail').textContent"))  # the best run is first
        self.assert_quiet()
