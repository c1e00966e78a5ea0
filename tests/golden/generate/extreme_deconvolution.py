#!/usr/bin/env python3
"""Extreme deconvolution (Bovy, Hogg & Roweis 2011, Ann. Appl. Stat. 5, 1657) written from the paper's equations in numpy,
and scipy's Cholesky solver; nothing of modebank enters. Writes extreme_deconvolution.json:
    extreme_deconvolution.py > extreme_deconvolution.json"""
import json
import sys

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.special import logsumexp

rng = np.random.default_rng(20110601)
N, F = 150, 3
UNITS = np.array([0.02, 1.0, 10.0])


def log_normal(x, mean, covariance):
    factor = cho_factor(covariance, lower=True)
    offset = x - mean
    log_determinant = 2.0 * np.log(np.diag(factor[0])).sum()
    return -0.5 * (offset @ cho_solve(factor, offset) + log_determinant + F * np.log(2.0 * np.pi))


def e_step(points, errors, weights, means, covariances):
    """Equations 9 and 15: log densities, responsibilities, expectations b_ij and covariances B_ij of the true values."""
    K = len(weights)
    log_joint = np.array([[np.log(weights[j]) + log_normal(w, means[j], covariances[j] + S)
                           for j in range(K)] for w, S in zip(points, errors)])
    log_density = logsumexp(log_joint, axis=1)
    q = np.exp(log_joint - log_density[:, None])
    b, B = np.empty((len(points), K, F)), np.empty((len(points), K, F, F))
    for i, (w, S) in enumerate(zip(points, errors)):
        for j in range(K):
            gain = cho_solve(cho_factor(covariances[j] + S, lower=True), covariances[j]).T
            b[i, j] = means[j] + gain @ (w - means[j])
            B[i, j] = covariances[j] - gain @ covariances[j]
    return log_density, q, b, B


def m_step(q, b, B, importance, kind):
    """Equation 16, each point counted `importance` times."""
    q = q * importance[:, None]
    mass = q.sum(axis=0)
    means = np.einsum("ij,ijf->jf", q, b) / mass[:, None]
    offset = means[None] - b
    covariances = np.einsum("ij,ijfg->jfg", q, offset[..., :, None] * offset[..., None, :] + B) / mass[:, None, None]
    if kind == "diagonal":
        covariances = np.array([np.diag(np.diag(c)) for c in covariances])
    return mass / importance.sum(), means, covariances


def fit(points, errors, importance, start, kind, iterations):
    weights, means, covariances = start["weights"], start["means"], start["covariances"]
    for _ in range(iterations):
        _, q, b, B = e_step(points, errors, weights, means, covariances)
        weights, means, covariances = m_step(q, b, B, importance, kind)
    log_density = e_step(points, errors, weights, means, covariances)[0]
    return {"covariance": kind, "iterations": iterations, "log_likelihood": float(importance @ log_density),
            "weights": weights.tolist(), "means": means.tolist(), "covariances": covariances.tolist()}


def random_covariance(scale):
    A = rng.standard_normal((F, F)) * scale
    return A @ A.T


truth_means = np.array([[0.0, 0.0, 0.0], [3.0, 2.0, -2.0], [-2.0, 4.0, 1.0]])
shapes = [np.linalg.cholesky(random_covariance(0.5) + 0.1 * np.eye(F)) for _ in range(3)]
labels = rng.choice(3, size=N, p=[0.5, 0.3, 0.2])
# Every fifth point is exact. The others' errors are 0.1 to 3 times the components' standard deviations, and some points have one unknown
# direction.
errors = np.array([np.zeros((F, F)) if i % 5 == 0 else random_covariance(10 ** rng.uniform(-1, 0.5)) for i in range(N)])
direction = np.array([1.0, -1.0, 0.5]) / 1.5
errors[3::17] += 1e5 * np.outer(direction, direction)
points = np.array([truth_means[k] + shapes[k] @ rng.standard_normal(F) + rng.multivariate_normal(np.zeros(F), S)
                   for k, S in zip(labels, errors)])
# The value along an unknown direction does not matter, but should keep the cloud's scale.
points[3::17] -= np.outer(points[3::17] @ direction, direction)
points, errors = points * UNITS, errors * np.outer(UNITS, UNITS)
importance = 0.5 + rng.random(N)
start = {"weights": np.array([0.4, 0.3, 0.3]), "means": (truth_means + 0.5) * UNITS,
         "covariances": np.array([np.diag(UNITS**2) * s for s in (1.5, 1.0, 0.8)])}
json.dump({"versions": {"numpy": np.__version__}, "points": points.tolist(), "importance": importance.tolist(),
           "errors": errors.reshape(N, -1).tolist(),
           "start": {key: value.tolist() for key, value in start.items()},
           "fits": [fit(points, errors, importance, start, kind, n) for kind in ("full", "diagonal") for n in (1, 10, 300)]},
          sys.stdout)
