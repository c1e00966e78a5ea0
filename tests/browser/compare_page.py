"""The page of two runs."""
import h5py
import session
from session import PageTest, pooled

COMPARE_SECTIONS = ["verdict", "differences", "modes", "origin"]


class ComparePage(PageTest):
    def test_two_runs(self):
        self.assert_whole(session.modebank.page("compare", session.made["demo"], session.made["one_mode"]), COMPARE_SECTIONS)
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
        session.browser.screenshot("compare")

    def modes_are_listed(self):
        """Each bank's modes with their parameters."""
        for letter, name in (("A", "demo"), ("B", "one_mode")):
            rows = self.table(f"Modes of {letter}")
            with h5py.File(session.made[name]) as file:
                theta = sorted(file["bank/A"][:, 0, 0])  # coefficient of the newest sample
            shown = sorted(list(row.values())[2][1] for row in rows)
            self.assertEqual(len(shown), len(theta))
            for value, stored in zip(shown, theta):
                self.assertAlmostEqual(value, stored, places=12)
