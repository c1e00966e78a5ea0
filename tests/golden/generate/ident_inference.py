"""Golden values of weighted fits, of what a fit says of its quality, and of residual tests, by statsmodels and scipy.

Run from this folder:  /usr/bin/python3 ident_inference.py > ident_inference.json

Needs numpy, scipy and statsmodels. Each case holds its data (state n x N, input m x N, weight N) beside the expected
values. theta is the vec of [A B (c)] of the increment form.
"""

import json
import sys

import numpy as np
import statsmodels.api as sm
from scipy import optimize
from statsmodels.stats.diagnostic import acorr_ljungbox
from statsmodels.tsa.stattools import acf, ccf

from ident_fits import TUNING, cost, regression, simulate, stationary_point, weight


def weighted_least_squares(rng):
    x, u = simulate(rng, np.array([[-0.3, -0.4, 0.5]]), 31, 0.05, 0, [11])
    w = np.round(rng.uniform(0.2, 3.0, 31), 3)
    w[8] = 0.0  # leaves out the transition that ends in sample 8
    X, Y = regression(x, u, 0)
    used = w[1:] > 0
    fit = sm.WLS(Y[used, 0], X[used], weights=w[1:][used]).fit()
    return {
        "state": x.tolist(), "input": u.tolist(), "weight": w.tolist(), "sigma": [0.06],
        "theta": fit.params.tolist(), "covariance": fit.cov_params().tolist(), "hc3": fit.cov_HC3.tolist(),
        "standard_error": fit.bse.tolist(), "t_value": fit.tvalues.tolist(),
        # statsmodels' scale is for weight one, modebank's for the mean weight
        "noise_variance": fit.scale / w[1:][used].mean(),
        # statsmodels' R^2 of a model without constant is about zero, modebank's is about the mean
        "r_squared": 1 - fit.ssr / fit.centered_tss,
        "population_variance": fit.ssr / used.sum() / w[1:][used].mean(),
        "transitions": int(used.sum()),
    }


def ordinary_least_squares(rng):
    theta = np.array([[-0.3, 0.1, 0.5, 0.05], [0.2, -0.4, -0.3, -0.1]])
    x, u = simulate(rng, theta, 41, np.array([0.05, 0.15]), 1, [9])
    X, Y = regression(x, u, 1)
    fits = [sm.OLS(Y[:, i], X).fit() for i in range(2)]
    return {
        "state": x.tolist(), "input": u.tolist(), "sigma": [0.06, 0.14],
        "standard_error": np.concatenate([f.bse for f in fits]).tolist(),
        "t_value": np.concatenate([f.tvalues for f in fits]).tolist(),
        "r_squared": [f.rsquared for f in fits],  # with a constant it is about the mean
    }


def repeated_transitions(rng):
    """Whole weights: the same as that many copies of each transition."""
    x, u = simulate(rng, np.array([[-0.3, -0.4, 0.5]]), 31, 0.05, 0, [7, 22])
    w = rng.integers(1, 4, 31)
    X, Y = regression(x, u, 0)
    sigma = np.array([0.06])
    copies = np.repeat(np.arange(30), w[1:])
    optima, r_squared = {}, {}
    for loss in TUNING:
        start = optima.get("huber", np.linalg.lstsq(X, Y, rcond=None)[0].T.ravel())
        start = optimize.minimize(cost, start, args=(loss, X[copies], Y[copies], sigma), tol=1e-10).x
        theta = stationary_point(loss, X[copies], Y[copies], sigma, start)
        optima[loss] = theta
        v = w[1:] / w[1:].mean()
        e = Y[:, 0] - X @ theta
        s = (e / sigma[0]) ** 2
        omega = weight(loss, s)
        mean = (omega * v * Y[:, 0]).sum() / (omega * v).sum()
        r_squared[loss] = 1 - (omega * v * e**2).sum() / (omega * v * (Y[:, 0] - mean) ** 2).sum()
    return {
        "state": x.tolist(), "input": u.tolist(), "weight": w.tolist(), "sigma": sigma.tolist(),
        "theta": {k: v.tolist() for k, v in optima.items()}, "r_squared": r_squared,
    }


def residual_tests(rng):
    N, lags = 400, 25
    u = rng.standard_normal((2, N))
    e = np.zeros((1, N))
    for k in range(N):
        e[0, k] = (0.6 * e[0, k - 1] if k else 0) + rng.standard_normal() + (0.8 * u[1, k - 3] if k >= 3 else 0)
    e, u = np.round(e, 6), np.round(u, 6)
    return {
        "residual": e.tolist(), "input": u.tolist(), "lags": lags,
        "autocorrelation": acf(e[0], nlags=lags, fft=False).tolist(),
        "cross_correlation": [ccf(e[0], u[j], adjusted=False)[: lags + 1].tolist() for j in range(2)],
        "ljung_box_p": float(acorr_ljungbox(e[0][:60], lags=[12])["lb_pvalue"].iloc[0]),
    }


def main():
    rng = np.random.default_rng(20261121)
    cases = {f.__name__: f(rng) for f in
             (weighted_least_squares, ordinary_least_squares, repeated_transitions, residual_tests)}
    json.dump(cases, sys.stdout, indent=1)
    print()


if __name__ == "__main__":
    main()
