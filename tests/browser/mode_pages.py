"""Modes on a run's page compared with known labels."""
import re

import archives
import h5py
import session
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
