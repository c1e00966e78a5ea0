"""The page of two runs, and files from which no page can be made."""
import shutil
import unittest

import accessible
import h5py
import session
from session import PageTest, pooled

COMPARE_SECTIONS = ["verdict", "differences", "modes", "origin"]


class ComparePage(PageTest):
    def test_two_runs(self):
        self.assert_whole(session.modebank.page("compare", session.made["demo"], session.made["one_mode"]), COMPARE_SECTIONS)
        session.browser.screenshot("compare_light")
        differing = {row["Setting"][0]: (row["A"][0], row["B"][0]) for row in self.table("Different settings that change results")}
        self.assertEqual(differing, {"mixture.components": ("1..4", "1")})
        first, second = pooled(session.made["demo"]), pooled(session.made["one_mode"])
        rows = [row for row in self.table("Scores side by side") if row["Score"][0].startswith("log score") and row["Filter"][0] == "bank"]
        self.assertEqual(len(rows), 2)
        for row in rows:
            role = "test" if row["Runs"][0] == "held-out runs" else "train"
            a, b = first["bank", role]["log_score"], second["bank", role]["log_score"]
            self.assertEqual((row["A"][1], row["B"][1]), (a, b))
            self.assertEqual(row["B − A"][1], b - a)
        self.modes_are_listed()
        accessible.assert_accessible(self)
        session.browser.scheme("dark")
        self.assert_whole(session.work / "compare.html", COMPARE_SECTIONS)
        session.browser.screenshot("compare_dark")
        self.assert_legible(360, 1400)
        session.browser.scheme("light")

    def modes_are_listed(self):
        """Each bank's modes with their parameters, and those of one mode matched with one of the other's."""
        rows = self.table("Modes of A and B")
        for letter, name in (("A", "demo"), ("B", "one_mode")):
            with h5py.File(session.made[name]) as file:
                theta = sorted(file["bank/A"][:, 0, 0])  # coefficient of the newest sample
            column = next(heading for heading in rows[0] if heading.startswith(f"{letter}: "))
            shown = sorted(row[column][1] for row in rows if row[column][1] is not None)
            self.assertEqual(len(shown), len(theta))
            for value, stored in zip(shown, theta):
                self.assertAlmostEqual(value, stored, places=12)
        matched = [row for row in rows if "–" not in (row["Mode of A"][0], row["Mode of B"][0])]
        self.assertEqual(len(matched), 1)

    def test_the_verdict_has_an_error(self):
        self.open(session.modebank.page("compare", session.made["demo"], session.made["one_mode"]))
        first, second = (pooled(session.made[name])["bank", "test"]["log_score"] for name in ("demo", "one_mode"))
        text = session.browser.run("return document.getElementById('verdict').textContent")
        self.assertRegex(text, rf"On 6 held-out runs that both have, .*by {abs(second - first):.3f} ± 0\.\d+ nats per sample")
        self.assertIn("scores are equal", text)  # folded, because both have the same competitors

    def test_runs_of_other_data(self):
        if "ice" in session.made:
            self.assert_whole(session.modebank.page("compare_other", session.made["demo"], session.made["ice"]), COMPARE_SECTIONS)
            self.assertIn("cannot be compared", session.browser.run("return document.getElementById('verdict').textContent"))


class Refusals(unittest.TestCase):
    """A broken, foreign or partial archive: the fault is reported and nothing is written."""

    def refuse(self, path, status, *words):
        page = session.work / "refused.html"
        result = session.modebank("report", path, "-o", page, status=status)
        for word in words:
            self.assertIn(word, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertFalse(page.exists())

    def test_files(self):
        whole = session.made["demo"].read_bytes()
        broken = session.work / "broken.h5"
        broken.write_bytes(whole[:len(whole) // 2] + bytes([whole[len(whole) // 2] ^ 1]) + whole[len(whole) // 2 + 1:])
        self.refuse(broken, 1, "broken.h5", "SHA-256")
        broken.write_bytes(whole[:len(whole) // 3])
        self.refuse(broken, 1, "broken.h5")
        foreign = session.work / "foreign.h5"
        with h5py.File(foreign, "w") as file:
            file["x"] = [1, 2, 3]
        self.refuse(foreign, 1, "foreign.h5", "modebank")
        foreign.write_text("time,wz\n0,1\n")
        self.refuse(foreign, 1, "foreign.h5")
        self.refuse(session.work / "absent.h5", 2, "absent.h5")
        empty = session.work / "no_study"
        empty.mkdir()
        self.refuse(empty, 2, "no_study")

    def test_a_partial_archive(self):
        partial = session.work / "partial.h5"
        shutil.copy(session.made["demo"], partial)
        with h5py.File(partial, "a") as file:
            del file["bank/A"]
        self.refuse(partial, 1, "partial.h5")

    def test_a_page_that_cannot_be_written(self):
        session.modebank("report", session.made["demo"], "-o", session.work / "no" / "folder.html", status=2)
        session.modebank("report", session.made["demo"], "-o", session.made["demo"], status=2)
