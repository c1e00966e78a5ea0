"""Modes on a run's page compared with known labels, and with the border at which a hybrid system switches."""
import re

import archives
import h5py
import session
from run_pages import RUN_SECTIONS
from session import PageTest


class ModePages(PageTest):
    def test_confusion_counts_the_samples_of_each_label(self):
        """Counted from the archive's samples, not from its own table."""
        self.open(session.modebank.page("demo", session.made["demo"]))
        counts = {}
        with h5py.File(session.made["demo"]) as file:
            names = [name.decode() for name in file["data"].attrs["label_names"]]
            for run in archives.held_out(file):
                rows = archives.rows(file, run)
                modes = file["evaluation/bank/mode_probability"][rows].argmax(1)
                for label, mode in zip(file["data/label"][rows], modes):
                    counts.setdefault(names[label], [0] * len(file["bank/weight"]))[mode] += 1
        table = self.table("Most probable mode of each label’s samples")
        self.assertEqual([row["Label"][0] for row in table], names)
        for row in table:
            expected = counts[row["Label"][0]]
            self.assertEqual(row["Samples"][1], sum(expected))
            families = {tuple(map(int, re.findall(r"\d+", found[1]))): value for heading, (_, value) in row.items()
                        if (found := re.search(r"modes? ([\d, ]+)", heading))}
            self.assertEqual(sorted(sum(families, ())), list(range(len(expected))))
            for modes, share in families.items():
                self.assertAlmostEqual(share, sum(expected[k] for k in modes) / sum(expected), places=12)

    def test_the_guard_is_drawn_where_it_is(self):
        """The mode of every input is known: the second above the border, which no input is near to."""
        self.assert_whole(session.modebank.page("guard", session.made["guard"]), RUN_SECTIONS)
        with h5py.File(session.made["guard"]) as file:
            second = int(file["bank/B"][:].ravel().argmin())  # the mode with gain -0.3
        guard, traces = session.browser.run("""
            const plot = [...document.querySelectorAll('#bank div.plot')].find((p) => p.ariaLabel.startsWith('Which states and inputs'));
            const [{x: axis, marks}] = plot.drawing.panels;
            return [axis.title, marks.map(({kind, name, x, y}) => ({kind, name, x: [...x], y: [...y]}))];""")
        self.assertEqual(guard, "u [m/s]")
        samples = {trace["name"]: trace["x"] for trace in traces if trace["kind"] == "points"}
        self.assertEqual(sum(map(len, samples.values())), 4 * 299)
        for name, inputs in samples.items():
            right = [(u > archives.GUARD_BORDER) == (name == f"mode {second}") for u in inputs]
            self.assertGreater(sum(right), 0.9 * len(right))
        lines = {trace["name"]: trace for trace in traces if trace["kind"] == "line"}
        self.assertEqual(len(lines), 2)
        for name, line in lines.items():
            for u, share in zip(line["x"], line["y"]):
                if abs(u - archives.GUARD_BORDER) > 0.1:
                    self.assertEqual(share > 0.5, (u > archives.GUARD_BORDER) == (name == f"mode {second}"), f"{name} at {u}")
        session.browser.screenshot("guard")
