#!/usr/bin/python3
"""Independent references for learning banks, and the golden files they make.

    /usr/bin/python3 tests/golden/generate/learn_reference.py

writes learn_baseline.json and learn_noise_only.json into data/: Kalman filter likelihoods maximised by Nelder-Mead,
and the noise-switching competitor by statsmodels' RLM, numpy quantiles and the textbook filter of imm_reference.py.
Runs are lists of samples; x is (N, n), u is (N, m).
"""
import numpy as np
import statsmodels.api as sm
from scipy.optimize import minimize
from scipy.stats import multivariate_normal

from imm_reference import run_filter, write

STAYS = (0.7, 0.8, 0.9, 0.95)


def simulate(rng, A, B, step_sd, samples, measurement_sd=0.0):
    """step_sd: (samples, n), the standard deviation of w at every step."""
    n, m = B.shape
    u = np.repeat(rng.uniform(-1, 1, size=(samples // 4 + 1, m)), 4, axis=0)[:samples]
    x = np.zeros((samples, n))
    for k in range(samples - 1):
        x[k + 1] = x[k] + A @ x[k] + B @ u[k] + step_sd[k] * rng.normal(size=n)
    return dict(x=x + measurement_sd * rng.normal(size=x.shape), u=u)


def stack(runs):
    """Regressors (N, n + m) and increments (N, n)."""
    return (np.concatenate([np.c_[r['x'][:-1], r['u'][:-1]] for r in runs]),
            np.concatenate([np.diff(r['x'], axis=0) for r in runs]))


# ---- baseline ------------------------------------------------------------------------------------------------------


def kalman_log_likelihood(theta, Q, R, runs):
    n = Q.shape[0]
    rows = theta.reshape(n, -1)
    F, B = np.eye(n) + rows[:, :n], rows[:, n:]
    total = 0.0
    for run in runs:
        x, P = run['x'][0], R
        for k in range(1, len(run['x'])):
            x, P = F @ x + B @ run['u'][k - 1], F @ P @ F.T + Q
            S = P + R
            e = run['x'][k] - x
            total += -0.5 * (n * np.log(2 * np.pi) + np.linalg.slogdet(S)[1] + e @ np.linalg.solve(S, e))
            G = P @ np.linalg.inv(S)
            x, P = x + G @ e, P - G @ S @ G.T
    return total


def maximum_likelihood(theta, runs, starts):
    n = runs[0]['x'].shape[1]
    rows, cols = np.tril_indices(n)

    def unpack(z):
        L = np.zeros((n, n))
        L[rows, cols] = z[:len(rows)]
        return L @ L.T, np.diag(np.exp(z[len(rows):]))

    cost = lambda z: -kalman_log_likelihood(theta, *unpack(z), runs)
    best = None
    for q_sd, r_sd in starts:
        z = np.concatenate([(q_sd * np.eye(n))[rows, cols], np.full(n, 2 * np.log(r_sd))])
        for _ in range(3 + 2 * n):  # restarts keep the simplex from collapsing early
            z = minimize(cost, z, method='Nelder-Mead',
                         options=dict(xatol=1e-9, fatol=1e-11, maxiter=6000, maxfev=6000)).x
        if best is None or cost(z) < cost(best):
            best = z
    Q, R = unpack(best)
    return dict(theta=theta, Q=Q, R=R, log_likelihood=float(-cost(best)))


def baseline_case(seed, A, B, q_sd, r_sd, lengths):
    rng = np.random.default_rng(seed)
    n = len(A)
    runs = [simulate(rng, A, B, np.full((N, n), q_sd), N, r_sd) for N in lengths]
    X, D = stack(runs)
    theta = np.linalg.lstsq(X, D, rcond=None)[0].T.ravel()
    return dict(runs=runs, **maximum_likelihood(theta, runs, [(q_sd, r_sd), (q_sd / 4, q_sd), (q_sd, q_sd / 100)]))


def baseline():
    scalar = baseline_case(3, np.array([[-0.4]]), np.array([[0.5, -0.3]]), 0.2, 0.1, (90, 70))
    vector = baseline_case(5, np.array([[-0.4, 0.1], [0.0, -0.6]]), np.array([[0.5], [0.3]]), 0.2, 0.15, (80, 70))
    write('learn_baseline.json', dict(scalar=scalar, vector=vector))


# ---- noise only ----------------------------------------------------------------------------------------------------


def noise_only_case(seed, A, B, R, lengths):
    rng = np.random.default_rng(seed)
    n, m = B.shape
    runs = []
    for N in lengths:
        loud = np.repeat(rng.uniform(size=N // 8 + 1) < 0.4, 8)[:N]
        runs.append(simulate(rng, A, B, np.where(loud, 0.4, 0.02)[:, None] * np.ones(n), N))
    X, D = stack(runs)
    # conv='coefs' with a tight tolerance: the default stops four digits earlier
    fits = [sm.RLM(D[:, i], X, M=sm.robust.norms.HuberT(1.345)).fit(conv='coefs', tol=1e-13, maxiter=2000)
            for i in range(n)]
    theta = np.array([f.params for f in fits])
    r = np.abs(D - X @ theta.T)
    variances = np.array([np.geomspace(np.quantile(r[:, i], 0.3) ** 2, np.quantile(r[:, i], 0.997) ** 2, 8)
                          for i in range(n)])
    modes = [dict(A=theta[:, :n], B=theta[:, n:], c=np.zeros(n), Q=np.diag(variances[:, j])) for j in range(8)]
    likelihood = []
    for stay in STAYS:
        T = np.full((8, 8), (1 - stay) / 7)
        np.fill_diagonal(T, stay)
        bank = dict(modes=modes, C=np.eye(n), R=R, T=T, pi=np.full(8, 1 / 8))
        likelihood.append(sum(np.nansum(run_filter(bank, r['u'].T, r['x'].T, 'imm')['log_density']) for r in runs))
    return dict(runs=runs, R=R, theta=theta.ravel(), standard_error=np.concatenate([f.bse for f in fits]),
                scale=np.array([f.scale for f in fits]), variances=variances, stays=STAYS,
                log_likelihood=likelihood, stay=STAYS[int(np.argmax(likelihood))])


def noise_only():
    write('learn_noise_only.json', dict(
        scalar=noise_only_case(21, np.array([[-0.4]]), np.array([[0.5, -0.3]]), np.array([[1e-6]]), (80, 57)),
        vector=noise_only_case(22, np.array([[-0.4, 0.1], [0.0, -0.6]]), np.array([[0.5], [0.3]]),
                               np.diag([1e-6, 4e-6]), (60, 50))))


if __name__ == '__main__':
    baseline()
    noise_only()
