#!/usr/bin/python3
"""Independent reference for the competitor `drifting` (method: section 6): its grid, its scores, its predictions ahead.

    /usr/bin/python3 tests/golden/generate/drifting.py FOLDER           writes drifting.json into data/
    /usr/bin/python3 tests/golden/generate/drifting.py FOLDER --dart    prints the DART table instead, writes nothing

FOLDER holds borealtc/ICE (and dart). ICE: imu wz interpolated to the pro times that lie inside the imu's span, inputs
velL and velR, even positions in name order train. DART: 10 Hz, states linear, inputs held, state yaw_rate, inputs
v*steer and speed; two folds by parity.

Written from the equations, in full form (y, not its increment) and with all (q, p0, leak) side by side:
    th[k] = th0 + leak (th[k-1] - th0) + w, cov(w) = q v I; at the first sample of a run th0 with covariance p0 v I
    e = y - th'h, g = 1 + h'Ph; density Student t of variance v g; then th, P; then v <- max(lam v + (1-lam) e^2/g, floor)
h steps ahead: coefficients of the origin leaked towards th0; from the second step on AR coefficients a_i / rho^i where
the largest root has modulus rho > 1 (th0 likewise); variance by the joint covariance of the errors of coefficients and
of lagged samples; times a factor of 2^(-4), 2^(-3.75), .. 2^8 that makes the training runs' errors most likely.
"""
import glob
import itertools
import json
import math
import os
import sys

import numpy as np

Q = (0.0, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1)
P0 = (0.0, 1e-2, 1e-1, 1.0, 10.0)
LEAK = (1.0, 0.97, 0.9)
LAM = (0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.92, 0.96)
NU = (0.0, 3.0, 5.0, 8.0, 15.0)
FLOOR = (1e-6, 1e-5, 1e-4, 1e-3)
FACTORS = [2.0 ** (i / 4) for i in range(-16, 33)]


# ---- data ----------------------------------------------------------------------------------------------------------


def read_ice(folder):
    """Runs (y, u) of the Husky on ice."""
    runs, times = [], []
    for pro in sorted(glob.glob(os.path.join(folder, "borealtc", "ICE", "pro_*.csv"))):
        p = np.genfromtxt(pro, delimiter=",", names=True)
        q = np.genfromtxt(pro.replace("pro_", "imu_"), delimiter=",", names=True)
        p = p[(p["time"] >= q["time"][0]) & (p["time"] <= q["time"][-1])]
        runs.append((np.interp(p["time"], q["time"], q["wz"]), np.c_[p["velL"], p["velR"]]))
        times.append(p["time"])
    period = np.median(np.concatenate([np.diff(t) for t in times[0::2]]))
    assert max(np.diff(t).max() for t in times) < 1.25 * period, "no sample is more than one step from the one before"
    return runs


def read_dart(folder):
    """Runs (y, [v*steer, speed]) at 10 Hz; a hole of more than five sample periods ends one and starts another."""
    runs = []
    for path in sorted(glob.glob(os.path.join(folder, "dart", "*.csv"))):
        d = np.genfromtxt(path, delimiter=",", names=True)
        parts = []
        for rows in np.split(np.arange(len(d)), np.flatnonzero(np.diff(d["time"]) > 0.05) + 1):
            t0 = d["time"][rows]
            t = t0[0] + 0.1 * np.arange(int((t0[-1] - t0[0]) / 0.1 + 1e-9) + 1)
            held = rows[np.searchsorted(t0, t + 1e-9, side="right") - 1]
            speed = d["speed"][held]
            parts.append((np.interp(t, t0, d["yaw_rate"][rows]), np.c_[speed * d["steering"][held], speed]))
        runs.append(parts)
    return runs


def regressors(run, na, nb, delay):
    """h of every sample that has all its lags: y[k-1].., u[k-delay].. ; and y, and the first such sample."""
    y, u = run
    first = max(na, delay + nb - 1)
    h = np.array([np.r_[[y[k - i] for i in range(1, na + 1)], np.concatenate([u[k - delay - j] for j in range(nb)])]
                  for k in range(first, len(y))])
    return h, y[first:], first


# ---- the filter, for many (q, p0, leak) at once ----------------------------------------------------------------------


def drift(th0, h, y, q, p0, leak):
    """e and g of every sample, and th, P after it: rows of q, p0, leak side by side."""
    C, r, N = len(q), len(th0), len(y)
    th, P = np.tile(th0, (C, 1)), p0[:, None, None] * np.eye(r)
    e, g = np.empty((C, N)), np.empty((C, N))
    after = []
    for k in range(N):
        if k > 0:
            th = th0 + leak[:, None] * (th - th0)
            P = leak[:, None, None] ** 2 * P + q[:, None, None] * np.eye(r)
        Ph = P @ h[k]
        g[:, k] = 1 + Ph @ h[k]
        e[:, k] = y[k] - th @ h[k]
        th = th + (e[:, k] / g[:, k])[:, None] * Ph
        P = P - Ph[:, :, None] * Ph[:, None, :] / g[:, k][:, None, None]
        if C == 1:
            after.append((th[0].copy(), P[0].copy()))
    return e, g, after


def variances(e, g, v0, lam, floor):
    """v before every sample, and after the last."""
    v = np.empty(np.broadcast_shapes(e.shape[:-1] + (1,), lam.shape, floor.shape)[:-1] + (e.shape[-1] + 1,))
    v[..., 0] = v0
    for k in range(e.shape[-1]):
        v[..., k + 1] = np.maximum(lam[..., 0] * v[..., k] + (1 - lam[..., 0]) * e[..., k] ** 2 / g[..., k],
                                   floor[..., 0])
    return v


def log_density(e, variance, nu):
    if nu == 0:
        return -0.5 * (np.log(2 * np.pi * variance) + e ** 2 / variance)
    scale2 = variance * (nu - 2) / nu
    return (math.lgamma((nu + 1) / 2) - math.lgamma(nu / 2) - 0.5 * np.log(nu * np.pi * scale2)
            - (nu + 1) / 2 * np.log(1 + e ** 2 / (nu * scale2)))


class Fold:
    def __init__(self, train, test, na, nb, delay):
        self.na, self.nb, self.delay = na, nb, delay
        self.train, self.test = train, test
        H, Y = zip(*[regressors(run, na, nb, delay)[:2] for run in train])
        H, Y = np.concatenate(H), np.concatenate(Y)
        physical = np.linalg.lstsq(H, Y, rcond=None)[0]
        self.v0 = np.mean((Y - H @ physical) ** 2)
        self.scale = np.sqrt(np.mean(H ** 2, axis=0))
        self.th0 = physical * self.scale
        self.physical = physical
        self.samples = len(Y)

    def regressors(self, run):
        h, y, first = regressors(run, self.na, self.nb, self.delay)
        # A run starts at the first sample whose lags are complete, and is scored from the next one on.
        return h / self.scale, y, first

    def grid(self):
        """The training score of every point, in the order q, p0, leak, lam, nu, floor."""
        q, p0, leak = np.array(list(itertools.product(Q, P0, LEAK))).T
        lam, floor = np.array(LAM)[None, :, None, None], np.array(FLOOR)[None, None, :, None] * self.v0
        total = np.zeros((len(q), len(LAM), len(NU), len(FLOOR)))
        for run in self.train:
            h, y, _ = self.regressors(run)
            e, g, _ = drift(self.th0, h, y, q, p0, leak)
            e, g = e[:, None, None, :], g[:, None, None, :]
            v = variances(e, g, self.v0, lam, floor)[..., :-1]
            for i, nu in enumerate(NU):
                total[:, :, i, :] += log_density(e, v * g, nu).sum(-1)
        return (total / self.samples).reshape(-1)

    def one_step(self, runs, point):
        q, p0, leak, lam, nu, floor = point
        score, square, N, per_run = 0.0, 0.0, 0, []
        for run in runs:
            h, y, first = self.regressors(run)
            e, g, after = drift(self.th0, h, y, np.array([q]), np.array([p0]), np.array([leak]))
            v = variances(e[0], g[0], self.v0, np.array([lam]), np.array([floor * self.v0]))
            score += log_density(e[0], v[:-1] * g[0], nu).sum()
            square += (e ** 2).sum()
            N += len(y)
            per_run.append((first, after, v))
        return score / N, math.sqrt(square / N), N, per_run

    # ---- h samples ahead ----

    def contracted(self, th):
        a = th[:self.na] / self.scale[:self.na]
        rho = np.abs(np.roots(np.r_[1, -a])).max()
        if not rho > 1:
            return th
        return np.r_[a / rho ** np.arange(1, self.na + 1) * self.scale[:self.na], th[self.na:]]

    def ahead(self, run, filtered, k, point, steps):
        """Errors and variances 1 .. steps samples after sample k (-1 + first: the start), as far as the run goes."""
        q, p0, leak = point[:3]
        y, u = run
        first, after, v = filtered
        start = k == first - 1
        th, P = (self.th0, p0 * np.eye(len(self.th0))) if start else after[k - first]
        v = v[k - first + 1]
        past = [y[k - i] for i in range(self.na)]
        r, na = len(th), self.na
        base, stable = self.th0, self.contracted(self.th0)
        J = np.zeros((r + na, r + na))  # covariance of the errors of th and of the lagged samples
        J[:r, :r] = v * P
        errors, S = [], []
        for j in range(1, min(steps, len(y) - 1 - k) + 1):
            if not (start and j == 1):
                th = base + leak * (th - base)
                J[:r, :] *= leak
                J[:, :r] *= leak
                J[:r, :r] += q * v * np.eye(r)
            if j == 2:
                th, base = self.contracted(th), stable
            n = k + j
            h = np.r_[past, np.concatenate([u[n - self.delay - i] for i in range(self.nb)])] / self.scale
            row = np.r_[h, th[:na] / self.scale[:na]]
            F = np.zeros((r + na, r + na))
            F[:r, :r] = np.eye(r)
            F[r] = row
            F[r + 1:, r:-1] = np.eye(na - 1)
            J = F @ J @ F.T
            J[r, r] += v
            past = [th @ h] + past[:-1]
            errors.append(y[n] - past[0])
            S.append(J[r, r])
        return errors, S

    def horizons(self, runs, point, wanted):
        """Per horizon: errors and variances of all samples of all runs."""
        found = {w: [] for w in wanted}
        for run, filtered in zip(runs, self.one_step(runs, point)[3]):
            for k in range(filtered[0] - 1, len(run[0]) - 1):
                errors, S = self.ahead(run, filtered, k, point, max(wanted))
                for w in wanted:
                    if w <= len(errors):
                        found[w].append((errors[w - 1], S[w - 1]))
        return {w: np.array(x).T for w, x in found.items()}

    def factors(self, point, wanted):
        """The nearest to 1 of equally good ones."""
        nearest_first = sorted(FACTORS, key=lambda f: (abs(math.log(f)), -f))
        result = {}
        for w, (e, S) in self.horizons(self.train, point, wanted).items():
            scores = [log_density(e, f * S, point[4]).sum() for f in nearest_first]
            result[w] = 1.0 if w == 1 else nearest_first[int(np.argmax(scores))]
        return result


def points():
    return list(itertools.product(Q, P0, LEAK, LAM, NU, FLOOR))


def evaluate(fold, wanted):
    scores = fold.grid()
    best = int(np.argmax(scores))
    point = points()[best]
    factors = fold.factors(point, wanted)
    result = dict(theta0=fold.physical, scale=fold.scale, v0=fold.v0, samples=fold.samples, best=best, point=point,
                  log_score=scores[best], others=[[i, scores[i]] for i in range(0, len(scores), 281)])
    score, rmse, N, _ = fold.one_step(fold.test, point)
    result['test'] = dict(samples=N, log_score=score, rmse=rmse, horizons=[])
    for w, (e, S) in fold.horizons(fold.test, point, wanted).items():
        result['test']['horizons'].append(dict(horizon=w, factor=factors[w], samples=len(e),
                                               log_score=log_density(e, factors[w] * S, point[4]).mean(),
                                               rmse=np.sqrt((e ** 2).mean())))
    return result


def plain(value):
    if isinstance(value, dict):
        return {k: plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(v) for v in value]
    return value.item() if isinstance(value, np.generic) else value


def main():
    folder = sys.argv[1]
    if '--dart' in sys.argv:
        runs = read_dart(folder)
        for name, a, b in (('A', runs[0::2], runs[1::2]), ('B', runs[1::2], runs[0::2])):
            train, test = sum(a, []), sum(b, [])
            result = evaluate(Fold(train, test, 2, 2, 0), [1, 10])
            print(name, json.dumps(plain({k: v for k, v in result.items() if k != 'others'}), indent=1))
        return
    runs = read_ice(folder)
    result = {name: evaluate(Fold(runs[0::2], runs[1::2], na, nb, 1), [1, 2, 10])
              for name, na, nb in (('linear', 1, 1), ('varx', 2, 2))}
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'data', 'drifting.json')
    with open(path, 'w') as f:
        json.dump(plain(result), f, indent=1)
        f.write('\n')


if __name__ == '__main__':
    main()
