"""Golden values of ARMAX fits and of their noise variances, by scipy.

Run from this folder:  /usr/bin/python3 armax.py > armax.json

Needs numpy and scipy. Each case has its runs (state n x N, input m x N) beside the expected fits. Fits minimise the log
determinant of the errors' covariance over [theta C], from levels that are not centred.
"""

import json
import sys

import numpy as np
from scipy import optimize

FIRST = 39


def simulate(rng, A, B, delays, ambient, wander, q, r, samples):
    n, m = B.shape
    u = np.round(np.repeat(rng.uniform(0, 50, (m, samples // 10)), 10, 1), 1)
    x, y = np.zeros((n, samples)), ambient + wander * rng.standard_normal((n, samples)).cumsum(1)
    for k in range(samples):
        if k:
            acting = [u[i, max(0, k - d)] for i, d in enumerate(delays)]
            x[:, k] = A @ x[:, k - 1] + B @ acting + q * rng.standard_normal(n)
        y[:, k] += x[:, k] + r * rng.standard_normal(n)
    return {"state": np.round(y, 4).tolist(), "input": u.tolist()}


def rows(y, u, na, nb, delays, constant):
    N = y.shape[1]
    lags = [y[:, FIRST - j:N - j] for j in range(1, na + 1)]
    inputs = [u[i:i + 1, FIRST - d - j:N - d - j] for i, d in enumerate(delays) for j in range(nb)]
    return np.vstack(lags + inputs + [np.ones((constant, N - FIRST))])


def prediction_errors(parameters, X, Z, W):
    """W e, n x rows of all runs. Errors before a run are unknown, so of all e that obey its equations: the least."""
    n, P, M = len(Z[0]), len(X[0]), parameters.reshape(len(Z[0]), -1).copy()
    size, K = M.shape[1] - P, X[0].shape[1]
    root = abs(np.linalg.eigvals(np.vstack([-M[:, P:], np.eye(size - n, size)]))).max()
    M[:, P:] *= min(1, .995 / root) ** (1 + np.arange(size) // n)
    C = np.hstack([np.eye(n), M[:, P:]]).reshape(n, -1, n).swapaxes(0, 1) @ np.linalg.inv(W)
    band = sum(np.kron(np.eye(K, K + size // n, size // n - j), c) for j, c in enumerate(C))
    right = np.array([(z - M[:, :P] @ x).T.ravel() for x, z in zip(X, Z)]).T
    return (band.T @ np.linalg.solve(band @ band.T, right)).T.reshape(-1, n).T


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
    X = [rows(y, u, na, nb, delays, constant) for y, u in zip(ys, us)]
    Z = [y[:, FIRST:] for y in ys]
    theta = np.linalg.lstsq(np.hstack(X).T, np.hstack(Z).T, rcond=None)[0].T
    count = sum(z.shape[1] for z in Z)
    parameters, W = np.hstack([theta, np.kron(np.poly([.5] * nc)[1:], np.eye(n))]).ravel(), np.eye(n)
    for _ in range(30):
        found = optimize.least_squares(lambda p, W=W: prediction_errors(p, X, Z, W).ravel(), parameters, x_scale="jac",
                                       xtol=1e-14, ftol=1e-14, gtol=1e-14)
        parameters, e = found.x, np.linalg.solve(W, prediction_errors(found.x, X, Z, W))
        W = np.linalg.inv(np.linalg.cholesky(e @ e.T / count))
    P, M = theta.shape[1], parameters.reshape(n, -1)
    S = e @ e.T / (count - M.shape[1])
    A = [np.eye(n)] + [-M[:, j * n:(j + 1) * n] for j in range(na)]
    C = [np.eye(n)] + [M[:, P + j * n:P + (j + 1) * n] for j in range(nc)]
    R, Q = variances(A, C, S, differences)
    return {"order": order, "theta": M[:, :P].tolist(), "C": M[:, P:].tolist(), "S": S.tolist(),
            "R": R.tolist(), "Q": Q.tolist(),
            "standard_error": np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac))).reshape(n, -1).tolist()}


def main():
    rng = np.random.default_rng(53)
    one = [simulate(rng, [[0.9]], np.array([[0.06, -0.1]]), [1, 4], 20, 0.05, 0.05, 0.1, 240) for _ in range(4)]
    two = [simulate(rng, [[0.9, 0.05], [-0.1, 0.8]], np.array([[0.04], [0.1]]), [2], 5, 0, 0.05, 0.1, 240)
           for _ in range(4)]
    cases = {"one": {"runs": one, "delays": [1, 4],
                     "fits": [fit(one, (0, 1, 1, 1), [1, 4]), fit(one, (1, 1, 1, 2), [1, 4])]},
             "two": {"runs": two, "delays": [2], "fits": [fit(two, (0, 1, 1, 1), [2])]}}
    json.dump(cases, sys.stdout)
    print()


if __name__ == "__main__":
    main()
