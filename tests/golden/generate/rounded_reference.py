#!/usr/bin/python3
"""Independent filter of rounded measurements, and the golden file it writes.

    /usr/bin/python3 tests/golden/generate/rounded_reference.py

writes imm_rounded.json into data/: an interacting multiple model filter (Bar-Shalom, Li & Kirubarajan 2001, section
11.6.6) of n measured states with R = max(R, q^2 / 12). The score of a reading is the mass of its interval under the
mixture, ln(mass) - sum ln(q), one signal after the other, each given the readings before it; the variance of a signal
there is that of the prediction without q^2 / 12. Nothing here is shared with the C++ code.
"""
import json
import math
import pathlib

import numpy as np

FOLDER = pathlib.Path(__file__).parent.parent / "data"


def below(x):
    return 0.5 * math.erfc(-x / math.sqrt(2.0))


def normal(e, variance):
    return math.exp(-0.5 * e * e / variance) / math.sqrt(2.0 * math.pi * variance)


def update(x, P, R, y, there):
    """Posterior of one mode, its density of the readings, and each reading's error and variance given those before."""
    chain = {}
    density = 1.0
    mean, covariance = x.copy(), P.copy()
    for i in there:  # R is diagonal, so readings come one by one
        e, s = y[i] - mean[i], covariance[i, i] + R[i]
        chain[i] = (e, s)
        density *= normal(e, s)
        gain = covariance[:, i] / s
        mean = mean + gain * e
        covariance = covariance - np.outer(gain, covariance[i, :])
    return mean, covariance, density, chain


def score(c, chains, q, there, n):
    """Log of the mixture's mass of all readings, and the distribution function at both ends of each interval."""
    low, high, total, weight = [None] * n, [None] * n, 0.0, c.copy()
    for i in there:
        masses = np.zeros(len(c))
        low[i] = high[i] = 0.0
        for j, chain in enumerate(chains):
            e, s = chain[i]
            deviation = math.sqrt(s - q[i] ** 2 / 12.0)
            ends = below((e - q[i] / 2) / deviation), below((e + q[i] / 2) / deviation)
            low[i] += weight[j] * ends[0]
            high[i] += weight[j] * ends[1]
            masses[j] = (ends[1] - ends[0]) / q[i] if q[i] > 0 else normal(e, s)
        total += math.log(weight @ masses)
        weight = weight * masses / (weight @ masses)
    return total, low, high


def run_filter(bank, u, y, q, R):
    K, n, T = len(bank["A"]), len(q), np.array(bank["T"])
    A, B, c0, Q = (np.array(bank[name]) for name in ("A", "B", "c", "Q"))
    R = np.maximum(R, np.array(q) ** 2 / 12.0)
    mu = np.array(bank["pi"])
    means = [np.array(y[0])] * K
    covariances = [np.diag(R)] * K
    out = dict(log_density=[None], low=[[None] * n], high=[[None] * n], state=[y[0]], covariance=[np.diag(R).tolist()],
               mu=[mu.tolist()])
    for k in range(1, len(y)):
        c = T.T @ mu
        there = [i for i in range(n) if y[k][i] is not None]
        posterior, chains, new_means, new_covariances = c.copy(), [], [], []
        for j in range(K):
            w = T[:, j] * mu / c[j]
            start = sum(w[i] * means[i] for i in range(K))
            spread = sum(w[i] * (covariances[i] + np.outer(means[i] - start, means[i] - start)) for i in range(K))
            F = np.eye(n) + A[j]
            mean, covariance, density, chain = update(F @ start + B[j] * u[k - 1] + c0[j], F @ spread @ F.T + Q[j], R,
                                                      y[k], there)
            posterior[j] *= density
            chains.append(chain)
            new_means.append(mean)
            new_covariances.append(covariance)
        mu, means, covariances = posterior / posterior.sum(), new_means, new_covariances
        total, low, high = score(c, chains, q, there, n)
        state = sum(mu[j] * means[j] for j in range(K))
        out["log_density"].append(total if there else None)
        out["low"].append(low)
        out["high"].append(high)
        out["state"].append(state.tolist())
        out["covariance"].append(sum(mu[j] * (covariances[j] + np.outer(means[j] - state, means[j] - state))
                                     for j in range(K)).tolist())
        out["mu"].append(mu.tolist())
    return out


def simulate(bank, R, q, g, samples):
    n, T = len(q), np.array(bank["T"])
    x, z, readings = np.zeros(n), 0, [[0.0] * n]
    u = g.uniform(-1.0, 1.0, samples)
    for k in range(1, samples):
        z = int(g.choice(len(T), p=T[z]))
        noise = np.linalg.cholesky(np.array(bank["Q"][z])) @ g.standard_normal(n)
        moved = np.array(bank["A"][z]) @ x + np.array(bank["B"][z]) * u[k - 1] + np.array(bank["c"][z])
        x = x + moved + noise
        exact = x + np.sqrt(R) * g.standard_normal(n)
        readings.append([float(round(v / step) * step) if step > 0 else float(v) for v, step in zip(exact, q)])
    for k in (20, 21):
        readings[k] = [None] * n
    readings[30][0] = None
    return u.tolist(), readings


def main():
    g = np.random.default_rng(7)
    chain = dict(T=[[0.9, 0.1], [0.15, 0.85]], pi=[0.6, 0.4])
    one = dict(A=[[[-0.2]], [[-0.5]]], B=[[0.3], [-0.2]], c=[[0.02], [-0.03]], Q=[[[1e-2]], [[9e-2]]], **chain)
    two = dict(A=[[[-0.2, 0.1], [0.0, -0.3]], [[-0.5, 0.0], [0.2, -0.1]]], B=[[0.3, 0.1], [-0.2, 0.4]],
               c=[[0.02, 0.0], [-0.03, 0.05]], Q=[[[1e-2, 6e-3], [6e-3, 2e-2]], [[9e-2, -2e-2], [-2e-2, 4e-2]]],
               **chain)
    cases = []
    for bank, q, R in ((one, [0.05], [4e-3]), (one, [0.2], [4e-3]), (one, [0.2], [0.0]), (one, [0.8], [4e-3]),
                       (two, [0.2, 0.4], [1e-3, 0.0]), (two, [0.2, 0.0], [0.0, 2e-3])):
        u, y = simulate(bank, np.array(R), q, g, 60)
        cases.append(dict(bank=bank, quantum=q, R=R, input=u, measurement=y, expected=run_filter(bank, u, y, q, R)))
    (FOLDER / "imm_rounded.json").write_text(json.dumps(dict(cases=cases)) + "\n")


if __name__ == "__main__":
    main()
