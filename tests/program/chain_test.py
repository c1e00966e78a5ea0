"""From data to the page: windows, mixture, bank, scores and free run computed again from the archive's own arrays."""
import json
import pathlib
import re
import shutil
import tempfile
import unittest
from math import erf, sqrt

import numpy as np

import program
from program import DATA, REQUIRED, SOURCE, ProgramTest, arrays, attributes, demo, differing, facts, modebank, rows

QUICK = ("--window.loss=trivial", "--window.prior=none", "--mixture.components=1..3", "--mixture.noise_component=false",
         "--mixture.restarts=2", "--filter.simulate=5")
normal_cdf = np.vectorize(lambda x: 0.5 * (1 + erf(x / sqrt(2))))


def imm(bank, y, u):
    """A scalar IMM filter in the linear domain (Bar-Shalom, Li & Kirubarajan 2001, 11.6.6): what it says per sample."""
    F, B, c, Q = 1 + bank["A"][:, 0, 0], bank["B"][:, 0], bank["c"][:, 0], bank["Q"][:, 0, 0]
    R, T, mu = bank["R"][0, 0], bank["transition"], bank["initial_probability"]
    x, P, found = np.full(len(F), y[0]), np.full(len(F), R), []
    for k in range(1, len(y)):
        before = T.T @ mu
        W = T * mu[:, None] / before
        start = W.T @ x
        P = F * F * (W * (P[:, None] + (x[:, None] - start) ** 2)).sum(axis=0) + Q
        predicted = F * start + B @ u[k - 1] + c
        S, e, mean = P + R, y[k] - predicted, before @ predicted
        density = np.exp(-e * e / (2 * S)) / np.sqrt(2 * np.pi * S)
        mu = np.maximum(before * density / (before @ density), 1e-12)
        mu /= mu.sum()
        x, P = predicted + P / S * e, P * R / S
        found.append((mean, before @ (S + (predicted - mean) ** 2), np.log(before @ density),
                      before @ normal_cdf(e / np.sqrt(S)), mu @ x, *mu))
    return np.array(found).T


class Chain(ProgramTest):
    """Four simulated runs on two grounds and their archive, made once."""
    @classmethod
    def setUpClass(cls):
        cls.place = pathlib.Path(tempfile.mkdtemp(prefix="modebank-program-test-"))
        cls.addClassCleanup(shutil.rmtree, cls.place)
        modebank("simulate", demo() / "simulate_demo.ini", "--simulate.output", cls.place / "data",
                 "--simulate.runs=4", "--simulate.samples=200")
        cls.archive, cls.words = cls.place / "a.h5", (demo() / "demo.ini", "--data.root", cls.place / "data", *QUICK)
        cls.facts = facts("run", *cls.words, "--archive.output", cls.archive, "--job.threads=1")
        cls.all = arrays(cls.archive)
        cls.runs = {run["name"]: slice(run["first"], run["first"] + run["samples"]) for run in cls.all["data/runs"]}

    def close(self, found, expected, tolerance=1e-9, **what):
        np.testing.assert_allclose(found, expected, rtol=tolerance, atol=tolerance, err_msg=str(what))

    def of(self, path):
        return {name[len(path) + 1:]: array for name, array in self.all.items() if name.startswith(path + "/")}

    def steps(self, run, first=0, transitions=None):
        """Regressors and increments of the transitions of a run."""
        state, u = (self.all["data/" + name][self.runs[run]][first:] for name in ("state", "input"))
        end = transitions or len(u) - 1
        return np.hstack([state, u])[:end], np.diff(state[:end + 1, 0])

    def test_windows_are_least_squares(self):
        windows, length = self.of("windows"), attributes(self.archive, "windows")["length"]
        for i in np.flatnonzero(windows["rank"] == 3)[::5]:
            X, d = self.steps(windows["run"][i], windows["start"][i], length)
            theta = np.linalg.lstsq(X, d, rcond=None)[0]
            variance = ((d - X @ theta) ** 2).sum() / (length - 3)
            self.close(windows["parameters"][i], theta)
            self.close(windows["noise_variance"][i], variance)
            self.close(windows["covariance"][i] / variance, np.linalg.inv(X.T @ X), 1e-7)
        training = [self.steps(run["name"]) for run in rows(self.all["data/runs"], role="train")]
        X, d = (np.concatenate(part) for part in zip(*training))
        self.close(windows["global/parameters"], np.linalg.lstsq(X, d, rcond=None)[0])

    def test_the_mixture_is_its_density_and_bic_chooses_it(self):
        mixture, clustered = self.of("mixture"), self.all["mixture/labels"] >= 0
        parameters, variance = (self.all["windows/" + name][clustered] for name in ("parameters", "noise_variance"))
        features = np.column_stack([parameters, np.log(variance)])
        logs = np.array([np.log(w) - 0.5 * np.linalg.slogdet(2 * np.pi * C)[1]
                         - 0.5 * ((features - m) @ np.linalg.inv(C) * (features - m)).sum(axis=1) for w, m, C in
                         zip(mixture["weights"], mixture["means"], mixture["covariances"])])
        density = np.logaddexp.reduce(logs)
        self.close(mixture["weights"].sum(), 1)
        self.close(mixture["responsibilities"][clustered].T, np.exp(logs - density), 1e-8)
        table = mixture["candidates"]
        n = table["effective_samples"]
        bic = -2 * n / clustered.sum() * table["log_likelihood"] + table["parameters"] * np.log(n)
        self.close(table["bic"], bic)
        self.assertEqual(table["selected"].tolist(), (bic == bic.min()).astype(int).tolist())
        self.close(table["log_likelihood"][bic.argmin()], density.sum(), 1e-8)

    def test_the_bank_is_lawful_and_near_the_truth(self):
        for name in ("bank", "baseline", "noise_only", "one_motion"):
            bank = self.of(name)
            self.close(bank["transition"].sum(axis=1), 1)
            self.close(bank["initial_probability"].sum(), 1)
            self.assertTrue((np.linalg.eigvalsh(bank["Q"]) > 0).all())
        bank = self.of("bank")
        truth = np.array([[-0.486583, -0.462254, 0.462254], [-0.153518, -0.076759, 0.076759]])
        order = bank["A"].argsort(axis=0).ravel()
        theta, error = bank["parameters"][order], bank["parameter_standard_error"][order]
        self.assertTrue((abs(theta - truth) < 4 * error).all() and (error < 0.1 * abs(truth)).all(), (theta, error))

    def test_the_evaluation_is_a_textbook_imm_filters(self):
        said, names = self.of("evaluation/bank"), ("prediction", "innovation_covariance", "log_density", "pit", "state")
        for run in self.runs.values():
            found = imm(self.of("bank"), self.all["data/state"][run, 0], self.all["data/input"][run])
            for name, values in zip(names, found):
                self.close(said[name][run].ravel()[1:], values, name=name)
            self.close(said["mode_probability"][run][1:].T, found[len(names):])

    def test_scores_are_those_of_the_samples(self):
        data, low, high = self.all["data/runs"], 0.0009820691171752583, 5.023886187314888  # quantiles of chi-square(1)
        for row in self.all["evaluation/summary"]:
            kept = data[(data["role"] == row["role"]) & ((data["name"] == row["run"]) | (row["run"] == b"*"))]
            at = np.concatenate([np.arange(*self.runs[name].indices(10**9))[1:] for name in kept["name"]])
            said = {name: array[at].ravel() for name, array in self.of("evaluation/" + row["filter"].decode()).items()
                    if array.size == len(self.all["data/time"])}
            e, nis, middle = said["innovation"], said["nis"], abs(said["pit"] - 0.5)
            ranks = np.arange(len(at) + 1) / len(at)
            distance = max(abs(np.sort(said["pit"]) - part).max() for part in (ranks[1:], ranks[:-1]))
            expected = dict(samples=len(at), log_score=said["log_density"].mean(), rmse=np.sqrt((e**2).mean()),
                            nis_mean=nis.mean(), nis_above=(nis > high).mean(), nis_below=(nis < low).mean(),
                            too_far=(middle > 0.4875).mean(), too_close=(middle < 0.0125).mean(), pit_distance=distance,
                            **{f"coverage_{p}": (middle <= p / 200).mean() for p in (50, 90, 95, 99)})
            for name, value in expected.items():
                self.close(row[name], value, 1e-8, column=name, filter=row["filter"])
            self.close(e, (self.all["data/state"][at, 0] - said["prediction"]))
            self.close(nis, e * e / said["innovation_covariance"])

        evidence = attributes(self.archive, "evaluation/evidence")
        bank, rival = (rows(self.all["evaluation/summary"], filter=name, role="test", run="*")["log_score"][0]
                       for name in ("bank", evidence["best_competitor"]))
        self.close((evidence["gain"], self.facts["summary"]["gain"]), bank - rival)

    def test_free_run_is_scored_and_predict_repeats_it_from_inputs_alone(self):
        for row in rows(self.all["evaluation/free_run"], run="01"):
            at, free = self.runs[b"01"], self.of("evaluation/" + row["filter"].decode())
            y, mean = (array[at.start + 5:at.stop, 0] for array in (self.all["data/state"], free["free_run_mean"]))
            self.close(row["rmse"], np.sqrt(((y - mean) ** 2).mean()))
            self.close(row["fit"], 100 * (1 - np.linalg.norm(y - mean) / np.linalg.norm(y - y.mean())))
            if row["filter"] == b"combined":
                continue
            said = facts("predict", self.archive, "--samples=5", "--filter", row["filter"].decode(), "--data.inputs",
                         self.place / "data/pro_01.csv", "--data.states", self.place / "data/imu_01.csv")["runs"][0]
            for name, array in (("predicted", "mean"), ("sd", "sd"), ("lower", "lower"), ("upper", "upper")):
                self.close(said["states"]["wz"][name], free["free_run_" + array][at.start + 5:at.stop, 0], 0)

    def test_the_same_bits_for_any_threads_and_from_the_archived_configuration(self):
        (self.folder / "again.ini").write_bytes(self.all["config"])
        for words in ((*self.words, "--job.threads=2"), (self.folder / "again.ini",)):
            modebank("run", *words, "--archive.output", self.folder / "b.h5")
            self.assertEqual(differing(self.archive, self.folder / "b.h5"), [])

    def test_show_report_and_verify(self):
        full = facts("show", self.archive, "/bank/A", "--form=full")["value"]
        self.assertEqual(full, (1 + self.all["bank/A"]).tolist())
        times = facts("show", self.archive, "/data/time", "--run=01")["value"]
        self.assertEqual(times, self.all["data/time"][self.runs[b"01"]].tolist())
        self.assertTrue(modebank("show", self.archive, env={"LC_ALL": "C"}).out.isascii())
        modebank("report", self.archive, "-o", self.folder / "page.html")
        page = (self.folder / "page.html").read_text()
        self.assertIsNone(re.search(r"""(?:src|href)=["']?https?:|url\(["']?https?:|@import|fetch\(""", page))
        self.assertGreater(len(page), 100_000)  # scripts and data
        modebank("verify", self.archive)
        content = bytearray(self.archive.read_bytes())
        content[len(content) // 2] ^= 1
        (self.folder / "flipped.h5").write_bytes(content)
        (self.folder / "half.h5").write_bytes(content[:len(content) // 2])
        for name in ("flipped.h5", "half.h5"):
            self.assertIn(name, modebank("verify", self.folder / name, status=1).out)

    def test_a_motion_model_finds_its_parameter(self):
        draw = np.random.default_rng(3)
        for run in range(4):
            u = np.repeat(draw.uniform(-1, 1, (60, 2)), 5, axis=0)
            distance = np.where(np.arange(300) // 75 % 2, 2.0, 1.3)  # m, of the centres of rotation
            wz = np.r_[0, ((u[:, 1] - u[:, 0]) / distance)[:-1]] + draw.normal(0, 0.01, 300)
            table = np.column_stack([np.arange(300) / 10, wz, u])
            np.savetxt(self.folder / f"r_{run}.csv", table, delimiter=",", header="time,wz,left,right", comments="")
        (self.folder / "icr.ini").write_text("[data]\ninputs = r_*.csv\nstate = wz\ninput = left, right\n"
                                             "[window]\nmodel = icr\n[mixture]\ncomponents = 2\n")
        modebank("run", "icr.ini", cwd=self.folder)
        bank = arrays(self.folder / "icr.h5", "bank")
        found = np.sort(bank["motion_parameters"], axis=0)
        self.assertTrue((abs(found - [[1.3], [2.0]]) < 4 * bank["motion_standard_error"].max()).all(), found)


class Known(ProgramTest):
    def test_demo_finds_its_truth(self):
        found = json.loads((demo().parent / "demo.json").read_text())["truth"]
        numbers = [number for mode in found["modes"] for number in mode["numbers"]]
        self.assertEqual(sorted(round(number["truth"], 4) for number in numbers),
                         [-0.95, -0.5, 0.005, 0.005, 0.15, 0.5, 0.6, 0.95])
        for number in numbers:
            self.assertLess(abs(number["found"] - number["truth"]), 3 * number["error"], number)
            self.assertLess(number["error"], 0.03 * abs(number["truth"]), number)
        archive = demo() / "demo.h5"
        every, names = arrays(archive), attributes(archive, "bank")["mode_names"]
        held_out = np.concatenate([np.arange(run["first"], run["first"] + run["samples"])
                                   for run in rows(every["data/runs"], role="test")])
        modes = names[every["evaluation/bank/mode_probability"][held_out].argmax(axis=1)]
        share = (modes == attributes(archive, "data")["label_names"][every["data/label"][held_out]]).mean()
        self.assertGreater(share, 0.97)
        self.assertAlmostEqual(share, found["agreement"], 9)

    @unittest.skipUnless(REQUIRED or (DATA / "borealtc/ICE").is_dir(), "no borealtc/ICE in MODEBANK_DATA")
    def test_the_published_recipe_on_ice(self):
        modebank("run", SOURCE / "configs/salvi2025.ini", "--data.root", DATA, "--archive.output", self.folder / "s.h5")
        summary = arrays(self.folder / "s.h5", "evaluation")["summary"]
        for name, score, above, below in (("bank", 0.9473, 0.0003, 0.0500), ("baseline", 2.5187, 0.0092, 0.0301)):
            row = rows(summary, filter=name, role="test", run="*")[0]
            np.testing.assert_allclose((row["log_score"], row["nis_above"], row["nis_below"]), (score, above, below),
                                       atol=6e-5)


if __name__ == "__main__":
    program.main()
