"""Numbers of other software (tests/golden/generate) and of public data sets, in archives that the program writes."""
import json
import math
import os
import statistics
import unittest

import program
from program import DATA, SOURCE, ProgramTest, arrays, modebank, np, rows

GOLDEN = SOURCE / "tests/golden/data"
QUICK = ("--mixture.components=1", "--bank.refine=none", "--filter.horizon=1", "--window.step=5")


def golden(name):
    return json.loads((GOLDEN / f"{name}.json").read_text())


def chi_square_tail(x, dof):
    """Probability of a larger value, in closed form."""
    half, tail = (0.5, math.erfc(math.sqrt(x / 2))) if dof % 2 else (1.0, math.exp(-x / 2))
    while half < dof / 2:
        tail += (x / 2)**half * math.exp(-x / 2) / math.gamma(half + 1)
        half += 1
    return tail


def ljung_box_p(z):
    z, lags = z - np.mean(z), min(20, len(z) // 5)
    rho = [z[k:] @ z[:-k] / (z @ z) for k in range(1, lags + 1)]
    return chi_square_tail(len(z) * (len(z) + 2) * sum(r**2 / (len(z) - k) for k, r in enumerate(rho, 1)), lags)


def student_score(errors):
    """Mean log density of Student's t with the likeliest scale, by golden sections, and of five degrees of freedom."""
    best, step = -math.inf, (math.sqrt(5) - 1) / 2
    for nu in (2, 4, 8, 30, 1000):
        def density(log_scale, nu=nu):
            constant = math.lgamma((nu + 1) / 2) - math.lgamma(nu / 2) - math.log(nu * math.pi) / 2
            return constant - log_scale - (nu + 1) / 2 * np.log1p((errors / math.exp(log_scale))**2 / nu).mean()
        low, high = math.log(errors.std()) - 6, math.log(errors.std()) + 2
        for _ in range(100):
            left, right = high - step * (high - low), low + step * (high - low)
            low, high = (left, high) if density(left) < density(right) else (low, right)
        best = max(best, density(low))
    return best


def fisher_p(p_values):
    return chi_square_tail(-2 * np.log(p_values).sum(), 2 * len(p_values))


class Golden(ProgramTest):
    def archive(self, *options, **data):
        """Arrays of the archive of a configuration with these keys of [data]."""
        keys = "".join(f"{key} = {value}\n" for key, value in {"root": self.folder, **data}.items())
        (self.folder / "golden.ini").write_text(f"[data]\n{keys}[window]\n")
        out = self.folder / "golden.h5"
        modebank("run", "golden.ini", "--archive.output", out, "--force", *options, cwd=self.folder)
        return arrays(out)

    def write(self, name, x, u):
        """A file of one run: x and u have one sample per row."""
        lines = [",".join(map(repr, row)) for row in np.column_stack([0.1 * np.arange(len(x)), x, u]).tolist()]
        header = [f"{letter}{i}" for letter, part in (("x", x), ("u", u)) for i in range(np.shape(part)[1])]
        (self.folder / name).write_text("\n".join([",".join(["time", *header]), *lines, ""]))
        return {letter: ", ".join(name for name in header if name[0] == letter) for letter in "xu"}

    def close(self, actual, expected, tolerance):
        np.testing.assert_allclose(np.ravel(actual), np.ravel(expected), rtol=0, atol=tolerance)


class Windows(Golden):
    def whole_run(self, case, intercept="false", prior="none"):
        """The window over the whole of a run, by least squares, and the global model. Another run is held out."""
        x, u = np.transpose(case["state"]), np.transpose(case["input"])
        names = self.write("run_0.csv", x, u)
        self.write("run_1.csv", 2 * x, u)
        found = self.archive("--until=windows", "--window.model=linear", f"--window.length={len(x) - 1}",
                             "--window.step=1", "--window.loss=trivial", f"--window.prior={prior}",
                             f"--window.intercept={intercept}", inputs="run_*.csv", state=names["x"], input=names["u"])
        about_zero = np.eye(x.shape[1] + u.shape[1] + (intercept == "true"))
        if intercept == "true":
            self.close(found["windows/centre"], np.concatenate([x.mean(axis=0), u.mean(axis=0)]), 1e-12)
            about_zero[-1, :-1] = -found["windows/centre"]
        about_zero = np.kron(np.eye(x.shape[1]), about_zero)
        for path in ("windows/global", "windows"):
            found[f"{path}/parameters"] = found[f"{path}/parameters"] @ about_zero.T
            found[f"{path}/covariance"] = about_zero @ found[f"{path}/covariance"] @ about_zero.T
        return found

    def test_global_model_is_statsmodels(self):
        for name, intercept in (("single_state", "false"), ("two_states", "true")):
            case = golden("ident_fits")[name]
            found = self.whole_run(case, intercept)
            for path in ("windows/global", "windows"):
                self.close(found[f"{path}/parameters"], case["ols"]["theta"], 1e-12)
                self.close(found[f"{path}/covariance"], case["ols"]["covariance"], 1e-12)
            self.assertEqual(found["windows/inlier_fraction"], [1.0])
            if name == "single_state":
                self.close(found["windows/global/noise_variance"], case["ols"]["population_variance"], 1e-12)

    def test_quality_is_statsmodels(self):
        case = golden("ident_inference")["ordinary_least_squares"]
        found = self.whole_run(case, "true")
        self.close(np.sqrt(np.diagonal(found["windows/covariance"][0])), case["standard_error"], 1e-11)
        self.close(found["windows/parameters"] / case["standard_error"], case["t_value"], 1e-9)
        self.close(found["windows/r_squared"], case["r_squared"], 1e-11)

    def test_structures_are_scored_as_numpy_scores_them(self):
        """Least squares on the rows that the most lags leave (12 of each, delays to 12), run r in fold r mod 5."""
        for delay, words, first, most in ((1, "--window.state_lags=2", 22, 2), (1, "--window.input_delay=0", 11, 12),
                                          (3, "--window.state_lags=2", 22, 2)):
            draw, runs = np.random.default_rng(3), []
            for r in range(8):
                n = 150 + 7 * r
                y, u = np.zeros((n, 2)), np.repeat(draw.normal(size=(n // 3 + 1, 1)), 3, 0)[:n]
                for k in range(3, n - 1):
                    y[k + 1] = y[k] @ [[0.9, -0.2], [0.1, 0.7]] - 0.2 * y[k - 1] + u[k + 1 - delay] * [0.3, -0.1] + 0.2
                    y[k + 1] += 0.05 * draw.standard_t(3, 2)
                y[17, 1] = np.nan if r == 2 else y[17, 1]
                names = self.write(f"run_{r}.csv", y, u)
                runs.append((y, u))
            said = self.archive("--until=windows", "--window.loss=trivial", "--window.intercept=true", words, test=7,
                                inputs="run_*.csv", state=names["x"], input=names["u"], missing="predict")
            with self.subTest(delay=delay, words=words):
                self.check_scores(said["structure/scores"], runs[:7], first, most)

    def check_scores(self, said, runs, first, most):
        rows = [(y, u, k, r % 5) for r, (y, u) in enumerate(runs) for k in range(first, len(y) - 1)
                if not np.isnan(y[k + 1 - most:k + 2]).any()]
        folds, Y = np.array([fold for *_, fold in rows]), np.array([y[k + 1] - y[k] for y, u, k, _ in rows])
        for of in said[np.isfinite(said["log_score"])]:
            at = of["input_delay"] - 1 + np.arange(of["input_lags"])
            lags = np.arange(of["state_lags"])
            X = np.array([np.r_[y[k - lags].ravel(), u[k - at].ravel(), 1] for y, u, k, _ in rows])
            e = np.concatenate([Y[folds == f] - X[folds == f] @ np.linalg.lstsq(X[folds != f], Y[folds != f], None)[0]
                                for f in range(5)])
            self.close(of["rmse"], np.sqrt((e**2).mean(axis=0)), 1e-12)
            self.close(of["log_score"], sum(map(student_score, e.T)), 1e-9)

    def test_condition_and_information(self):
        case, other = golden("ident_fits")["unexcited"], golden("ident_fits")["two_states"]
        sd = np.array(case["prior"]["sd"])
        found = self.whole_run(case, prior=", ".join(map(str, sd)))
        self.close(found["windows/information"], 1 - np.diagonal(found["windows/covariance"][0]) / sd**2, 1e-12)
        self.assertGreater(found["windows/condition"], 1e6)
        other_unit = {**other, "input": 1e6 * np.array(other["input"])}
        conditions = [self.whole_run(of, "true")["windows/condition"] for of in (other, other_unit)]
        self.close(conditions[1] / conditions[0], 1, 1e-10)

    def test_residual_tests_are_statsmodels(self):
        """A training run that hardly moves, so that the model predicts no motion: residuals are the steps of a run."""
        case = golden("ident_inference")["residual_tests"]
        residual, inputs = np.transpose(case["residual"]), np.transpose(case["input"])
        for name, count in ("all", len(residual)), ("first", 60):
            names = self.write(f"{name}.csv", np.cumsum(np.vstack([[0], residual[:count]]), axis=0),
                               np.vstack([inputs[:count], [0, 0]]))
        x, u = np.full((100, 1), 1e3), 1e9 * np.random.default_rng(1).uniform(-1, 1, (100, 2))
        x[50], u[50] = x[50] + 1e-6, u[49]
        self.write("still.csv", x, u)
        found = self.archive("--until=windows", "--window.model=linear", "--window.intercept=false", inputs="*.csv",
                             state=names["x"], input=names["u"], train="still")
        runs, lags = (rows(found[f"residual_tests/{table}"], model="global") for table in ("runs", "lags"))
        lags = rows(lags, run="all")
        self.assertEqual(len(lags) - 1, case["lags"])
        self.close(lags["autocorrelation"], case["autocorrelation"], 1e-12)
        self.close(lags["cross_correlation"].T, case["cross_correlation"], 1e-12)
        self.close(rows(runs, run="all")["autocorrelation_band"], 2.5758293 / 20, 1e-8)
        # statsmodels computes 12 lags for 60 samples. modebank's limit, a fifth of the samples, is also 12.
        self.close(rows(runs, run="first")["ljung_box_p"], case["ljung_box_p"], 1e-12)


class Banks(Golden):
    def learned(self, case):
        """The archive of the case's runs, which train, and of copies of them, which are held out."""
        for i, run in enumerate(case["runs"]):
            names = self.write(f"{i}_train.csv", run["x"], run["u"])
            self.write(f"{i}_test.csv", run["x"], run["u"])
        return self.archive("--window.model=linear", *QUICK, inputs="*.csv", state=names["x"],
                            input=names["u"], train=", ".join(f"{i}_train" for i in range(len(case["runs"]))))

    def test_noise_only_is_hubers_regression(self):
        for case in golden("learn_noise_only").values():
            bank = {name[11:]: value for name, value in self.learned(case).items() if name.startswith("noise_only/")}
            variances = np.transpose(case["variances"])
            self.assertEqual(len(bank["Q"]), 8)
            for j in range(8):
                self.close(bank["parameters"][j], case["theta"], 1e-10)
                self.close(bank["parameter_standard_error"][j], case["standard_error"], 1e-10)
                self.close(bank["Q"][j], np.diag(variances[j]), 1e-10)
                self.close(bank["weight"][j], 0.125, 1e-10)

    def test_baseline_is_nelder_meads(self):
        for case in golden("learn_baseline").values():
            found = self.learned(case)
            self.close(found["baseline/parameters"], case["theta"], 1e-10)
            self.close(found["baseline/Q"], case["Q"], 1e-5)
            self.close(found["baseline/R"], case["R"], 1e-5)
            total = rows(found["evaluation/summary"], filter="baseline", role="train", run="*")
            self.close(total["log_score"] * total["samples"], case["log_likelihood"], 1e-7)

    def test_scores_are_those_of_their_series(self):
        found, normal = self.learned(golden("learn_baseline")["vector"]), statistics.NormalDist()
        summary, p_values = rows(found["evaluation/summary"], filter="baseline", role="test"), []
        for run in rows(found["data/runs"], role="test"):
            scored = slice(run["first"] + 1, run["first"] + run["samples"])
            nis, pit = (found[f"evaluation/baseline/{name}"][scored] for name in ("nis", "pit"))
            z = np.array([[normal.inv_cdf(value) for value in output] for output in pit.T])
            p_values.append(fisher_p([ljung_box_p(output) for output in z]))
            row = rows(summary, run=run["name"])
            for name, value in (("whiteness_p", p_values[-1]), ("nis_above", (nis > -2 * math.log(0.025)).mean()),
                                ("nis_below", (nis < -2 * math.log(0.975)).mean()),
                                ("too_far", (abs(z) > normal.inv_cdf(0.9875)).mean()),
                                ("coverage_95", (abs(z) < normal.inv_cdf(0.975)).mean())):
                self.close(row[name], value, 1e-11)
        self.close(rows(summary, run="*")["whiteness_p"], fisher_p(p_values), 1e-11)


class Imports(Golden):
    def test_interpolation_is_numpys(self):
        knots, expected = (np.genfromtxt(GOLDEN / f"interpolation_{part}.csv", delimiter=",", names=True)
                           for part in ("knots", "expected"))
        inside = expected[(expected["time"] >= knots["time"][0]) & (expected["time"] <= knots["time"][-1])]
        (self.folder / "x.csv").write_text((GOLDEN / "interpolation_knots.csv").read_text())
        lines = [f"{row['time'].item()!r},{k % 3}" for k, row in enumerate(inside)]
        (self.folder / "u.csv").write_text("\n".join(["time,u", *lines, ""]))
        found = self.archive("--until=windows", "--window.model=linear", inputs="u.csv", states="x.csv", state="value",
                             input="u")
        order = np.argsort(found["data/time"])  # gaps split the run
        self.close(found["data/state"][order], inside["value"], 1e-14)


@unittest.skipUnless((DATA / "borealtc/ICE").is_dir() or os.environ.get("CI") == "true", "real data are absent")
class RealData(Golden):
    ICE = {"root": DATA, "inputs": "borealtc/ICE/pro_*.csv", "states": "borealtc/ICE/imu_*.csv", "state": "wz",
           "input": "velL, velR"}
    DRIVE = {"root": DATA, "inputs": "drive_husky/husky_samples.csv", "run": "block", "time": "t_block",
             "input": "wheel_left, wheel_right"}

    def drive(self, *options, **data):
        """Blocks of the Husky under random commands, all of which train. These tests need few windows."""
        return self.archive("--until=windows", "--window.length=100", "--window.step=100", *options,
                            train=", ".join(map(str, range(201))), **{**self.DRIVE, **data})

    def test_the_robot_arm_is_numpys(self):
        """A text without header and times, in exponents (DaISy)."""
        found = self.archive("--until=windows", "--window.model=linear", root=DATA,
                             inputs="sysid_classic/robot_arm.dat",
                             time="", rate_hz=1, input="c1", state="c2", split="last 50 %")
        values, read = np.loadtxt(DATA / "sysid_classic/robot_arm.dat"), np.c_[found["data/input"], found["data/state"]]
        first, second = found["data/runs"]["samples"]  # samples between them are dropped
        self.assertEqual(values.shape, (1024, 2))
        np.testing.assert_array_equal(read, np.vstack([values[:first], values[-second:]]))

    def test_ice_is_numpys(self):
        expected = np.genfromtxt(GOLDEN / "ice_import.csv", delimiter=",", names=True, dtype=None, encoding=None)
        for train, transitions in ({}, 2636), ({"train": "02, 04, 06, 08, 10, 12"}, 2921):  # method.md, section 7
            found = self.archive("--until=windows", "--window.model=linear", **self.ICE, **train)
            runs = found["data/runs"]
            self.assertEqual(sum(rows(runs, role="train")["samples"] - 1), transitions)
        self.assertEqual(len(runs), len(expected))
        self.assertEqual(len(found["provenance/inputs"]), 24)
        for run, row in zip(runs, expected):
            of_run = slice(run["first"], run["first"] + run["samples"])
            time, wz, wheels = (found[f"data/{name}"][of_run] for name in ("time", "state", "input"))
            self.assertEqual((int(run["name"]), run["samples"]), (int(row["run"]), row["samples"]))
            self.assertEqual((time[0], time[-1]), (row["first"], row["last"]))
            self.close([wz.mean(), (wz**2).mean(), *wheels.mean(axis=0)], list(row)[4:], 1e-12)

    def test_drive_blocks_are_runs(self):
        found = self.drive("--window.model=linear", state="gyro_z", truth="icp_yawrate_fit")
        runs = found["data/runs"]
        self.assertEqual(len(runs), 201)  # the data's README: 201 blocks of 3 x 40 samples at 20 Hz
        self.assertEqual(runs["name"][2], b"10")  # names in byte order: 0, 1, 10, 100, ...
        self.assertEqual(set(runs["samples"]), {120})
        self.assertEqual(found["data/truth"].shape, (201 * 120, 1))

    def test_drive_regressions_are_those_of_its_readme(self):
        found = self.drive("--window.model=linear", state="gyro_z, icp_yawrate_fit", truth="icp_jump, steady")
        jump, steady = found["data/truth"].T
        difference = np.diff(found["data/input"])[:, 0]
        for i, kept, coefficients, r_squared in ((0, jump == 0, (-0.002, 0.1129), 0.883),
                                                 (0, (jump == 0) & (steady == 1), (None, 0.1151), 0.905),
                                                 (1, jump == 0, (-0.003, 0.1139), 0.809)):
            y, columns = found["data/state"][kept, i], np.column_stack([np.ones(kept.sum()), difference[kept]])
            fit, square_sum = np.linalg.lstsq(columns, y, rcond=None)[:2]
            if coefficients[0] is not None:
                self.close(fit[0], coefficients[0], 5e-4)
            self.close(fit[1], coefficients[1], 5e-5)
            self.close(1 - square_sum / len(y) / y.var(), r_squared, 5e-4)

    def test_drive_of_three_states_is_numpys(self):
        found = self.drive("--window.model=linear", state="gyro_z, icp_vx_fit, icp_vy_fit")
        self.assertEqual(sum(found["data/runs"]["samples"] - 1), 23919)
        self.close(found["windows/global/parameters"],
                   [-0.026277697553, 0.002042120298, 0.005740391973, -0.00268997731, 0.002260471196, 0.006410018526,
                    -0.081912255374, -0.03210514036, 0.005841805723, 0.004772058784, 0.01369619869, 0.001030493033,
                    -0.059057259589, 0.000977240402, -0.000911917783], 1e-11)

    def test_slip_model_finds_the_effective_track(self):
        """The wheel columns are 0.3 s late. With the nominal wheel radius, the effective track is 1.43 to 1.46 m."""
        found = self.drive("--window.model=slip", state="gyro_z", input="left, right", lag_s=-0.3,
                           derive="left = 0.165 * wheel_left\nderive = right = 0.165 * wheel_right")
        self.close(found["windows/global/parameters"][0], 1.44, 0.05 * 1.44)
        self.assertLess(np.sqrt(found["windows/global/covariance"][0, 0]), 0.03)


if __name__ == "__main__":
    program.main()
