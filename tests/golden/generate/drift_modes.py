#!/usr/bin/python3
"""Independent reference for modes that drift (filter/step/equations/drift.hpp), R = 0, scalar y.

    /usr/bin/python3 tests/golden/generate/drift_modes.py      writes drift_modes.json and drift_one_theta.json into data/

Written from the equations with y in full form and every mode's coefficients as one vector: theta_k ~ N(m_k, s P_k), of
h = [y[k-1], y[k-2], u[k-1], u[k-2], 1]. Every step: mode probabilities by T; y ~ N(h'm_k, s (Q_k + h'P_k h)) per mode;
Bayes' rule with probabilities kept above 1e-12; the noise scale s by its discounted sums, errors of theta counted as
noise, squares of standardised errors at most 25; theta_k as the mixture, with mu_k, of its Kalman update and of what it
was; then leak and W_k = q Q_k / D^2.

Modes of one theta (drift_one_theta.json) differ in Q alone: the Gaussian of theta is after a step the mixture, with
mu_k, of the posteriors that it would have had each mode ruled the step, written as a mixture's moments; W and P at the
start are of the modes' mean Q, weighted with their shares.
"""
import json
import math
import pathlib

import numpy as np

SAMPLES, Q_RATE, P_START, LEAK, FORGETTING, PRIOR = 60, 3e-2, 0.5, 0.97, 0.8, 0.5
WEIGHTS = [0.3, 0.7]


def main():
    write("drift_modes", [[0.6, 0.1, 0.5, -0.2, 0.05], [0.9, -0.3, -0.4, 0.3, 0.0]], own_thetas)
    write("drift_one_theta", [[0.6, 0.1, 0.5, -0.2, 0.05]] * 2, one_theta)


def own_thetas(m, P, mu, h, e, S, s, theta0, units, Q):
    for j in range(2):
        gain = s * P[j] @ h / S[j]
        move = gain * e[j]
        P[j] += mu[j] * (-np.outer(gain, gain) * S[j] + (1 - mu[j]) * np.outer(move, move)) / s
        m[j] = m[j] + mu[j] * move
        m[j] = theta0[j] + LEAK * (m[j] - theta0[j])
        P[j] = LEAK**2 * P[j] + Q_RATE * Q[j] * units


def one_theta(m, P, mu, h, e, S, s, theta0, units, Q):
    """Both rows of m and P hold the same."""
    means, covariances = [], []
    for j in range(2):
        gain = s * P[0] @ h / S[j]
        means.append(m[0] + gain * e[j])
        covariances.append(s * P[0] - np.outer(gain, gain) * S[j])
    mean = mu @ np.array(means)
    covariance = sum(mu[j] * (covariances[j] + np.outer(means[j] - mean, means[j] - mean)) for j in range(2))
    m[:] = theta0[0] + LEAK * (mean - theta0[0])
    P[:] = LEAK**2 * covariance / s + Q_RATE * (WEIGHTS @ Q) * units


def write(name, theta0, learn):
    g = np.random.default_rng(5)
    theta0 = np.array(theta0)  # full form
    Q, scale = np.array([0.02, 0.3]), np.array([0.7, 0.8, 0.5, 0.6, 1.0])
    T, pi = np.array([[0.9, 0.1], [0.2, 0.8]]), np.array([0.7, 0.3])
    u = g.uniform(-1, 1, SAMPLES)
    y, true, mode = np.zeros(SAMPLES), theta0.copy(), 0
    for k in range(2, SAMPLES):
        mode = g.choice(2, p=T[mode])
        true = true + 0.03 * g.standard_normal(true.shape)
        y[k] = true[mode] @ [y[k - 1], y[k - 2], u[k - 1], u[k - 2], 1.0] + math.sqrt(Q[mode]) * g.standard_normal()

    units = np.diag(scale**-2.0)
    m, P = theta0.copy(), np.array([P_START * q * units for q in (Q if learn is own_thetas else [WEIGHTS @ Q] * 2)])
    mu, s, weight = pi.copy(), 1.0, PRIOR
    out = {"prediction": [], "variance": [], "log_density": [], "mode_probability": [], "noise_scale": []}
    for k in range(2, SAMPLES):
        h = np.array([y[k - 1], y[k - 2], u[k - 1], u[k - 2], 1.0])
        c, mean = mu @ T, m @ h
        S = np.array([s * (Q[j] + h @ P[j] @ h) for j in range(2)])
        e = y[k] - mean
        density = np.exp(-0.5 * e**2 / S) / np.sqrt(2 * math.pi * S)
        joint = c * density
        combined = c @ mean
        out["prediction"].append(combined)
        out["variance"].append(c @ (S + (mean - combined) ** 2))
        out["log_density"].append(math.log(joint.sum()))
        posterior = joint / joint.sum()
        mu = np.maximum(posterior, 1e-12)
        mu /= mu.sum()
        learn(m, P, mu, h, e, S, s, theta0, units, Q)
        squares = FORGETTING * weight * s + (1 - FORGETTING) * PRIOR + s * (posterior @ np.minimum(e**2 / S, 25.0))
        weight = FORGETTING * weight + (1 - FORGETTING) * PRIOR + 1.0
        s = squares / weight
        out["mode_probability"].append(mu.tolist())
        out["noise_scale"].append(s)

    golden = {
        "theta0": theta0.tolist(), "Q": Q.tolist(), "scale": scale.tolist(), "T": T.tolist(), "pi": pi.tolist(),
        "rates": [Q_RATE, P_START, LEAK], "noise": [FORGETTING, PRIOR], "y": y.tolist(), "u": u.tolist(),
        "expected": out,
    }
    if learn is one_theta:
        golden["weights"] = WEIGHTS
    path = pathlib.Path(__file__).resolve().parent.parent / "data" / f"{name}.json"
    path.write_text(json.dumps(golden, indent=1) + "\n")


if __name__ == "__main__":
    main()
