#!/usr/bin/python3
"""Independent interacting multiple model filter in numpy, and the golden files it writes.

    /usr/bin/python3 tests/golden/generate/imm_reference.py

writes the JSON files that its last lines name into data/. Written from the textbook (Bar-Shalom, Li & Kirubarajan
2001, section 11.6.6) in the linear domain with explicit inverses and scipy's multivariate normal; signals that are
missing are left out of C, R and y. The filter that prints eq. 12-18 of Salvi et al. (2025) follows the paper. Nothing
here is shared with the C++ code.
"""
import json
import pathlib

import numpy as np
from scipy.stats import chi2, multivariate_normal, norm

FLOOR = 1e-12  # mode probabilities, then renormalised
FOLDER = pathlib.Path(__file__).parent.parent / "data"


def random_bank(rng, n, m, n_y, K, C=None):
    modes = []
    for j in range(K):
        G = rng.normal(size=(n, n))
        modes.append(dict(
            A=(-0.3 * np.eye(n) + 0.08 * rng.normal(size=(n, n))),
            B=0.3 * rng.normal(size=(n, m)),
            c=0.02 * rng.normal(size=n),
            Q=10.0 ** (-4 + j) * (np.eye(n) + 0.2 * G @ G.T),
        ))
    H = rng.normal(size=(n_y, n_y))
    T = np.full((K, K), 0.0)
    for i in range(K):
        row = rng.uniform(0.01, 0.1, size=K)
        row[i] = 0.9
        T[i] = row / row.sum()
    pi = rng.uniform(0.2, 1.0, size=K)
    return dict(modes=modes, C=np.eye(n) if C is None else C, R=1e-4 * (np.eye(n_y) + 0.3 * H @ H.T), T=T,
                pi=pi / pi.sum())


def simulate(rng, bank, N, m):
    n = bank['modes'][0]['A'].shape[0]
    u = rng.uniform(-0.5, 0.5, size=(m, N))
    x = np.zeros((n, N))
    s = 0
    for k in range(1, N):
        s = rng.choice(len(bank['modes']), p=bank['T'][s])
        M = bank['modes'][s]
        x[:, k] = x[:, k - 1] + M['A'] @ x[:, k - 1] + M['B'] @ u[:, k - 1] + M['c'] \
            + rng.multivariate_normal(np.zeros(n), M['Q'])
    y = bank['C'] @ x + rng.multivariate_normal(np.zeros(len(bank['R'])), bank['R'], size=N).T
    return u, y


def start(bank, y0):
    """x = C+ y, P = C+ R C+'; what C does not see is 1e4 times the largest variance of Q and R wide."""
    C, R = bank['C'], bank['R']
    n = C.shape[1]
    P_inv = np.linalg.pinv(C)
    P = P_inv @ R @ P_inv.T
    if C.shape[0] < n:
        widest = max([R.diagonal().max()] + [M['Q'].diagonal().max() for M in bank['modes']])
        P = P + 1e4 * widest * (np.eye(n) - P_inv @ C)
    return P_inv @ y0, P


def rosenblatt(weights, means, covariances, y):
    """Conditional distribution functions of y_i given y_1..y_(i-1) of a Gaussian mixture, by conditioning each
    component with the textbook formula (no factorisation)."""
    pit = []
    w = np.array(weights)
    for i in range(len(y)):
        values = []
        for mean, S in zip(means, covariances):
            if i == 0:
                mu, var = mean[0], S[0, 0]
            else:
                gain = S[i, :i] @ np.linalg.inv(S[:i, :i])
                mu = mean[i] + gain @ (y[:i] - mean[:i])
                var = S[i, i] - gain @ S[:i, i]
            values.append((mu, var))
        pit.append(sum(wj * norm.cdf(y[i], mu, np.sqrt(var)) for wj, (mu, var) in zip(w, values)))
        w = w * np.array([norm.pdf(y[i], mu, np.sqrt(var)) for mu, var in values])
        w = w / w.sum()
    return pit


def floored(mu):
    mu = np.maximum(mu, FLOOR)
    return mu / mu.sum()


def run_filter(bank, u, y, variant):
    K, C, R, T = len(bank['modes']), bank['C'], bank['R'], bank['T']
    n, N, n_y = C.shape[1], y.shape[1], y.shape[0]
    x0, P0 = start(bank, y[:, 0])
    x, P, mu = [x0] * K, [P0] * K, floored(bank['pi'])
    nan = np.full
    out = dict(prediction=nan((N, n), np.nan), innovation=nan((N, n_y), np.nan),
               innovation_covariance=nan((N, n_y, n_y), np.nan), state=nan((N, n), np.nan),
               covariance=nan((N, n, n), np.nan), nis=nan(N, np.nan), pit=nan((N, n_y), np.nan),
               log_density=nan(N, np.nan), predicted=nan((N, K), np.nan), mu=nan((N, K), np.nan))
    out['state'][0], out['covariance'][0], out['predicted'][0], out['mu'][0] = x0, P0, mu, mu
    for k in range(1, N):
        # start of each mode
        if variant == 'imm':
            c = T.T @ mu
            W = T * mu[:, None] / c[None, :]
        else:  # as printed: sum_i mu_i T_ij (...), no division; scores weigh with w(k-1)
            c, W = mu.copy(), T * mu[:, None]
        xm = [sum(W[i, j] * x[i] for i in range(K)) for j in range(K)]
        Pm = [sum(W[i, j] * (P[i] + np.outer(x[i] - xm[j], x[i] - xm[j])) for i in range(K)) for j in range(K)]
        # prediction of each mode
        xp, Pp, S = [], [], []
        for j, M in enumerate(bank['modes']):
            F = np.eye(n) + M['A']
            xp.append(F @ xm[j] + M['B'] @ u[:, k - 1] + M['c'])
            Pp.append(F @ Pm[j] @ F.T + M['Q'])
            S.append(C @ Pp[j] @ C.T + R)
        xc = sum(c[j] * xp[j] for j in range(K))
        Sc = sum(c[j] * (S[j] + np.outer(C @ (xp[j] - xc), C @ (xp[j] - xc))) for j in range(K))
        out['prediction'][k], out['innovation_covariance'][k], out['predicted'][k] = xc, Sc, c
        m = ~np.isnan(y[:, k])  # signals that are not missing
        if not m.any():
            x, P, mu = xp, Pp, floored(c)
        else:
            Cm, z, Sm = C[m], y[m, k], [s[np.ix_(m, m)] for s in S]
            L = np.array([multivariate_normal.pdf(z, Cm @ xp[j], Sm[j]) for j in range(K)])
            e = z - Cm @ xc
            out['innovation'][k, m], out['nis'][k] = e, e @ np.linalg.inv(Sc[np.ix_(m, m)]) @ e
            out['log_density'][k] = np.log(c @ L)
            out['pit'][k, m] = rosenblatt(c, [Cm @ v for v in xp], Sm, z)
            x, P = [], []
            for j in range(K):
                G = Pp[j] @ Cm.T @ np.linalg.inv(Sm[j])
                x.append(xp[j] + G @ (z - Cm @ xp[j]))
                P.append(Pp[j] - G @ Sm[j] @ G.T)
            if variant == 'salvi2025':
                L = np.array([multivariate_normal.pdf(Cm @ x[j] - z, np.zeros(m.sum()), Sm[j]) for j in range(K)])
            mu = floored(L * c / (L @ c))
        xs = sum(mu[j] * x[j] for j in range(K))
        out['state'][k], out['mu'][k] = xs, mu
        out['covariance'][k] = sum(mu[j] * (P[j] + np.outer(x[j] - xs, x[j] - xs)) for j in range(K))
    return out


def listed(value):
    """Nested lists with None for NaN, so that the file is plain JSON."""
    if isinstance(value, dict):
        return {k: listed(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [listed(v) for v in value]
    if isinstance(value, np.ndarray):
        return listed(value.tolist())
    return None if isinstance(value, float) and np.isnan(value) else value


def write(name, content):
    (FOLDER / name).write_text(json.dumps(listed(content)) + '\n')


def case(name, seed, n, m, n_y, K, variant, N=40, C=None, missing=()):
    rng = np.random.default_rng(seed)
    bank = random_bank(rng, n, m, n_y, K, C)
    u, y = simulate(rng, bank, N, m)
    for entry in missing:  # a sample (its first signal), or a sample and its signals
        k, signals = entry if isinstance(entry, tuple) else (entry, [0])
        y[signals, k] = np.nan
    out = run_filter(bank, u, y, variant)
    write(name, dict(variant=variant, bank=bank, input=u.T, measurement=y.T, expected=out))


def scores():
    write('scores.json', dict(
        chi_square=[dict(p=q, dof=d, value=float(chi2.ppf(q, d))) for d in (1, 2, 3, 7) for q in (0.025, 0.975)],
        normal_score=[dict(pit=q, z=float(norm.ppf(q))) for q in (1e-15, 1e-6, 0.025, 0.5, 0.9, 0.999999)]))


if __name__ == '__main__':
    case('imm_scalar.json', 1, 1, 2, 1, 3, 'imm')
    case('imm_vector.json', 2, 2, 1, 2, 2, 'imm')
    case('imm_partial.json', 3, 2, 1, 1, 2, 'imm', C=np.array([[1.0, 0.0]]))
    case('imm_missing.json', 4, 1, 2, 1, 3, 'imm', missing=(5, 6, 7, 20, 39))
    gaps = ((4, [1]), (9, [0, 2]), (10, [0, 1, 2]), (11, [0, 1, 2]), (12, [2]), (39, [0]))
    case('imm_three.json', 9, 3, 2, 3, 3, 'imm', missing=gaps)
    case('salvi2025_scalar.json', 7, 1, 2, 1, 3, 'salvi2025')
    case('salvi2025_vector.json', 8, 2, 1, 2, 2, 'salvi2025')
    case('salvi2025_three.json', 9, 3, 2, 3, 3, 'salvi2025', missing=gaps)
    scores()
