#!/usr/bin/python3
"""Independent reference for `drifting` with noise levels (filter/step/drifting.hpp), scalar y.

    /usr/bin/python3 tests/golden/generate/drifting_levels.py      writes drifting_levels.json into data/

Written from the equations of the interacting multiple model, with y in full form and h = [y[k-1], y[k-2], u[k-1],
u[k-2], 1] / D: theta of level j ~ N(m_j, v P_j); mixing by mu_i T_ij / c_j; y ~ t_nu(h'm_j, v (s_j + h'P_j h)); Bayes'
rule; a Kalman update per level; v <- max(lam v + (1 - lam) sum mu_j e_j^2 / (s_j + h'P_j h), floor); then leak and q.
The run begins with the stationary distribution of T. A missing sample is replaced by its prediction.

Three samples ahead: theta is the mixture of the levels by its moments; per level the joint covariance of the errors of
theta and of the two newest samples is carried along and mixed before each step; the density is the levels' mixture.
"""
import json
import math
import pathlib

import numpy as np

SAMPLES, AHEAD, MISSING = 60, 3, 30
Q, P0, LEAK, LAM, V0, FLOOR = 3e-3, 0.4, 0.97, 0.85, 0.02, 1e-4
THETA0 = np.array([0.6, 0.1, 0.5, -0.2, 0.05])  # full form
D = np.array([0.7, 0.8, 0.5, 0.6, 1.0])
S = np.array([0.1, 1.0, 20.0])
T = np.array([[0.9, 0.1, 0.0], [0.05, 0.9, 0.05], [0.1, 0.2, 0.7]])


def log_density(e, variance, nu):
    if nu == 0:
        return -0.5 * (np.log(2 * np.pi * variance) + e**2 / variance)
    scale2 = variance * (nu - 2) / nu
    constant = math.lgamma((nu + 1) / 2) - math.lgamma(nu / 2)
    return constant - 0.5 * np.log(nu * np.pi * scale2) - (nu + 1) / 2 * np.log1p(e**2 / (nu * scale2))


def simulated():
    g = np.random.default_rng(7)
    u, y, level = g.uniform(-1, 1, SAMPLES), np.zeros(SAMPLES), 1
    for k in range(2, SAMPLES):
        level = g.choice(3, p=T[level])
        noise = math.sqrt(V0 * S[level]) * g.standard_normal()
        y[k] = THETA0 @ [y[k - 1], y[k - 2], u[k - 1], u[k - 2], 1.0] + noise
    return y, u


def moments(weights, means, covariances):
    mean = weights @ means
    return mean, sum(w * (C + np.outer(m - mean, m - mean)) for w, m, C in zip(weights, means, covariances))


def ahead(state, past, u, k):
    """Mean, variances and probabilities of the levels of sample k + AHEAD - 1; u: all inputs."""
    theta0, m, V, mu, v = THETA0 * D, *state
    mean, cov = moments(mu, m, V)
    joint = [np.zeros((7, 7)) for _ in S]  # theta, then the errors of the two newest samples
    for J in joint:
        J[:5, :5] = cov
    for i in range(AHEAD):
        if i > 0:
            mean = theta0 + LEAK * (mean - theta0)
            for J in joint:
                J[:5] *= LEAK
                J[:, :5] *= LEAK
                J[:5, :5] += Q * v * np.eye(5)
        c = mu @ T
        joint = [sum(mu[a] * T[a, b] / c[b] * joint[a] for a in range(3)) for b in range(3)]
        mu = c
        h = np.array([*past, u[k + i - 1], u[k + i - 2], 1.0]) / D
        F = np.eye(7)
        F[5] = [*h, *(mean / D)[:2]]
        F[6] = np.eye(7)[5]
        joint = [F @ J @ F.T for J in joint]
        for J, s in zip(joint, S):
            J[5, 5] += v * s
        past = [mean @ h, past[0]]
    return past[0], np.array([J[5, 5] for J in joint]), mu


def reference(y, u, nu):
    theta0 = THETA0 * D
    m, V, v = np.tile(theta0, (3, 1)), np.tile(P0 * V0 * np.eye(5), (3, 1, 1)), V0
    values, vectors = np.linalg.eig(T.T)
    mu = np.real(vectors[:, np.argmax(np.real(values))])
    mu = mu / mu.sum()
    out = {name: [] for name in ("prediction", "variance", "log_density", "probability", "v", "far_error", "far_density")}
    known = y.copy()
    for k in range(2, SAMPLES):
        if k + AHEAD <= SAMPLES:
            mean, variances, weights = ahead((m, V, mu, v), [known[k - 1], known[k - 2]], u, k)
            e = y[k + AHEAD - 1] - mean
            out["far_error"].append(e)
            out["far_density"].append(np.log(weights @ np.exp(log_density(e, variances, nu))))
        c = mu @ T
        mixed = [moments(mu * T[:, j] / c[j], m, V) for j in range(3)]
        m, V = np.array([a for a, _ in mixed]), np.array([b for _, b in mixed])
        h = np.array([known[k - 1], known[k - 2], u[k - 1], u[k - 2], 1.0]) / D
        mean, variance = m @ h, np.array([v * s + h @ C @ h for s, C in zip(S, V)])
        combined = c @ mean
        out["prediction"].append(combined)
        out["variance"].append(c @ (variance + (mean - combined) ** 2))
        missing = k == MISSING
        known[k] = combined if missing else y[k]
        e = known[k] - mean
        density = np.exp(log_density(e, variance, nu))
        out["log_density"].append(0.0 if missing else math.log(c @ density))
        mu = c if missing else c * density / (c @ density)
        before = v
        if not missing:
            gain = np.array([C @ h for C in V]) / variance[:, None]
            m = m + gain * e[:, None]
            V = np.array([C - np.outer(g, g) * w for C, g, w in zip(V, gain, variance)])
            v = max(LAM * v + (1 - LAM) * v * (mu @ (e**2 / variance)), FLOOR)
        m = theta0 + LEAK * (m - theta0)
        V = (LEAK**2 * V / before + Q * np.eye(5)) * v
        out["probability"].append(mu.tolist())
        out["v"].append(v)
    return out


def main():
    y, u = simulated()
    golden = {
        "theta0": THETA0.tolist(), "scale": D.tolist(), "level": S.tolist(), "T": T.tolist(), "rates": [Q, P0, LEAK],
        "lam": LAM, "v0": V0, "floor": FLOOR, "missing": MISSING, "ahead": AHEAD, "y": y.tolist(), "u": u.tolist(),
        "expected": [{"nu": nu, **reference(y, u, nu)} for nu in (0, 5)],
    }
    path = pathlib.Path(__file__).resolve().parent.parent / "data" / "drifting_levels.json"
    path.write_text(json.dumps(golden, indent=1) + "\n")


if __name__ == "__main__":
    main()
