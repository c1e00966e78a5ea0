"""The page of a study."""
import h5py
import session
from session import PageTest

STUDY_SECTIONS = ["verdict", "better", "runs", "effects", "origin"]


class StudyPage(PageTest):
    def page(self):
        return session.modebank.page("study", session.made["study"])

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

    def test_numbers_are_the_tables(self):
        self.assert_whole(self.page(), STUDY_SECTIONS)
        session.browser.screenshot("study")
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

    def test_sorting(self):
        self.open(self.page())
        self.assertEqual(self.column("bank_test_log_score"), sorted(self.stored()["bank_test_log_score"], reverse=True))  # the initial order
        self.sort_by("bank_test_log_score")
        self.assertEqual(self.column("bank_test_log_score"), sorted(self.stored()["bank_test_log_score"]))
        self.sort_by("bank_test_log_score")
        self.assertEqual(self.column("bank_test_log_score"), sorted(self.stored()["bank_test_log_score"], reverse=True))
        self.assertEqual(session.browser.run("return document.querySelectorAll('#study-table th[aria-sort=descending]').length"), 1)

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
