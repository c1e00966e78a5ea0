"""Systems that switch between linear modes (simulated by numpy), the filter with the true parameters, and runs of the program."""
import math
import subprocess

import numpy as np

DT_S = 0.1
SD = 0.02


def inputs(g, run, samples):
    """Inputs: drawn at each sample in odd runs, held for 3 to 24 samples in even ones."""
    u = np.zeros((samples, 2))
    k = 0
    while k < samples:
        held = 1 if run % 2 else int(g.integers(3, 25))
        u[k:k + held] = g.uniform(-0.5, 0.5, 2)
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


class Switching:
    """x[k+1] = x[k] + A x[k] + B u[k] + w, w of the deviation sd of the mode, y = x + v of variance R; mean stays of dwell samples."""

    def __init__(self, A, B, sd, R, dwell):
        self.A, self.B, self.sd, self.R, self.dwell = A, B, sd, R, dwell
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
        u, z, x = inputs(g, run, samples), sticky(g, self.K, self.dwell, samples), np.zeros((samples, self.n))
        for k in range(samples - 1):
            m = z[k]
            x[k + 1] = x[k] + self.A[m] @ x[k] + self.B[m] @ u[k] + self.sd[m] * g.standard_normal(self.n)
        return u, x + math.sqrt(self.R) * g.standard_normal(x.shape)

    def log_density(self, u, y):
        """Log density of every sample after the first, given the previous ones, by the IMM filter with the true parameters (exact for R = 0)."""
        K, n = self.K, self.n
        T = np.full((K, K), 1 / self.dwell / max(1, K - 1))
        np.fill_diagonal(T, 1 - 1 / self.dwell)
        R = max(self.R, 1e-12) * np.eye(n)
        mu, means, covs = np.full(K, 1 / K), [y[0].copy() for _ in range(K)], [R.copy() for _ in range(K)]
        out = np.full(len(y), np.nan)
        for k in range(1, len(y)):
            c = T.T @ mu
            mixed = T * mu[:, None] / c
            start = [sum(mixed[i, j] * means[i] for i in range(K)) for j in range(K)]
            spread = [sum(mixed[i, j] * (covs[i] + np.outer(means[i] - start[j], means[i] - start[j])) for i in range(K)) for j in range(K)]
            logs = np.zeros(K)
            for j in range(K):
                F = np.eye(n) + self.A[j]
                x, P = F @ start[j] + self.B[j] @ u[k - 1], F @ spread[j] @ F.T + self.sd[j] ** 2 * np.eye(n)
                S, e = P + R, y[k] - x
                gain = np.linalg.solve(S, P).T
                logs[j] = -0.5 * (e @ np.linalg.solve(S, e) + np.linalg.slogdet(2 * np.pi * S)[1])
                means[j], covs[j] = x + gain @ e, P - gain @ P
            top = logs.max()
            weights = c * np.exp(logs - top)
            out[k] = top + math.log(weights.sum())
            mu = weights / weights.sum()
        return out


def run_program(program, runs, folder, extra=()):
    """`modebank run` with nothing but [data] configured, on runs of (inputs, states); archive: out.h5."""
    n = runs[0][1].shape[1]
    for i, (u, y) in enumerate(runs):
        names = [f"y{j}" for j in range(n)] + ["u0", "u1"]
        np.savetxt(folder / f"run_{i:02d}.csv", np.c_[DT_S * np.arange(len(y)), y, u], "%.9g", ",", header="time," + ",".join(names), comments="")
    states = ", ".join(f"y{j}" for j in range(n))
    (folder / "system.ini").write_text(f"[data]\ninputs = run_*.csv\nstate = {states}\ninput = u0, u1\ntime = time\n")
    return subprocess.run([program, "run", folder / "system.ini", "--archive.output", folder / "out.h5", "--job.threads", "1", *extra],
                          capture_output=True, text=True)
