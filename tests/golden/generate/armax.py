"""Golden values of ARMAX fits and of their noise variances, by scipy.

Run from this folder:  /usr/bin/python3 armax.py > armax.json

Needs numpy and scipy. Each case has its runs (state n x N, input m x N) beside the expected fits. Fits minimise the log
determinant of the errors' covariance over [theta C], from levels that are not centred.
"""

import json
import sys

import numpy as np
from scipy import optimize

FIRST, LONG_FIRST, LONG_STATE, LONG_INPUT = 39, 33, 20, 30


def simulate(rng, A, B, delays, ambient, q, r, samples):
    n, m = B.shape
    u = np.round(np.repeat(rng.uniform(0, 50, (m, samples // 10)), 10, 1), 1)
    x, y = np.zeros((n, samples)), np.zeros((n, samples))
    for k in range(samples):
        if k:
            acting = [u[i, max(0, k - d)] for i, d in enumerate(delays)]
            x[:, k] = A @ x[:, k - 1] + B @ acting + q * rng.standard_normal(n)
        y[:, k] = ambient + x[:, k] + r * rng.standard_normal(n)
    return {"state": np.round(y, 4).tolist(), "input": u.tolist()}


def rows(y, u, na, nb, delays, constant, first):
    N = y.shape[1]
    lags = [y[:, first - j:N - j] for j in range(1, na + 1)]
    inputs = [u[i:i + 1, first - d - j:N - d - j] for i, d in enumerate(delays) for j in range(nb)]
    return np.vstack(lags + inputs + [np.ones((constant, N - first))])


def past_residuals(ys, us, constant):
    """Residuals of the long ARX on the samples before FIRST."""
    ones = [1] * us[0].shape[0]
    X = [rows(y, u, LONG_STATE, LONG_INPUT, ones, constant, LONG_FIRST) for y, u in zip(ys, us)]
    theta = np.linalg.lstsq(np.hstack(X).T, np.hstack([y[:, LONG_FIRST:] for y in ys]).T, rcond=None)[0].T
    return [(y[:, LONG_FIRST:] - theta @ x)[:, :FIRST - LONG_FIRST] for x, y in zip(X, ys)]


def prediction_errors(parameters, X, Z, past, nc):
    n, P = Z[0].shape[0], X[0].shape[0]
    M = parameters.reshape(n, -1)
    joined = []
    for x, z, before in zip(X, Z, past):
        e = np.hstack([before, z - M[:, :P] @ x])
        for k in range(before.shape[1], e.shape[1]):
            for j in range(nc):
                e[:, k] -= M[:, P + j * n:P + (j + 1) * n] @ e[:, k - 1 - j]
        joined.append(e[:, before.shape[1]:])
    return np.hstack(joined)


def autocovariances(M, V, K):
    blocks = [sum((M[i + lag] @ V @ M[i].T for i in range(len(M) - lag)), np.zeros_like(V)) for lag in range(K)]
    return np.array(blocks).ravel()


def variances(A, C, S, differences):
    """R and Q of errors that are scaled to unit variance, by scipy's nonnegative least squares."""
    n = len(S)
    D = np.diag(np.sqrt(np.diag(S)))
    scaled = [[np.linalg.solve(D, M) @ D for M in of] for of in (A, C)]
    zero, one = np.zeros((n, n)), [np.eye(n)]
    taken = (lambda M: [a - b for a, b in zip(M + [zero], [zero] + M)]) if differences else (lambda M: M)
    units = [np.diag(row) for row in np.eye(n)]
    cross = [s * (np.eye(2)[::-1]) for s in (1, -1)] if n == 2 else []
    shapes = [(taken(scaled[0]), V) for V in units] + [(taken(one), V) for V in units + cross]
    shapes += [(scaled[0], V) for V in units] if differences else []
    columns = np.array([autocovariances(M, V, 6) for M, V in shapes]).T
    x = optimize.nnls(columns, autocovariances(scaled[1], np.linalg.solve(D, S) @ np.linalg.inv(D), 6))[0]
    return x[:n] * np.diag(S), x[n:2 * n] * np.diag(S)


def fit(runs, order, delays):
    differences, na, nb, nc = order
    ys, us = ([np.array(run[key]) for run in runs] for key in ("state", "input"))
    ys, us = ([np.diff(v, axis=1) if differences else v[:, 1:] for v in of] for of in (ys, us))
    n, constant = ys[0].shape[0], 1 - differences
    past = [e[:, e.shape[1] - nc:] for e in past_residuals(ys, us, constant)]
    X = [rows(y, u, na, nb, delays, constant, FIRST) for y, u in zip(ys, us)]
    Z = [y[:, FIRST:] for y in ys]
    theta = np.linalg.lstsq(np.hstack(X).T, np.hstack(Z).T, rcond=None)[0].T
    parameters, W = np.hstack([theta, np.zeros((n, n * nc))]).ravel(), np.eye(n)
    for _ in range(30):
        def whitened(p):
            return (W @ prediction_errors(p, X, Z, past, nc)).ravel()
        found = optimize.least_squares(whitened, parameters, x_scale="jac", xtol=1e-14, ftol=1e-14, gtol=1e-14)
        parameters, e = found.x, prediction_errors(found.x, X, Z, past, nc)
        W = np.linalg.inv(np.linalg.cholesky(e @ e.T / e.shape[1]))
    P, M = theta.shape[1], parameters.reshape(n, -1)
    S = e @ e.T / (e.shape[1] - M.shape[1])
    A = [np.eye(n)] + [-M[:, j * n:(j + 1) * n] for j in range(na)]
    C = [np.eye(n)] + [M[:, P + j * n:P + (j + 1) * n] for j in range(nc)]
    R, Q = variances(A, C, S, differences)
    return {"order": list(map(int, order)), "theta": M[:, :P].tolist(), "C": M[:, P:].tolist(), "S": S.tolist(),
            "R": R.tolist(), "Q": Q.tolist(),
            "standard_error": np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac))).reshape(n, -1).tolist()}


def main():
    rng = np.random.default_rng(53)
    one = [simulate(rng, np.array([[0.9]]), np.array([[0.06, -0.1]]), [1, 4], 20, 0.05, 0.1, 240) for _ in range(4)]
    two = [simulate(rng, np.array([[0.9, 0.05], [-0.1, 0.8]]), np.array([[0.04], [0.1]]), [2], 5, 0.05, 0.1, 240)
           for _ in range(4)]
    cases = {"one": {"runs": one, "delays": [1, 4],
                     "fits": [fit(one, (0, 1, 1, 1), [1, 4]), fit(one, (1, 1, 1, 2), [1, 4])]},
             "two": {"runs": two, "delays": [2], "fits": [fit(two, (0, 1, 1, 1), [2])]}}
    json.dump(cases, sys.stdout)
    print()


if __name__ == "__main__":
    main()
