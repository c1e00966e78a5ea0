"""Golden values of window fits, by statsmodels and scipy.

Run from this folder:  /usr/bin/python3 ident_fits.py > ident_fits.json

Needs numpy, scipy and statsmodels. Each case holds its data (state n x N, input m x N) beside the expected values, so
the test needs no random generator of its own. theta is the row-major vec of [A B (c)] of the increment form.
"""

import json
import sys

import numpy as np
import statsmodels.api as sm
from scipy import optimize

TUNING = {"huber": 1.345, "cauchy": 2.385, "softlone": 1.287, "tukey": 4.685, "arctan": 2.571}
SCIPY_NAME = {"huber": "huber", "cauchy": "cauchy", "softlone": "soft_l1", "arctan": "arctan"}


def simulate(rng, theta, samples, noise_sd, intercept, outliers):
    n = theta.shape[0]
    m = theta.shape[1] - n - intercept
    u = np.round(rng.uniform(-1, 1, (m, samples)), 3)
    x = np.zeros((n, samples))
    for k in range(samples - 1):
        phi = np.concatenate([x[:, k], u[:, k], np.ones(intercept)])
        x[:, k + 1] = x[:, k] + theta @ phi + noise_sd * rng.standard_normal(n)
    for k in outliers:
        x[:, k] += 12 * noise_sd * rng.choice([-1, 1], n)
    return np.round(x, 6), u


def regression(x, u, intercept):
    X = np.vstack([x, u, np.ones((intercept, x.shape[1]))])[:, :-1].T
    return X, (x[:, 1:] - x[:, :-1]).T


def weight(loss, s):
    """rho'(s) of each loss, s = |r|^2."""
    c2 = TUNING[loss] ** 2
    return {
        "huber": lambda: np.where(s <= c2, 1.0, np.sqrt(c2 / np.maximum(s, c2))),
        "cauchy": lambda: 1 / (1 + s / c2),
        "softlone": lambda: 1 / np.sqrt(1 + s / c2),
        "arctan": lambda: 1 / (1 + (s / c2) ** 2),
        "tukey": lambda: np.where(s <= c2, (1 - np.minimum(s / c2, 1)) ** 2, 0.0),
    }[loss]()


def stationary_point(loss, X, Y, sigma, start):
    """Root of the estimating equations sum w_k psi_k phi_k' = 0, all states sharing one loss per sample."""
    n, q = Y.shape[1], X.shape[1]

    def equations(theta):
        r = (Y - X @ theta.reshape(n, q).T) / sigma
        w = weight(loss, (r**2).sum(axis=1))
        return ((w[:, None] * r / sigma).T @ X).ravel()

    theta = start
    for _ in range(20):  # restarted: hybr stops short when its first Jacobian is stale
        theta = optimize.root(equations, theta, method="hybr", options={"xtol": 1e-15}).x
    # The smallest gradient that rounding allows, against the size of its terms.
    size = np.abs(X).sum() / sigma.min()
    assert np.abs(equations(theta)).max() < 1e-11 * size, (loss, equations(theta))
    return theta


def cost(theta, loss, X, Y, sigma):
    """sum rho(|r_k|^2) / 2."""
    c2 = TUNING[loss] ** 2
    s = (((Y - X @ theta.reshape(Y.shape[1], -1).T) / sigma) ** 2).sum(axis=1)
    return 0.5 * {
        "huber": lambda: np.where(s <= c2, s, 2 * np.sqrt(c2 * s) - c2),
        "cauchy": lambda: c2 * np.log1p(s / c2),
        "softlone": lambda: 2 * c2 * (np.sqrt(1 + s / c2) - 1),
        "arctan": lambda: c2 * np.arctan(s / c2),
        "tukey": lambda: c2 / 3 * (1 - (1 - np.minimum(s / c2, 1)) ** 3),
    }[loss]().sum()


def robust_optima(X, Y, sigma):
    ols = np.linalg.lstsq(X, Y, rcond=None)[0].T.ravel()
    optima = {}
    for loss in TUNING:
        start = optima.get("huber", ols)
        if Y.shape[1] == 1 and loss in SCIPY_NAME:
            start = optimize.least_squares(
                lambda t: (Y[:, 0] - X @ t) / sigma[0], start, loss=SCIPY_NAME[loss], f_scale=TUNING[loss],
                xtol=1e-15, ftol=1e-15, gtol=1e-15).x
        else:  # scipy has no vector losses and no Tukey
            start = optimize.minimize(cost, start, args=(loss, X, Y, sigma), tol=1e-10).x
        optima[loss] = stationary_point(loss, X, Y, sigma, start)
    return {k: v.tolist() for k, v in optima.items()}


def single_state(rng):
    theta = np.array([[-0.3, -0.4, 0.5]])
    x, u = simulate(rng, theta, 26, 0.05, 0, [7, 15, 22])
    X, Y = regression(x, u, 0)
    ols = sm.OLS(Y[:, 0], X).fit()
    rlm = sm.RLM(Y[:, 0], X, M=sm.robust.norms.HuberT(TUNING["huber"])).fit(
        update_scale=False, tol=1e-15, maxiter=2000, cov="H1")
    sigma = np.array([0.06])
    return {
        "state": x.tolist(), "input": u.tolist(), "intercept": False, "sigma": sigma.tolist(),
        "ols": {"theta": ols.params.tolist(), "covariance": ols.cov_params().tolist(), "hc3": ols.cov_HC3.tolist(),
                "noise_variance": ols.scale, "population_variance": float(np.mean(ols.resid**2))},
        "rlm": {"sigma": rlm.scale, "theta": rlm.params.tolist(),
                "covariance": rlm.bcov_scaled.tolist()},
        "robust": robust_optima(X, Y, sigma),
    }


def two_states(rng):
    theta = np.array([[-0.3, 0.1, 0.5, 0.05], [0.2, -0.4, -0.3, -0.1]])
    x, u = simulate(rng, theta, 41, np.array([0.05, 0.15]), 1, [9, 30])
    X, Y = regression(x, u, 1)
    sigma = np.array([0.06, 0.14])
    fits = [sm.OLS(Y[:, i], X).fit() for i in range(2)]
    q, L = X.shape[1], X.shape[0]
    S = np.array([[fits[i].resid @ fits[j].resid / (L - q) for j in range(2)] for i in range(2)])
    robust = robust_optima(X, Y, sigma)

    # Covariance block (i, j): sigma_i sigma_j K_i K_j [sum psi_i psi_j / (L - q)] / (mean psi'_i mean psi'_j) (X'X)^-1.
    r = (Y - X @ np.array(robust["huber"]).reshape(2, q).T) / sigma
    s = (r**2).sum(axis=1)
    c = TUNING["huber"]
    w = weight("huber", s)
    curvature = np.where(s <= c * c, 0.0, -w / (2 * s))
    psi = w[:, None] * r
    slopes = w[:, None] + 2 * curvature[:, None] * r**2
    slope = slopes.mean(axis=0)
    K = 1 + q / L * slopes.var(axis=0) / slope**2
    G = psi.T @ psi / (L - q) * np.outer(K / slope, K / slope)
    return {
        "state": x.tolist(), "input": u.tolist(), "intercept": True, "sigma": sigma.tolist(),
        "ols": {"theta": np.concatenate([f.params for f in fits]).tolist(),
                "covariance": np.kron(S, np.linalg.inv(X.T @ X)).tolist(),
                "standard_error": np.concatenate([f.bse for f in fits]).tolist(),
                "hc3": [f.cov_HC3.tolist() for f in fits]},
        "robust": robust,
        "huber_covariance": np.kron(np.outer(sigma, sigma) * G, np.linalg.inv(X.T @ X)).tolist(),
    }


def unexcited(rng):
    """Both inputs hold one constant command: rank 2 of 3."""
    x, u = simulate(rng, np.array([[-0.3, -0.4, 0.5]]), 26, 0.05, 0, [])
    u[:] = np.array([[0.3], [0.5]])
    for k in range(25):
        x[0, k + 1] = x[0, k] - 0.3 * x[0, k] + 0.13 + 0.05 * rng.standard_normal()
    x = np.round(x, 6)
    X, Y = regression(x, u, 0)
    solution, _, rank, _ = np.linalg.lstsq(X, Y[:, 0], rcond=1e-10)
    mean, sd, sigma = np.array([-0.2, -0.3, 0.4]), np.array([0.5, 0.8, 0.3]), 0.05
    information = X.T @ X / sigma**2 + np.diag(sd**-2.0)
    posterior = np.linalg.solve(information, X.T @ Y[:, 0] / sigma**2 + mean / sd**2)
    return {
        "state": x.tolist(), "input": u.tolist(), "intercept": False, "sigma": [sigma],
        "minimum_norm": solution.tolist(), "rank": int(rank),
        "prior": {"mean": mean.tolist(), "sd": sd.tolist(), "theta": posterior.tolist()},
    }


def main():
    rng = np.random.default_rng(20250502)
    cases = {"single_state": single_state(rng), "two_states": two_states(rng), "unexcited": unexcited(rng)}
    json.dump(cases, sys.stdout, indent=1)
    print()


if __name__ == "__main__":
    main()
