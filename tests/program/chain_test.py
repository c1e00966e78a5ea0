"""From data to the page: windows, mixture, bank, scores and free run computed again from the archive's own arrays."""
import json
from math import erf, sqrt

from program import (ProgramTest, arrays, attributes, demo, differing, facts, learn, main, modebank, np, rows,
                     slices)

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
        super().setUpClass()
        modebank("simulate", demo() / "simulate_demo.ini", "--simulate.output", cls.place / "data",
                 "--simulate.runs=4", "--simulate.samples=200")
        cls.archive, cls.words = cls.place / "a.h5", (demo() / "demo.ini", "--data.root", cls.place / "data", *QUICK)
        cls.facts = facts("run", *cls.words, "--archive.output", cls.archive, "--job.threads=1")
        cls.all, cls.runs = arrays(cls.archive), slices(cls.archive)
        cls.state, cls.input = cls.all["data/state"][:, 0], cls.all["data/input"]

    def close(self, found, expected, tolerance=1e-9, **what):
        np.testing.assert_allclose(found, expected, rtol=tolerance, atol=tolerance, err_msg=str(what))

    def of(self, path):
        return {name[len(path) + 1:]: array for name, array in self.all.items() if name.startswith(path + "/")}

    def test_windows_are_least_squares(self):
        windows, steps = self.of("windows"), np.arange(attributes(self.archive, "windows")["length"])
        for i in np.flatnonzero(windows["rank"] == 3)[::5]:
            at = self.runs[windows["run"][i].decode()].start + windows["start"][i] + steps
            X, d = np.column_stack([self.state, self.input])[at], np.diff(self.state)[at]
            theta = np.linalg.lstsq(X, d, rcond=None)[0]
            variance = ((d - X @ theta) ** 2).sum() / (len(steps) - 3)
            self.close(windows["parameters"][i], theta)
            self.close(windows["noise_variance"][i], variance)
            self.close(windows["covariance"][i] / variance, np.linalg.inv(X.T @ X), 1e-7)

    def test_the_mixture_is_its_density_and_bic_chooses_it(self):
        mixture, clustered = self.of("mixture"), self.all["mixture/labels"] >= 0
        windows = self.of("windows")
        features = np.column_stack([windows["parameters"], np.log(windows["noise_variance"])])[clustered]
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

    def test_the_bank_is_regressions_weighted_by_memberships(self):
        """The membership of a transition is the mean responsibility of the windows that cover it."""
        found = arrays(learn(self.folder, "--mixture.components=2", "--mixture.noise_component=false",
                             "--bank.refine=none", "--window.intercept=false", "--window.step=1",
                             "--window.prior=none", samples=300))
        x, u, gamma = (found[name] for name in ("data/state", "data/input", "mixture/responsibilities"))
        X, d, weights = np.c_[x, u][:299], np.diff(x[:300, 0]), np.zeros((299, 3))
        length = 299 - found["windows/start"].max()
        for i in np.flatnonzero(np.isfinite(gamma[:, 0])):
            weights[found["windows/start"][i] + np.arange(length)] += [*gamma[i], 1]
        for k, w in enumerate((weights[:, :2] / weights[:, 2:]).T):
            inverse = np.linalg.inv(X.T * w @ X)
            theta = inverse @ (X.T * w) @ d
            scatter = w @ (d - X @ theta)**2
            self.close(found["bank/parameters"][k], theta, 1e-8)
            self.close(found["bank/Q"][k].ravel(), scatter / w.sum(), 1e-8)
            self.close(found["bank/parameter_standard_error"][k],
                       np.sqrt(scatter / (w.sum() - 3) * inverse.diagonal()), 1e-8)

    def test_the_largest_number_of_components_is_the_most_modes(self):
        for components, modes in (("1..4", 3), ("2", 2)):
            archive = learn(self.folder, "--window.intercept=false", f"--mixture.components={components}", samples=600,
                            grips=(0.6, 0.3, 0.1))
            self.assertEqual(len(arrays(archive)["bank/weight"]), modes)

    def test_the_evaluation_is_a_textbook_imm_filters(self):
        said, names = self.of("evaluation/bank"), ("prediction", "innovation_covariance", "log_density", "pit", "state")
        for run in self.runs.values():
            found = imm(self.of("bank"), self.state[run], self.input[run])
            for name, values in zip(names, found):
                self.close(said[name][run].ravel()[1:], values, name=name)
            self.close(said["mode_probability"][run][1:].T, found[len(names):])
        for bank in map(self.of, ("bank", "baseline", "noise_only", "one_motion")):
            self.close([*bank["transition"].sum(axis=1), bank["initial_probability"].sum()], 1)

    def test_scores_are_those_of_the_samples(self):
        """Those that golden_test.py does not compute."""
        summary = self.all["evaluation/summary"]
        for row in summary:
            runs = slices(self.archive, role=row["role"])
            at = np.concatenate([np.r_[runs[name]][1:] for name in runs if row["run"].decode() in ("*", name)])
            said = {name: array[at].ravel() for name, array in self.of("evaluation/" + row["filter"].decode()).items()
                    if array.size == len(self.state)}
            e, nis, middle = said["innovation"], said["nis"], abs(said["pit"] - 0.5)
            expected = dict(samples=len(at), log_score=said["log_density"].mean(), rmse=np.sqrt((e**2).mean()),
                            nis_mean=nis.mean(), too_close=(middle < 0.0125).mean(),
                            **{f"coverage_{p}": (middle <= p / 200).mean() for p in (50, 90, 95, 99)})
            for name, value in expected.items():
                self.close(row[name], value, 1e-8, column=name, filter=row["filter"])
            self.close(e, self.state[at] - said["prediction"])
            self.close(nis, e * e / said["innovation_covariance"])
        evidence = attributes(self.archive, "evaluation/evidence")
        bank, rival = (rows(summary, filter=name, role="test", run="*")["log_score"][0]
                       for name in ("bank", evidence["best_competitor"]))
        self.close((evidence["gain"], self.facts["summary"]["gain"]), bank - rival)

    def test_free_run_is_scored_and_predict_repeats_it_from_inputs_alone(self):
        at = slice(self.runs["01"].start + 5, self.runs["01"].stop)
        for row in rows(self.all["evaluation/free_run"], run="01"):
            free, y = self.of("evaluation/" + row["filter"].decode()), self.state[at]
            mean = free["free_run_mean"][at, 0]
            self.close(row["rmse"], np.sqrt(((y - mean) ** 2).mean()))
            self.close(row["fit"], 100 * (1 - np.linalg.norm(y - mean) / np.linalg.norm(y - y.mean())))
            said = facts("predict", self.archive, "--samples=5", "--filter", row["filter"].decode(), "--data.inputs",
                         self.place / "data/pro_01.csv", "--data.states", self.place / "data/imu_01.csv")["runs"][0]
            for name, array in (("predicted", "mean"), ("sd", "sd"), ("lower", "lower"), ("upper", "upper")):
                self.close(said["states"]["wz"][name], free["free_run_" + array][at, 0], 0)

    def test_the_same_bits_for_any_threads_and_from_the_archived_configuration(self):
        (self.folder / "again.ini").write_bytes(self.all["config"])
        for words in ((*self.words, "--job.threads=2"), (self.folder / "again.ini",)):
            modebank("run", *words, "--archive.output", self.folder / "b.h5")
            self.assertEqual(differing(self.archive, self.folder / "b.h5"), [])

    def test_show_and_report(self):
        times = facts("show", self.archive, "/data/time", "--run=01")["value"]
        self.assertEqual(times, self.all["data/time"][self.runs["01"]].tolist())
        modebank("report", self.archive, "-o", self.folder / "page.html")
        page = (self.folder / "page.html").read_text()
        self.assertNotRegex(page, r"""(?:src|href)=["']?https?:|url\(["']?https?:|@import|fetch\(""")
        self.assertGreater(len(page), 100_000)  # scripts and data


class Known(ProgramTest):
    def test_demo_finds_its_truth(self):
        found = json.loads((demo().parent / "demo.json").read_text())["truth"]
        numbers = [number for mode in found["modes"] for number in mode["numbers"]]
        self.assertEqual(sorted(round(number["truth"], 4) for number in numbers),
                         [-0.95, -0.5, 0.005, 0.005, 0.15, 0.5, 0.6, 0.95])
        for number in numbers:
            self.assertLess(abs(number["found"] - number["truth"]), 3 * number["error"], number)
            self.assertLess(number["error"], 0.03 * abs(number["truth"]), number)
        archive, every = demo() / "demo.h5", arrays(demo() / "demo.h5")
        modes = attributes(archive, "bank")["mode_names"][every["evaluation/bank/mode_probability"].argmax(axis=1)]
        right = modes == attributes(archive, "data")["label_names"][every["data/label"]]
        share = np.concatenate([right[run] for run in slices(archive, role="test").values()]).mean()
        self.assertGreater(share, 0.97)
        self.assertAlmostEqual(share, found["agreement"], 9)

    def test_a_motion_model_finds_its_parameter(self):
        distances = (1.3, 2)  # m, of the centres of rotation: turn rate = (right - left) / distance
        archive = learn(self.folder, "--window.model=icr", "--mixture.components=2", samples=600, memory=0,
                        grips=np.divide(1, distances), stretch=75)
        bank = arrays(archive, "bank")
        found = np.sort(bank["motion_parameters"], axis=0).ravel()
        self.assertTrue((abs(found - distances) < 4 * bank["motion_standard_error"].max()).all(), found)


if __name__ == "__main__":
    main()
