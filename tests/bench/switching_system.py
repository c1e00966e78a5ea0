"""Systems that switch between linear modes (simulated by numpy), and runs of the program; what models of known systems are
compared with: filters with the true parameters, step responses, and fits by scipy."""
import argparse
import math
import pathlib
import subprocess

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import lfilter

DT_S = 0.1
SD = 0.02


def options_of(doc, *paths, **defaults):
    """Paths and options of the command line; an option has the type of its default."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in paths:
        parser.add_argument(name, type=pathlib.Path)
    for name, default in defaults.items():
        parser.add_argument("--" + name, type=type(default), default=default)
    return parser.parse_args()


def inputs(g, run, samples, count=2):
    """Inputs: drawn at each sample in odd runs, held for 3 to 24 samples in even ones."""
    u = np.zeros((samples, count))
    k = 0
    while k < samples:
        held = 1 if run % 2 else int(g.integers(3, 25))
        u[k:k + held] = g.uniform(-0.5, 0.5, count)
        k += held
    return u


def sticky(g, count, stay_samples, samples):
    """Modes with exponentially distributed stays; the next mode is any other with equal probability."""
    z = np.zeros(samples, int)
    k, mode = 0, int(g.integers(count))
    while k < samples:
        stay = max(1, int(g.exponential(stay_samples)))
        z[k:k + stay] = mode
        mode = int(g.choice([m for m in range(count) if m != mode])) if count > 1 else 0
        k += stay
    return z


def switched(motions, mode, u, w):
    """States x[k+1] = A (x[k], x[k-1], ...) + B u[k] + w[k] from zero on, with the (A, B) of each sample's mode."""
    n = len(motions[0][1])
    x, past = np.zeros((len(u), n)), np.zeros((motions[0][0].shape[1] // n, n))
    for k, m in enumerate(mode[:-1]):
        past = np.vstack([x[k], past[:-1]])
        x[k + 1] = motions[m][0] @ past.ravel() + motions[m][1] @ u[k] + w[k]
    return x


def signal(g, shape, low, high, count):
    """Noise through two poles, held levels, two levels or numbers, which stay for low to high samples."""
    if shape == "smooth":
        noise = lfilter([1], np.poly(np.exp(-1 / g.uniform(low, high, 2))), g.standard_normal(count + int(9 * high)))
        return noise[-count:] / noise.std()
    steps = np.repeat(np.arange(count), np.maximum(1, np.round(g.uniform(low, high, count)).astype(int)))[:count]
    if shape == "held":
        return g.uniform(-1.7, 1.7, count)[steps]
    return 2. * (steps % 2) - 1 if shape == "PRBS" else g.integers(1, max(2, shape), count).cumsum()[steps] % shape


def filtered(F, V, C, R, x, P, pushed, y, chain=None):
    """Innovations (sample, run, motion, reading), their covariances, and nats (sample, run, motion) of Kalman filters.

    F and V of each motion, readings y = C x + v with variances R (motion, reading); x (run or 1, motion, state)
    and P (motion, ...) before the first reading; pushed (run, sample, motion, state) by inputs, after each reading. With a chain nats are those of
    the interacting multiple model filter (Blom & Bar-Shalom 1988), (sample, run)."""
    P = P * np.ones((1 if chain is None else len(y), 1, 1, 1))
    eye, chance, last, out = np.eye(len(C)), np.full((1, len(F)), 1 / len(F)), 0 * P, []
    for k in range(y.shape[1]):
        if chain is not None or abs(P - last).max() > 1e-12 * abs(P).max():  # else the filters are steady
            S, last = C @ P @ C.T + R[:, :, None] * eye, P
            M, L = np.linalg.inv(S), np.linalg.solve(S, C @ P).swapaxes(2, 3)
            size, after = np.linalg.slogdet(2 * np.pi * S)[1], P - L @ S @ L.swapaxes(2, 3)
            P = F @ after @ F.swapaxes(1, 2) + V
        e = y[:, None, k] - x @ C.T
        nats, x = -.5 * ((e * (M @ e[..., None])[..., 0]).sum(2) + size), x + (L @ e[..., None])[..., 0]
        if chain is not None:
            joint = (np.log(chance) + nats)[:, :, None] + np.log(chain)
            ahead = np.logaddexp.reduce(joint, 1)
            mixed, old, nats = np.exp(joint - ahead[:, None]), x, np.logaddexp.reduce(ahead, 1)
            x, chance = np.einsum("rij,ris->rjs", mixed, old), np.exp(ahead - nats[:, None])
            off = old[:, :, None] - x[:, None]
            after = np.einsum("rij,rijst->rjst", mixed, after[:, :, None] + off[..., None] * off[..., None, :])
            P = F @ after @ F.swapaxes(1, 2) + V
        out.append((e, S, nats))
        x = (F @ x[..., None])[..., 0] + pushed[:, k]
    return [np.array(part) for part in zip(*out)]


def response(F, G, C, d):
    """Steady gains, and 63 % times interpolated inside a sample, of each model, reading and input.

    x[k+1] = F x[k] + G[0] u[k-d] + G[1] u[k-d-1], y = C x."""
    x, slowest = 0 * G[:, 0], abs(np.linalg.eigvals(F)).max()
    share = [0 * (gain := C @ np.linalg.solve(np.eye(F.shape[1]) - F, G.sum(1)))]
    for k in range(int(12 / -np.log(slowest)) + 10):
        x = F @ x + G[:, 0] + G[:, 1] * (k > 0)
        share.append(C @ x / gain)
    after = np.argmax(np.array(share) >= .632, axis=0)[None]
    low, high = (np.take_along_axis(np.array(share), after + j, 0)[0] for j in (-1, 0))
    return gain, after[0] - 1 + (.632 - low) / (high - low) + d


def half_deviance(y, u, order, delays):
    """Half the deviance [nats] of ARMAX models of one reading (run, sample) by prediction errors; order: a row of the
    archive's scores."""
    if order["differences"]:
        y, u = np.diff(y, axis=1), np.diff(u, axis=1)
    noise, late = order["noise_lags"], lambda x, lag: x[:, 40 - lag:x.shape[1] - lag]
    X = [np.ones_like(late(y, 0))] + [late(y, 1 + j) for j in range(order["state_lags"])]
    X = np.stack(X + [late(u[..., i], d + j) for i, d in enumerate(delays) for j in range(order["input_lags"])], 2)

    def errors(theta):
        return lfilter([1], np.r_[1, theta[:noise]], late(y, 0) - X @ theta[noise:], axis=1).ravel()

    start = np.linalg.lstsq(X.reshape(-1, X.shape[2]), late(y, 0).ravel(), rcond=None)[0]
    return late(y, 0).size / 2 * np.log(least_squares(errors, np.r_[np.zeros(noise), start], x_scale="jac").cost)


class Switching:
    """x[k+1] = x[k] + A x[k] + B u[k] + w, w of the deviation sd of the mode, y = x + v of variance R; mean stays of dwell samples."""

    def __init__(self, A, B, sd, R, dwell):
        self.A, self.B, self.sd, self.R, self.dwell = A, B, np.array(sd), R, dwell
        self.K, self.n = len(A), A[0].shape[0]

    @staticmethod
    def drawn(g):
        """A random system with 2 to 4 modes, one or two states, stays of 50 to 400 samples, with and without measurement noise."""
        K, n, dwell = int(g.integers(2, 5)), int(g.integers(1, 3)), float(g.uniform(50, 400))
        A = [np.diag(g.uniform(-0.6, -0.1, n)) + (0.08 * g.standard_normal((n, n)) * (1 - np.eye(n))) for _ in range(K)]
        B = [0.2 * g.standard_normal((n, 2)) for _ in range(K)]
        sd = SD * np.exp(0.3 * g.standard_normal(K))
        return Switching(A, B, sd, SD ** 2 / 4 if g.integers(2) else 0.0, dwell)

    def simulate(self, g, run, samples):
        u, z = inputs(g, run, samples), sticky(g, self.K, self.dwell, samples)
        noise = self.sd[z[:-1], None] * g.standard_normal((samples - 1, self.n))
        x = switched([(np.eye(self.n) + A, B) for A, B in zip(self.A, self.B)], z, u, noise)
        return u, x + math.sqrt(self.R) * g.standard_normal(x.shape)

    def log_density(self, u, y):
        """Log density of every sample after the first, given the previous ones, by the IMM filter with the true parameters (exact for R = 0)."""
        T = np.full((self.K, self.K), 1 / self.dwell / max(1, self.K - 1))
        np.fill_diagonal(T, 1 - 1 / self.dwell)
        F, eye = np.eye(self.n) + np.array(self.A), np.eye(self.n)
        R = np.full((self.K, self.n), max(self.R, 1e-12))
        V, pushed = self.sd[:, None, None] ** 2 * eye, np.einsum("kni,si->skn", self.B, u)[None]
        x, P = (F @ y[0] + pushed[0, 0])[None], R[0, 0] * F @ F.swapaxes(1, 2) + V
        return np.r_[np.nan, filtered(F, V, eye, R, x, P, pushed[:, 1:], y[None, 1:], T)[2][:, 0]]


def write_tables(folder, ini, tables, form, states, inputs, *settings, more=()):
    """run_*.csv of these channels after the time, and a configuration with nothing but [data]."""
    folder.mkdir(parents=True, exist_ok=True)
    for run, table in enumerate(tables):
        header = ",".join(["time", *states, *inputs, *more])
        np.savetxt(folder / f"run_{run:02d}.csv", table, form, ",", header=header, comments="")
    channels = "state = " + ", ".join(states), "input = " + ", ".join(inputs)
    (folder / ini).write_text("\n".join(["[data]", "inputs = run_*.csv", "time = time", *channels, *settings, ""]))


def write_runs(folder, runs, *settings):
    """The same for runs of (inputs, states)."""
    u, x = runs[0]
    tables = [np.c_[DT_S * np.arange(len(x)), x, u] for u, x in runs]
    names = ([f"{letter}{i}" for i in range(v.shape[1])] for letter, v in (("y", x), ("u", u)))
    write_tables(folder, "system.ini", tables, "%.9g", *names, *settings)


def run_program(program, runs, folder, extra=()):
    """`modebank run` with nothing but [data] configured, on runs of (inputs, states); archive: out.h5."""
    write_runs(folder, runs)
    return subprocess.run([program, "run", folder / "system.ini", "--archive.output", folder / "out.h5", "--job.threads", "1", *extra],
                          capture_output=True, text=True)
