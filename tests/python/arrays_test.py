"""Windows, filters, free runs and mixtures on numpy arrays, compared with closed forms in numpy."""
import itertools
import os
import signal
import subprocess
import sys
import threading
import time
import unittest

import numpy as np

import modebank

A, B = np.array([[-0.2, 0.05], [0.0, -0.1]]), np.array([[0.3, 0.0], [0.1, 0.2]])


def linear_run(samples, noise, seed=1):
    """x[k+1] = x[k] + A x[k] + B u[k] + w: states (N, 2), inputs (N, 2)."""
    generator = np.random.default_rng(seed)
    inputs = generator.normal(size=(samples, 2))
    states = np.zeros((samples, 2))
    errors = noise * generator.normal(size=(samples, 2))
    for k in range(samples - 1):
        states[k + 1] = states[k] + A @ states[k] + B @ inputs[k] + errors[k]
    return states, inputs


class Windows(unittest.TestCase):
    def test_a_noiseless_system_is_found_in_every_window(self):
        states, inputs = linear_run(200, 0.0)
        windows = modebank.identify(states, inputs, 0.1, length=20, step=10, prior="none")
        theta = np.hstack([A, B]).ravel()
        np.testing.assert_allclose(windows.parameters, np.tile(theta, (len(windows), 1)), atol=1e-9)
        np.testing.assert_array_equal(windows.start, np.arange(0, 180, 10))
        self.assertEqual(windows.parameters.shape, (18, 8))
        self.assertEqual(windows.covariance.shape, (18, 8, 8))
        self.assertEqual(windows.noise_variance.shape, (18, 2))
        self.assertEqual(len(windows.names), 8)
        self.assertEqual(set(windows.status), {"converged"})

    def test_windows_are_least_squares_with_its_covariance(self):
        states, inputs = linear_run(400, 0.1)
        windows = modebank.identify(states, inputs, 0.1, length=50, step=50, prior="none", loss="trivial")
        for theta, covariance, start in zip(windows.parameters, windows.covariance, windows.start):
            regressors = np.hstack([states, inputs])[start:start + 50]
            increments = np.diff(states[start:start + 51], axis=0)
            expected = np.linalg.lstsq(regressors, increments, rcond=None)[0].T
            np.testing.assert_allclose(theta.reshape(2, 4), expected, rtol=1e-8, atol=1e-10)
            np.testing.assert_allclose(covariance, covariance.T, rtol=1e-12, atol=1e-15)
            shape = np.linalg.inv(regressors.T @ regressors)
            block = covariance[:4, :4]
            np.testing.assert_allclose(block / block[0, 0], shape / shape[0, 0], rtol=1e-6, atol=1e-9)

    def test_layouts_lists_and_copies_are_alike(self):
        states, inputs = linear_run(300, 0.1)
        expected = modebank.identify(states, inputs, 0.1, length=30)
        for other in (np.asfortranarray(states), states.tolist() and np.array(states.tolist()), states[:, ::-1][:, ::-1]):
            np.testing.assert_array_equal(modebank.identify(other, inputs, 0.1, length=30).parameters,
                                          expected.parameters)
        two = modebank.identify([states, states], [inputs, inputs], 0.1, length=30, prior="none")
        self.assertEqual(len(two), 2 * len(expected))
        np.testing.assert_array_equal(np.unique(two.run), [0, 1])

    def test_names_and_one_state(self):
        states, inputs = linear_run(100, 0.1)
        windows = modebank.identify(states[:, 0], inputs, 0.1, state_names=["wz"], input_names=["l", "r"])
        self.assertEqual(windows.labels, ["wz <- wz", "wz <- l", "wz <- r"])
        self.assertEqual(modebank.identify(states, length=30).parameters.shape[1], 4)

    def test_views_keep_their_windows_and_cannot_be_written(self):
        states, inputs = linear_run(100, 0.1)
        theta = modebank.identify(states, inputs, 0.1).parameters
        self.assertTrue(np.isfinite(theta).all())
        with self.assertRaises(ValueError):
            theta[0, 0] = 1.0

    def test_other_models(self):
        states, inputs = linear_run(200, 0.0)
        lagged = modebank.identify(states, inputs, 0.1, model="varx", state_lags=2, length=40, step=40)
        self.assertEqual(lagged.parameters.shape[1], 12)

    def test_mistakes(self):
        states, inputs = linear_run(100, 0.1)
        with self.assertRaisesRegex(modebank.ConfigurationError, "window.length"):
            modebank.identify(states, inputs, 0.1, length=0)
        with self.assertRaisesRegex(ValueError, "100 samples of states, but 99 of inputs"):
            modebank.identify(states, inputs[1:], 0.1)
        with self.assertRaisesRegex(ValueError, "dt"):
            modebank.identify(states, inputs, 0.0)
        with self.assertRaises(modebank.DataError):
            modebank.identify(states[:10], inputs[:10], 0.1, length=30)

    def test_a_million_rows_are_read_where_they_are(self):
        # In a separate process, to measure its own peak. The first call allocates what every call needs.
        script = """
import numpy as np, resource, modebank
generator = np.random.default_rng(1)
warm = generator.normal(size=(20000, 1))
modebank.identify(warm, generator.normal(size=(20000, 11)), 0.1, length=1000, step=1000)
states, inputs = generator.normal(size=(1_000_000, 1)), generator.normal(size=(1_000_000, 11))
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
windows = modebank.identify(states, inputs, 0.1, length=1000, step=1000)
after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
assert len(windows) == 999, len(windows)
print((after - before) * 1024 / (states.nbytes + inputs.nbytes))
"""
        share = float(subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True,
                                     env=os.environ).stdout)
        self.assertLess(share, 0.5, "peak memory grew by this share of the arrays")


class CtrlC(unittest.TestCase):
    """Jobs of minutes that a signal ends. Another thread sends it, so other threads go on meanwhile."""

    def setUp(self):
        signal.signal(signal.SIGINT, signal.default_int_handler)  # background processes of a shell ignore it

    def interrupted(self, job):
        begin_s, ended = time.process_time(), threading.Event()

        def interrupt():  # once the job is at work, and this thread had its turns beside it
            for turn in itertools.count():
                if ended.is_set():
                    return
                if turn > 20 and time.process_time() - begin_s > 0.2:
                    os.kill(os.getpid(), signal.SIGINT)
                    return
                time.sleep(1e-3)

        other = threading.Thread(target=interrupt)
        with self.assertRaises(KeyboardInterrupt):
            other.start()
            try:
                job()
            finally:
                ended.set()
        other.join()

    def test_ends_identify(self):
        run = linear_run(19_000, 0.1)
        for samples in (19_000, 1_000_000):  # up to 20,000 windows Ceres solves them
            with self.subTest(samples=samples):
                states, inputs = (np.resize(signals, (samples, 2)) for signals in run)
                self.interrupted(lambda: modebank.identify(states, inputs, 0.1, length=200, step=1))

    def test_ends_fit_mixture(self):
        points = np.random.default_rng(1).normal(size=(50_000, 4))
        self.interrupted(lambda: modebank.fit_mixture(points, components=[40], restarts=1000))

    def test_ends_simulate(self):
        states, inputs = linear_run(3, 0.1)
        modes = 8
        bank = modebank.Bank(np.tile(A, (modes, 1, 1)), np.tile(B, (modes, 1, 1)), np.tile(0.01 * np.eye(2), (modes, 1, 1)),
                             np.full((modes, modes), 1 / modes), dt=0.1)
        states, inputs = np.resize(states, (2_000_000, 2)), np.resize(inputs, (2_000_000, 2))
        self.interrupted(lambda: modebank.simulate(bank, states, inputs))


class Filters(unittest.TestCase):
    def bank(self, **keys):
        return modebank.Bank(A[None], B[None], 0.01 * np.eye(2)[None], np.eye(1), R=0.04 * np.eye(2), C=np.eye(2),
                             dt=0.1, **keys)

    def test_one_mode_is_the_kalman_filter(self):
        states, inputs = linear_run(60, 0.1)
        measured = states + 0.2 * np.random.default_rng(2).normal(size=states.shape)
        step = modebank.Filter(self.bank()).step
        F = np.eye(2) + A
        for k in range(60):
            estimate = step(0.1 * k, inputs[k], measured[k])
            if k == 0:
                x, P = estimate.state.copy(), estimate.covariance.copy()
                continue
            x, P = F @ x + B @ inputs[k - 1], F @ P @ F.T + 0.01 * np.eye(2)
            np.testing.assert_allclose(estimate.prediction, x, atol=1e-12)
            S = P + 0.04 * np.eye(2)
            np.testing.assert_allclose(estimate.innovation_covariance, S, atol=1e-12)
            nu = measured[k] - x
            self.assertAlmostEqual(estimate.nis, nu @ np.linalg.solve(S, nu), 9)
            density = -0.5 * (nu @ np.linalg.solve(S, nu) + np.log(np.linalg.det(2 * np.pi * S)))
            self.assertAlmostEqual(estimate.log_density, density, 9)
            gain = P @ np.linalg.inv(S)
            x, P = x + gain @ nu, P - gain @ P
            np.testing.assert_allclose(estimate.state, x, atol=1e-12)
            np.testing.assert_allclose(estimate.covariance, P, atol=1e-12)

    def test_ways_to_give_a_sample_are_alike(self):
        ways = [lambda v: v, list, tuple, np.float32, lambda v: np.asfortranarray(v[None])[0]]
        expected = None
        for way in ways:
            step = modebank.Filter(self.bank()).step
            step(0.0, way(np.array([0.5, 0.25])), way(np.array([1.0, 2.0])))
            said = step(0.1, way(np.array([0.5, 0.25])), way(np.array([1.5, 1.0]))).state
            expected = said if expected is None else expected
            np.testing.assert_array_equal(said, expected)

    def test_a_missing_measurement_is_a_prediction(self):
        f = modebank.Filter(self.bank())
        self.assertFalse(f.started)
        f.step(0.0, [0.0, 0.0], [1.0, 1.0])
        self.assertTrue(f.started)
        missing = f.step(0.1, [0.0, 0.0], None)
        self.assertTrue(np.isnan(missing.innovation).all())
        np.testing.assert_allclose(missing.state, missing.prediction)
        half = f.step(0.2, [0.0, 0.0], [float("nan"), 1.0])
        self.assertTrue(np.isnan(half.innovation[0]) and np.isfinite(half.innovation[1]))
        f.restart()
        self.assertFalse(f.started)

    def test_a_forecast_is_the_closed_form(self):
        states, inputs = linear_run(40, 0.1)
        f = modebank.Filter(self.bank())
        for k in range(20):
            now = f.step(0.1 * k, inputs[k], states[k])
        ahead = f.forecast(inputs[20:24], 5)  # the input before the fifth step acts in it
        x, P, F = now.state, now.covariance, np.eye(2) + A
        for i in range(5):
            x, P = F @ x + B @ inputs[19 + i], F @ P @ F.T + 0.01 * np.eye(2)
            np.testing.assert_allclose(ahead.state[i], x, atol=1e-12)
            np.testing.assert_allclose(ahead.covariance[i], P, atol=1e-12)
        np.testing.assert_array_equal(ahead.mode_probability, np.ones((5, 1)))
        np.testing.assert_array_equal(f.forecast(None, 1).state[0], ahead.state[0])
        np.testing.assert_allclose(f.step(2.0, inputs[20], states[20]).prediction, ahead.state[0], atol=1e-12)
        with self.assertRaisesRegex(ValueError, "inputs: a forecast of 5 steps"):
            f.forecast(inputs[20:22], 5)
        with self.assertRaisesRegex(ValueError, "steps"):
            f.forecast(inputs[20:22], 0)
        with self.assertRaisesRegex(ValueError, r"u must be \(samples, 2\)"):
            f.forecast(np.zeros((5, 3)), 5)

    def test_a_snapshot_goes_on_to_the_bit(self):
        states, inputs = linear_run(40, 0.1)
        first, second = modebank.Filter(self.bank()), modebank.Filter(self.bank())
        for k in range(20):
            first.step(0.1 * k, inputs[k], states[k])
        second.restore(np.frombuffer(first.snapshot().tobytes()))  # through bytes, as from a file
        self.assertTrue(second.started)
        for k in range(20, 40):
            said, expected = (f.step(0.1 * k, inputs[k], states[k]) for f in (first, second))
            np.testing.assert_array_equal(said.state, expected.state)
            self.assertEqual(said.log_density, expected.log_density)
        with self.assertRaisesRegex(ValueError, "snapshot"):
            first.restore(np.zeros(3))

    def test_later_steps_leave_an_estimate_alone(self):
        f = modebank.Filter(self.bank())
        first = f.step(0.0, [0.0, 0.0], [1.0, 2.0])
        view, before = first.state, first.state.copy()
        f.step(0.1, [0.0, 0.0], [5.0, 5.0])
        np.testing.assert_array_equal(view, before)

    def test_mistakes(self):
        f = modebank.Filter(self.bank())
        with self.assertRaisesRegex(ValueError, "y has 3 numbers, the bank 2"):
            f.step(0.0, [0.0, 0.0], [1.0, 2.0, 3.0])
        with self.assertRaises(TypeError):
            f.step(0.0, [0.0, "fast"], [1.0, 2.0])
        with self.assertRaisesRegex(ValueError, "noise"):
            modebank.Filter(self.bank(), noise="loud")
        with self.assertRaisesRegex(ValueError, "Q must have three dimensions"):
            modebank.Bank(A[None], B[None], np.eye(2), np.eye(1))


class FreeRuns(unittest.TestCase):
    def test_a_noiseless_run_is_followed(self):
        states, inputs = linear_run(50, 0.0)
        bank = modebank.Bank(A[None], B[None], 1e-8 * np.eye(2)[None], np.eye(1), dt=0.1)
        given = states.copy()
        given[1:] = np.nan
        free = modebank.simulate(bank, given, inputs)
        np.testing.assert_allclose(free.mean[1:], states[1:], atol=1e-9)
        self.assertTrue(np.isnan(free.mean[0]).all())
        self.assertTrue((free.lower[1:] < free.upper[1:]).all())
        short = modebank.simulate(bank, states, inputs, samples=3)
        np.testing.assert_array_equal(np.flatnonzero(short.mode >= 0), np.arange(3, 50))


class Mixtures(unittest.TestCase):
    def test_two_clouds_are_found(self):
        generator = np.random.default_rng(1)
        points = np.vstack([generator.normal([0, 0], 1, (600, 2)), generator.normal([8, 3], 0.5, (300, 2))])
        mixture = modebank.fit_mixture(points, components=range(1, 5))
        np.testing.assert_allclose(mixture.weights, [2 / 3, 1 / 3], atol=1e-3)
        np.testing.assert_allclose(mixture.means[0], points[:600].mean(0), atol=1e-3)
        np.testing.assert_allclose(mixture.covariances[1], np.cov(points[600:].T, bias=True), rtol=1e-2, atol=1e-3)
        table = mixture.candidates
        self.assertEqual(table.loc[table.selected, "components"].item(), 2)
        self.assertEqual(table["components"].tolist(), [1, 2, 3, 4])
        self.check_density(mixture, points)

    def check_density(self, mixture, points):
        terms = []
        for weight, mean, covariance in zip(mixture.weights, mixture.means, mixture.covariances):
            d = points - mean
            square = np.einsum("ni,ij,nj->n", d, np.linalg.inv(covariance), d)
            terms.append(np.log(weight) - 0.5 * (square + np.log(np.linalg.det(2 * np.pi * covariance))))
        joint = np.array(terms).T
        density = np.logaddexp.reduce(joint, axis=1)
        np.testing.assert_allclose(mixture.log_density(points), density, rtol=1e-9)
        np.testing.assert_allclose(mixture.responsibilities(points), np.exp(joint - density[:, None]), atol=1e-9)
        selected = mixture.candidates[mixture.candidates.selected]
        self.assertAlmostEqual(selected["log_likelihood"].item(), density.sum(), 4)

    def test_mistakes(self):
        with self.assertRaisesRegex(modebank.ConfigurationError, "mixture.covariance"):
            modebank.fit_mixture(np.zeros((10, 2)), covariance="best")


if __name__ == "__main__":
    unittest.main()
