"""docs/howto/recipes.md: its lines run unchanged on archives, and stop where the filter was rejected."""
import json
import re
import shutil
import subprocess
import sys

from program import ProgramTest, SOURCE, arrays, demo, h5py, learn, main, modebank, np, slices

PAGE = (SOURCE / "docs/howto/recipes.md").read_text(encoding="utf-8")
# The parts of CasADi in the recipe, on numbers: a stand-in where the module is absent.
CASADI = """import numpy as np
class MX:
    sym = staticmethod(lambda name, size: np.ones(size) / size)
DM = np.array
Function = lambda name, given, made, *names: lambda *values: made
"""
SEPARATION_M = 0.555
PYTHON = [sys.executable, "-c"]
RUNS = {"ROS 2": PYTHON, "CasADi": PYTHON}
if shutil.which("octave-cli"):
    RUNS["MATLAB"] = ["octave-cli", "--no-init-file", "--eval"]
MEASURED = ("--bank.measurement_variance", 1e-4, "--bank.refine", "none")


def recipe(heading):
    return re.search(rf"^## {heading}.*?^```\w+\n(.*?)^```", PAGE, re.M | re.S)[1]


class Recipes(ProgramTest):
    def setUp(self):
        super().setUp()
        modebank("export", demo() / "demo.h5", "--to", "json", "-o", self.folder / "bank.json")
        (self.folder / "run.json").write_text((demo().parent / "demo.json").read_text())
        self.bank = json.loads((self.folder / "bank.json").read_text())

    def run_recipe(self, heading, after="", **changes):
        (self.folder / "bank.json").write_text(json.dumps(dict(self.bank, **changes)))
        words = [*RUNS[heading], recipe(heading) + after]
        return subprocess.run(words, cwd=self.folder, capture_output=True, text=True)

    def numbers(self, name):
        """Numbers of the file by key."""
        text = (self.folder / f"{name}.yaml").read_text()
        return {key: np.array(re.findall(r"[-\d.]+", value), float)
                for key, value in re.findall(r"^    (\w+): (\[.*?\]|\S+)$", text, re.M | re.S)}

    def test_ros_parameters_are_those_of_the_simulated_robot(self):
        done = self.run_recipe("ROS 2")
        self.assertEqual(done.returncode, 0, done.stderr)
        for ground, gain in (("grip", 0.95), ("ice", 0.5)):  # of configs/systems/two_grounds.ini, noise 0.005 a step
            said = self.numbers(ground)
            np.testing.assert_allclose(said["wheel_separation_multiplier"] * SEPARATION_M, 1 / gain, rtol=0.02)
            np.testing.assert_allclose(said["left_wheel_radius_multiplier"], 1, rtol=0.02)
            noise = said["process_noise_covariance"].reshape(15, 15)
            np.testing.assert_allclose(noise[11, 11], 0.005**2 / 0.1, rtol=0.15)
            self.assertEqual((noise[6, 6], noise[14, 14], noise[11, 6]), (0.025, 0.015, 0))

    def test_noise_of_more_than_one_lag_is_not_written(self):
        done = self.run_recipe("ROS 2", lags=dict(self.bank["lags"], state_lags=2))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("process_noise_covariance", self.numbers("grip"))
        self.assertIn("wheel_separation_multiplier", self.numbers("grip"))

    def test_rejected_filters_stop_every_recipe(self):
        (self.folder / "casadi.py").write_text(CASADI)
        for heading in RUNS:
            for change in (dict(verdict=dict(self.bank["verdict"], answer="overconfident")),
                           dict(source=dict(self.bank["source"], filter="baseline"))):
                self.assertEqual(self.run_recipe(heading, **change).returncode, 1, (heading, change))
        self.assertEqual(list(self.folder.glob("*.yaml")), [])

    def test_casadi_steps_as_the_equations(self):
        if subprocess.run([sys.executable, "-c", "import casadi"], capture_output=True).returncode != 0:
            print("Python has no module casadi: a stand-in evaluates the recipe")
            (self.folder / "casadi.py").write_text(CASADI)
        done = self.run_recipe("CasADi", "\nx, u, mu = ca.DM([0.3]), ca.DM([0.1, 0.4]), ca.DM([0.25, 0.75])"
                               "\nprint(float(step(x, u, mu)[0]))")
        self.assertEqual(done.returncode, 0, done.stderr)
        T, expected = np.array(self.bank["transition"]["T"]), 0
        for j, mode in enumerate(self.bank["modes"]):
            A, B, c = (np.array(mode[key]["value"]).ravel() for key in "ABc")
            expected += (0.25 * T[0, j] + 0.75 * T[1, j]) * (A[0] * 0.3 + B @ [0.1, 0.4] + c[0])
        self.assertAlmostEqual(float(done.stdout.split()[-1]), expected, 12)

    def test_matlab_predicts_as_the_equations(self):
        if "MATLAB" not in RUNS:
            print("Octave is absent: the recipe for MATLAB does not run")
            return
        modes = [dict(mode, c={"value": [[0.1 * k]]}) for k, mode in enumerate(self.bank["modes"], 1)]
        done = self.run_recipe("MATLAB", "\nprintf('%.15g ', B, y(end))", modes=modes)
        self.assertEqual(done.returncode, 0, done.stderr)
        x, mu, T = 0, *(np.array(self.bank["transition"][key]) for key in ("initial_probability", "T"))
        for _ in range(50):
            mu = mu @ T
            x = sum(mu[k] * (mode["A"]["value"][0][0] * x + mode["c"]["value"][0][0]) for k, mode in enumerate(modes))
        expected = [*np.ravel([mode["B"]["value"] for mode in modes]), x]
        np.testing.assert_allclose(np.array(done.stdout.split(), float), expected, rtol=1e-10)


def of_one_mode(folder):
    """An archive of one mode with two lags, of runs with missing samples."""
    lags = ("--window.model", "varx", "--window.state_lags", 2, "--window.input_lags", 2, "--window.input_delay", 1)
    words = (*MEASURED, *lags, "--mixture.components", 1, "--data.missing", "predict")
    return learn(folder, *words, samples=60, holes=True)


class Smoothed(ProgramTest):
    def smoothed(self, archive):
        words = [sys.executable, "-c", recipe("Smoothed states"), archive]
        subprocess.run(words, cwd=self.folder, check=True)
        with np.load(self.folder / "smoothed.npz") as made:
            return made["state"], made["covariance"]

    def test_states_of_one_mode_are_those_of_the_smoother_at_6a013144(self):
        archive = of_one_mode(self.folder)
        lines = [line.split(",") for line in (SOURCE / "tests/golden/data/smoothed.csv").read_text().splitlines()]
        golden = {line[0]: np.array(line[1:], float) for line in lines}
        with h5py.File(archive, "r+") as file:  # the bank that was smoothed; this program may learn another one
            for name in "ABcQR":
                file["bank"][name][...] = golden[f"bank/{name}"].reshape(file["bank"][name].shape)
        state, covariance = self.smoothed(archive)
        np.testing.assert_allclose(state.ravel(), golden["evaluation/bank/smoothed_state"], rtol=0, atol=1e-9)
        np.testing.assert_allclose(covariance.ravel(), golden["evaluation/bank/smoothed_covariance"], rtol=0, atol=1e-9)

    def test_states_of_two_modes_are_the_least_squares_of_all_samples(self):
        archive = learn(self.folder, *MEASURED, "--mixture.components", 2)
        state, covariance = self.smoothed(archive)
        bank, data, said = (arrays(archive, path) for path in ("/bank", "/data", "/evaluation/bank"))
        for rows in slices(archive).values():
            mode, y, u = said["viterbi_mode"][rows], data["state"][rows], data["input"][rows]
            self.assertEqual(set(mode), {0, 1})
            N, Q, I = len(y), bank["Q"][mode, 0, 0], np.eye(len(y))
            J = np.concatenate([I, I[1:] - (1 + bank["A"][mode[1:], 0, 0])[:, None] * I[:-1]])
            right = np.concatenate([y[:, 0], np.sum(bank["B"][mode[1:], 0] * u[:-1], 1) + bank["c"][mode[1:], 0]])
            weight = 1 / np.concatenate([np.full(N, bank["R"][0, 0]), Q[1:]])
            P = np.linalg.inv(J.T @ (weight[:, None] * J))
            np.testing.assert_allclose(state[rows, 0], P @ J.T @ (weight * right), rtol=0, atol=1e-9)
            np.testing.assert_allclose(covariance[rows, 0, 0], np.diag(P), rtol=0, atol=1e-9)


if __name__ == "__main__":
    main()
