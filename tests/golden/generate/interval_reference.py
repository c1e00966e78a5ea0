#!/usr/bin/python3
"""Independent filter of quantised measurements, and the golden files it writes.

    /usr/bin/python3 tests/golden/generate/interval_reference.py

writes imm_quantised.json into data/: an interacting multiple model filter of one state (Bar-Shalom, Li & Kirubarajan
2001, section 11.6.6) whose measurement is the interval [y - q/2, y + q/2] of x + v. The moments of a mode's state given
the interval come from a sum over a fine grid of the state itself, with Phi from math.erf, and from no formula for
truncated normal variables. Nothing here is shared with the C++ code.
"""
import json
import math
import pathlib

import numpy as np

FOLDER = pathlib.Path(__file__).parent.parent / "data"
GRID = np.linspace(-9.0, 9.0, 40001)
ROOT = math.sqrt(2.0)
erf = np.vectorize(math.erf)


def phi(x):
    return 0.5 * (1.0 + erf(x / ROOT))


def condition(mean, variance, R, low, high):
    """Mass, mean and variance of x ~ N(mean, variance) given that x + v is in [low, high], v ~ N(0, R)."""
    deviation = math.sqrt(variance)
    # Without noise the integrand is discontinuous at the interval's ends, so the grid is split there.
    ends = np.clip([(low - mean) / deviation, (high - mean) / deviation], -9.0, 9.0)
    if R == 0.0:
        x = np.linspace(ends[0], ends[1], 40001)
        weight = np.exp(-0.5 * x ** 2)
    else:
        x = GRID
        weight = np.exp(-0.5 * x ** 2) * (phi((high - mean - deviation * x) / math.sqrt(R))
                                          - phi((low - mean - deviation * x) / math.sqrt(R)))
    simpson = np.ones(len(x))
    simpson[1:-1:2], simpson[2:-1:2] = 4.0, 2.0
    weight = weight * simpson * (x[1] - x[0]) / 3.0 / math.sqrt(2.0 * math.pi)
    mass = weight.sum()
    centre = (weight * x).sum() / mass
    spread = (weight * (x - centre) ** 2).sum() / mass
    return mass, mean + deviation * centre, variance * spread


def run_filter(bank, u, y, q):
    K, R, T = len(bank["A"]), bank["R"], np.array(bank["T"])
    mu = np.array(bank["pi"])
    means, variances = np.full(K, y[0]), np.full(K, R + q * q / 12.0)
    out = dict(log_density=[None], low=[None], high=[None], state=[float(mu @ means)], covariance=[float(variances[0])],
               mu=[mu.tolist()])
    for k in range(1, len(y)):
        c = T.T @ mu
        posterior = np.zeros(K)
        low_cdf = high_cdf = 0.0
        new_means, new_variances = np.zeros(K), np.zeros(K)
        for j in range(K):
            w = T[:, j] * mu / c[j]
            start = w @ means
            spread = w @ (variances + (means - start) ** 2)
            F = 1.0 + bank["A"][j]
            x = F * start + bank["B"][j] * u[k - 1] + bank["c"][j]
            P = F * F * spread + bank["Q"][j]
            if y[k] is None:
                new_means[j], new_variances[j], posterior[j] = x, P, c[j]
                continue
            mass, new_means[j], new_variances[j] = condition(x, P, R, y[k] - q / 2, y[k] + q / 2)
            posterior[j] = c[j] * mass
            low_cdf += c[j] * float(phi((y[k] - q / 2 - x) / math.sqrt(P + R)))
            high_cdf += c[j] * float(phi((y[k] + q / 2 - x) / math.sqrt(P + R)))
        total = posterior.sum()
        mu, means, variances = posterior / total, new_means, new_variances
        missing = y[k] is None
        out["log_density"].append(None if missing else math.log(total / q))
        out["low"].append(None if missing else low_cdf)
        out["high"].append(None if missing else high_cdf)
        state = float(mu @ means)
        out["state"].append(state)
        out["covariance"].append(float(mu @ (variances + (means - state) ** 2)))
        out["mu"].append(mu.tolist())
    return out


def main():
    g = np.random.default_rng(7)
    bank = dict(A=[-0.2, -0.5], B=[0.3, -0.2], c=[0.02, -0.03], Q=[1e-2, 9e-2], R=4e-3, T=[[0.9, 0.1], [0.15, 0.85]],
                pi=[0.6, 0.4])
    samples, x, z = 60, 0.0, 0
    u = g.uniform(-1.0, 1.0, samples)
    exact = np.zeros(samples)
    for k in range(1, samples):
        z = int(g.choice(2, p=bank["T"][z]))
        x = (1.0 + bank["A"][z]) * x + bank["B"][z] * u[k - 1] + bank["c"][z] + math.sqrt(bank["Q"][z]) * g.standard_normal()
        exact[k] = x + math.sqrt(bank["R"]) * g.standard_normal()
    cases = []
    for q, R in ((0.05, 4e-3), (0.2, 4e-3), (0.2, 0.0), (0.8, 4e-3)):
        y = [float(round(value / q) * q) for value in exact]
        y[20] = y[21] = None
        cases.append(dict(quantum=q, R=R, measurement=y, expected=run_filter({**bank, "R": R}, u, y, q)))
    golden = dict(bank=bank, input=u.tolist(), cases=cases)
    (FOLDER / "imm_quantised.json").write_text(json.dumps(golden) + "\n")


if __name__ == "__main__":
    main()
