"""Golden values for tests/mixture, independent of modebank: fits by scikit-learn's GaussianMixture, densities by mpmath
at 50 digits. scipy's logpdf only cross-checks the latter: with features of different units it is itself 5e-11 off.

Run:  /usr/bin/python3 tests/golden/generate/mixture.py > tests/golden/data/mixture.json
"""
import json
import sys
import warnings

import mpmath
import numpy as np
import scipy
import sklearn
from scipy.special import logsumexp
from scipy.stats import multivariate_normal
from sklearn.mixture import GaussianMixture

warnings.filterwarnings("ignore")
rng = np.random.default_rng(20250500)

WEIGHTS = np.array([0.5, 0.3, 0.2])
# Units differ strongly, as far as scipy still accepts the covariance as regular.
UNITS = np.array([1.0, 0.02, 10.0])
MEANS = np.array([[0.0, 0.0, 0.0], [3.0, 1.0, -2.0], [-2.0, 3.0, 1.5]]) * UNITS
SHAPES = [np.array([[1.0, 0.0, 0.0], [0.5, 0.8, 0.0], [-0.3, 0.2, 0.6]]),
          np.array([[0.6, 0.0, 0.0], [-0.4, 0.7, 0.0], [0.1, 0.3, 1.1]]),
          np.array([[0.9, 0.0, 0.0], [0.2, 0.5, 0.0], [0.4, -0.1, 0.7]])]
COVARIANCES = np.array([(UNITS[:, None] * s) @ (UNITS[:, None] * s).T for s in SHAPES])


def fit(points, start, kind, iterations):
    start_covariances = start["covariances"]
    precisions = (np.linalg.inv(start_covariances) if kind == "full"
                  else 1.0 / np.array([np.diag(c) for c in start_covariances]))
    model = GaussianMixture(len(start["weights"]), covariance_type=kind, tol=0.0, reg_covar=0.0, max_iter=iterations,
                            init_params="random", random_state=0, weights_init=start["weights"],
                            means_init=start["means"], precisions_init=precisions).fit(points)
    covariances = model.covariances_ if kind == "full" else np.array([np.diag(v) for v in model.covariances_])
    return {"covariance": kind, "iterations": iterations, "log_likelihood": model.score_samples(points).sum(),
            "weights": model.weights_, "means": model.means_, "covariances": covariances}


def joint_log_density(x, weight, mean, covariance):
    offset = mpmath.matrix([mpmath.mpf(a) - mpmath.mpf(b) for a, b in zip(x, mean)])
    shape = mpmath.matrix(covariance.tolist())
    distance = (offset.T * mpmath.lu_solve(shape, offset))[0]
    return mpmath.log(weight) - (distance + mpmath.log(mpmath.det(shape)) + len(mean) * mpmath.log(2 * mpmath.pi)) / 2


def densities(points):
    mpmath.mp.dps = 50
    log_density, responsibilities = [], []
    for x in points.tolist():
        joint = [joint_log_density(x, w, m, c) for w, m, c in zip(WEIGHTS.tolist(), MEANS.tolist(), COVARIANCES)]
        largest = max(joint)
        total = largest + mpmath.log(sum(mpmath.exp(j - largest) for j in joint))
        log_density.append(float(total))
        responsibilities.append([float(mpmath.exp(j - total)) for j in joint])
    by_scipy = logsumexp([np.log(w) + multivariate_normal(m, c).logpdf(points)
                          for w, m, c in zip(WEIGHTS, MEANS, COVARIANCES)], axis=0)
    np.testing.assert_allclose(log_density, by_scipy, rtol=1e-9)
    return np.array(log_density), np.array(responsibilities)


def plain(value):
    if isinstance(value, dict):
        return {k: plain(v) for k, v in value.items()}
    if isinstance(value, list):
        return [plain(v) for v in value]
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value


labels = rng.choice(3, size=300, p=WEIGHTS)
points = np.array([MEANS[k] + UNITS * (SHAPES[k] @ rng.standard_normal(3)) for k in labels])
start = {"weights": np.array([0.4, 0.3, 0.3]), "means": MEANS + 0.4 * UNITS,
         "covariances": np.array([np.diag(UNITS**2) * s for s in (1.5, 1.0, 0.8)])}
# The last three are 20, 1e3 and 1e6 standard deviations away.
probes = np.vstack([points[:20], UNITS * 20.0, UNITS * -1e3, UNITS * 1e6])
log_density, responsibilities = densities(probes)
json.dump(plain({
    "versions": {"scikit-learn": sklearn.__version__, "scipy": scipy.__version__, "numpy": np.__version__,
                 "mpmath": mpmath.__version__},
    "points": points,
    "start": start,
    "fits": [fit(points, start, kind, n) for kind in ("full", "diag") for n in (1, 7, 3000)],
    "density": {"weights": WEIGHTS, "means": MEANS, "covariances": COVARIANCES, "probes": probes,
                "log_density": log_density, "responsibilities": responsibilities},
}), sys.stdout)
