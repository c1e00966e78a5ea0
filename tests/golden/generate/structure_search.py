#!/usr/bin/python3
"""Left-out errors and scores of ARX structures, directly: numpy.linalg.lstsq of every fold, scipy for Student's t.

    /usr/bin/python3 tests/golden/generate/structure_search.py      writes structure_search.json into data/

Needs numpy and scipy. Seven runs of two states and one input; a run has a gap (one missing state). Rows are those whose
regressors are measured with the most lags (4 of the states, 3 of the input, delay 0 to 2); run r is left out with fold
r mod 5. Errors stand fold by fold. The score is the mean log density of a Student t per state, its scale by maximum
likelihood, its degrees of freedom the likeliest of 2, 4, 8, 30 and 1000.
"""
import json
import pathlib

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.stats import t as student

STATE_LAGS, INPUT_LAGS, DELAYS = 4, 3, (0, 2)
STRUCTURES = [(1, 1, 1), (3, 2, 2), (4, 3, 0), (2, 1, 1)]


def make_runs():
    rng = np.random.default_rng(3)
    runs = []
    for r in range(7):
        n = 40 + 3 * r
        y, u = np.zeros((n, 2)), np.repeat(rng.normal(size=(n // 3 + 1, 1)), 3, 0)[:n]
        for k in range(1, n - 1):
            noise = 0.05 * rng.standard_t(3, size=2)
            y[k + 1] = [[0.9, 0.1], [-0.2, 0.7]] @ y[k] - 0.2 * y[k - 1] + [0.3, -0.1] * u[k] + 0.2 + noise
        runs.append([y, u])
    runs[2][0][17, 1] = np.nan
    return runs


def rows_of(runs, structure):
    """Regressors, increments and folds of the common rows."""
    na, nb, delay = structure
    X, Y, F = [], [], []
    first = max(STATE_LAGS - 1, DELAYS[1] + INPUT_LAGS - 2)
    for r, (y, u) in enumerate(runs):
        for k in range(first, len(y) - 1):
            if np.isnan(y[k - STATE_LAGS + 1:k + 2]).any():
                continue
            X.append(np.concatenate([y[k - i] for i in range(na)] + [u[k + 1 - delay - j] for j in range(nb)] + [[1.0]]))
            Y.append(y[k + 1] - y[k])
            F.append(r % 5)
    return np.array(X), np.array(Y), np.array(F)


def log_density(e):
    best = None
    for nu in (2, 4, 8, 30, 1000):
        cost = lambda log_scale: -student.logpdf(e, nu, scale=np.exp(log_scale)).sum()
        at = minimize_scalar(cost, bounds=np.log(np.std(e)) + np.array([-6, 2]), method="bounded", options={"xatol": 1e-10})
        density = student.logpdf(e, nu, scale=np.exp(at.x))
        if best is None or density.sum() > best.sum():
            best = density
    return best


def main():
    runs = make_runs()
    cases = []
    for structure in STRUCTURES:
        X, Y, F = rows_of(runs, structure)
        errors, density = [], np.zeros(len(Y))
        for f in range(5):
            b = np.linalg.lstsq(X[F != f], Y[F != f], rcond=None)[0]
            errors.append(Y[F == f] - X[F == f] @ b)
        errors = np.concatenate(errors)
        for e in errors.T:
            density += log_density(e)
        cases.append({"structure": structure, "errors": errors.tolist(), "log_score": density.mean()})
    data = {
        "runs": [{"state": [[None if np.isnan(v) else v for v in row] for row in y], "input": u.tolist()} for y, u in runs],
        "cases": cases,
    }
    path = pathlib.Path(__file__).parent.parent / "data" / "structure_search.json"
    path.write_text(json.dumps(data) + "\n")


if __name__ == "__main__":
    main()
