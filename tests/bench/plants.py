#!/usr/bin/env python3
"""Simulated plants with known truth: how often the linear stage of `modebank run`, or all of it, is right.

  plants.py PROGRAM [--logs 400] [--seed 1] [--motions 1] [--folder build/plants] [--jobs N]
  plants.py PROGRAM --whole [GROUP...] [--logs 60] [the same]    the whole program by default options; goes on
  plants.py --folder FOLDER [the same]      writes run_*.csv, log.ini and truth.json of each log, and runs nothing

--motions: at most so many. truth.json: gains, 63 % times (dead time included), of one motion their Cramer-Rao errors,
R, Q, delays, held-out nats per sample of the true filter and of one motion. A bound fails where a count so far off
has a probability below 1 %; then the exit status is 1. Without h5py or scipy it is 77.

--whole: of N logs two thirds have `one` motion, a third `several`; beside these the level of N / 6 is a `walk`, and
N / 3 of two motions are logged at three `rates`, 10, 50, 200 Hz. Logs of several motions are drawn until so many are
findable (at 10 Hz): each motion acts in 5 % of the samples, and the true filter gains twice the program's limit over
one motion (the best, or their mean, with noise levels) in training and passes the paired t-test held out.
"""
import argparse
import concurrent.futures
import functools
import hashlib
import json
import pathlib
import re
import subprocess
import sys
import time

try:
    import h5py
    import numpy as np
    from scipy.linalg import block_diag, expm, solve_discrete_are
    from scipy.stats import binom, ttest_1samp
    from switching_system import filtered, half_deviance, response, signal, write_tables
except ImportError as missing:
    print(f"SKIPPED: Python has no module {missing.name}")
    sys.exit(77)

TEST_RUNS, WARM = 2, 40  # the first samples of a run are not scored; all times before truth.json are in samples
BOUNDS = {"95 % interval covers the gain": (.90, .98), "95 % interval covers the time": (.90, .98), "pairs": (.90, 1),
          "pairs, level wanders": (.80, 1), "pairs, loops": (.90, 1), "R inside its interval": (.85, 1),
          "R within 25 % where R >= Q": (.95, 1), "order": (.95, 1), "true delay loses under 2 nats": (.95, 1),
          "delay: first order, held or PRBS": (.95, 1), "refused: open loops": (0, .01),
          "refused: set point moves": (0, .01), "refused: set point rests": (.90, 1),
          "whole program fails": (0, .01), "enough findable logs": (1, 1), "not findable: a wrong number": (0, 0),
          # of 40 at most 2; of 20 at least 18 and 17; of 10 at least 8: else the probability is below 1 %
          "one motion: claimed or above 1": (0, .01), "findable: claimed": (.98, 1), "findable: number": (.96, 1),
          "findable, level walks: number": (.96, 1), "same answer at three rates": (.98, 1),
          "gain or time stated": (0, 1), "within 5 % or 2 errors": (.90, 1), "95 % interval covers": (.88, .98)}
# Share of --logs, and what draw_log is told.
GROUPS = {"one": (2 / 3, {"motions": 1}), "several": (1 / 3, {"motions": 3}),
          "walk": (1 / 6, {"motions": 3, "level": "wandering"}), "rates": (1 / 3, {"motions": 2, "dense": 20})}


def sampled(A, B, late):
    """F, G of x[k+1] = F x[k] + G[0] u[k-d] + G[1] u[k-d-1]: the older input acts in the first `late` of a sample."""
    M = [np.block([[A, b[:, None]], [np.zeros((1, len(A) + 1))]]) for b in B.T]
    newer, older = (np.array([expm(t * m) for t, m in zip(part, M)]) for part in (1 - late, late))
    return expm(A), np.array([newer[:, :-1, -1].T, (newer[:, :-1, :-1] @ older[:, :-1, -1:])[..., 0].T])


def draw_plant(g, loop, moves, motions, dense):
    """F, G by motion; what is read: C x; the covariance W, with which A(q) y = B(q) u + w has a w of unit variance.

    dense: simulated samples in one of `slow` and of the drawn dead time."""
    order, slow = g.choice(["first", "position", "two"], p=[1 / 2, 1 / 3, 1 / 6]), 6 * 15 ** g.random()  # log-uniform
    shares = [1, 0, 0] if order == "two" or motions > 1 else [.7, .2, .1] if loop else [.9, .1, 0]
    kind = g.choice(["stable", "integrating", "unstable"], p=shares)
    dead = g.choice([0, 0, 1, 2, 3, 5, 8, 12, 20, .5, 1.5, 4.5], g.choice([1, 1, 2]) if moves else 1)
    gains = .3 * 10 ** g.random((2, len(dead))) * g.choice([-1, 1], (2, len(dead)))
    pole = {"stable": -1 / slow, "integrating": 0., "unstable": 1 / slow}[kind]
    if order == "first":
        A, B = np.array([[pole]]), gains[:1] / slow
    elif order == "position":
        damping = .3 * (2 / .3) ** g.random()
        pair = -damping + np.emath.sqrt(damping ** 2 - 1) * np.array([1, -1])
        pair = pair / slow / -pair[0].real if kind == "stable" else np.array([pole, -3 / slow])
        A = np.array([[0, 1 / slow], [-pair.prod().real * slow, pair.sum().real]])
        B = np.array([0 * gains[0], gains[0] * abs(pair.prod() or pair[1] / slow) * slow])
    else:
        A = np.array([[-1, g.uniform(.1, .7)], [g.uniform(.1, .7) * g.choice([-1, 1]), -1 / g.uniform(.2, .8)]])
        A *= -1 / slow / np.linalg.eigvals(A).real.max()
        B = -A @ gains
    A, B, dead = A / dense, B / dense, dead * dense
    scales = list(zip([1, 2.2, .45], [1, g.uniform(.4, .7), g.uniform(1.4, 1.8)]))[:motions]
    F, G = (np.array(v) for v in zip(*[sampled(A / time, B * gain / time, dead % 1) for time, gain in scales]))
    W, C = np.eye(len(A)) + g.uniform(-.6, .6) * (1 - np.eye(len(A))), np.eye(1 + (order == "two"), len(A))
    if order == "position":  # a force that is white noise, over one sample
        M = expm(np.block([[-A, np.diag([0, 1])], [np.zeros((2, 2)), A.T]]))
        W, later = M[2:, 2:].T @ M[:2, 2:], np.array([-F[0, 1, 1], F[0, 0, 1]])
        W /= W[0, 0] + later @ W @ later
    return argparse.Namespace(order=order, kind=kind, slow=slow, gain=gains[0, 0], dead=dead, d=dead.astype(int), F=F,
                              G=G, W=W, C=C, moves=moves, law=None, control=None, dense=dense)


def draw_loop(g, p):
    """Gives the plant a controller whose loop settles within a few time constants; False after 40 that do not.

    (A, b, e, c, d, f): u = c z + d y + f r, then z = A z + b y + e r; y and r from the operating point on."""
    n, past, p.law = len(p.W), p.d[0] + 1, g.choice(["P", "PI", "observer"])  # states x, u[k-1], ..., u[k-past]
    F, B, C = block_diag(p.F[0], np.eye(past, k=-1)), np.eye(n + past, 1, -n), np.eye(len(p.C), n + past)
    for lag in range(2):
        (F[:n, n + p.d[0] + lag - 1] if p.d[0] + lag else B[:n, 0])[:] += p.G[0, lag, :, 0]
    W, Q = block_diag(p.W, np.zeros((past, past))) + 1e-9 * np.eye(n + past), C.T @ C + 1e-9 * np.eye(n + past)
    one, first, eye = np.eye(1), np.eye(1, len(C)), np.eye(n + past)
    for _ in range(40):
        size, slow = .3 * 20 ** g.random() / p.gain, p.slow / (.2 * 7.5 ** g.random())
        p.control = one * (p.law == "PI"), -first, one, size / slow * one * (p.law == "PI"), -size * first, size * one
        if p.law == "observer":
            R, weight = .1 * 200 ** g.random() * np.eye(len(C)), .1 * 100 ** g.random() * p.gain ** 2 * one
            P, X = solve_discrete_are(F.T, C.T, W, R), solve_discrete_are(F, B, Q, weight)
            L, K = np.linalg.solve(C @ P @ C.T + R, C @ P).T, np.linalg.solve(weight + B.T @ X @ B, B.T @ X @ F)
            moved, kept = F - B @ K, eye - L @ C
            N = one / (C[:1] @ np.linalg.solve(eye - moved, B))
            p.control = moved @ kept, moved @ L, B @ N, -K @ kept, -K @ L, N
        A, b, _, c, d, _ = p.control
        if abs(np.linalg.eigvals(np.block([[F + B @ d @ C, B @ c], [b @ C, A]]))).max() < np.exp(-.2 / p.slow):
            return True
    return False


def simulate(p, u, r, level, w, v, motion):
    """Readings (run, sample, reading) from the operating point on; a controller writes the first input into u."""
    A, b, e, c, d, f = p.control or [np.eye(1)] * 6
    x, z, y = np.zeros((len(u), len(p.W))), np.zeros((len(u), len(A))), 0 * v
    v, rest, F = v + level * (p.level_in == "sensor"), level @ p.C * (p.level_in == "equation"), p.F[motion]
    acting = [(p.G[motion, lag, :, i], i, p.d[i] + lag) for i, lag in np.ndindex(len(p.d), 2)]
    for k in range(u.shape[1]):
        y[:, k] = x @ p.C.T + v[:, k]
        if p.control:
            u[:, k, :1] = z @ c.T + y[:, k] @ d.T + r[:, k] @ f.T
            z = z @ A.T + y[:, k] @ b.T + r[:, k] @ e.T
        x = (F[:, k] @ (x - rest[:, k])[..., None])[..., 0] + rest[:, k] + w[:, k]
        for G, i, late in acting:
            if k >= late:
                x += G[:, k] * u[:, k - late, i, None]
    return y


def draw_log(g, loop, motions, level=None, dense=1):
    """A plant, and readings, inputs and set points of its runs from the operating point on."""
    moves, p = not loop or g.random() < .75, None
    while p is None or loop and not draw_loop(g, p):
        p = draw_plant(g, loop, moves, g.integers(min(2, motions), motions + 1), dense)
    p.logged, p.rounded, p.loud = loop and g.random() < .5, g.random() < .5, int(len(p.F) > 1 and g.random() < .4)
    p.rate_hz, p.train = round(10 * 20 ** g.random(), 1), g.choice([4, 5, 6, 8])
    p.ratio, p.level = g.choice([0, .25, 1, 10, 70]), level or g.choice(["fixed", "fixed", "by run", "wandering"])
    p.level_in, p.stay = g.choice(["equation", "sensor"]) if p.kind == "stable" else "sensor", max(120, 4 * p.slow)
    p.shape, low, high = [("held", .3, 2), ("PRBS", .1, .6), ("smooth", .1, .5)][g.integers(3)]
    before, most = int(3 * p.slow) + 25, 2000 if dense == 1 else 600
    N, before = before + int(np.clip(p.slow * g.uniform(10, 25), 400, most)), before * dense
    many = lambda *a: np.array([signal(g, *a, N) for _ in range(p.train + TEST_RUNS)]).repeat(dense, 1)  # noqa: E731
    *u, r = (many(p.shape, low * p.slow, high * p.slow)[..., None] for _ in range(len(p.d) + 1))
    motion, loud = (many(kinds, .6 * p.stay, 1.6 * p.stay) for kinds in (len(p.F), 1 + p.loud))
    y, u = readings(g, p, np.concatenate(u, 2), r, motion, 1 + 2 * loud[..., None], before)
    p.use = [(motion[:p.train, before:] == m).mean() for m in range(len(p.F))]
    p.rate_hz, p.offset = p.rate_hz if dense == 1 else 10 * dense, g.choice([0, 20, 101325, -40])
    return p, y[:, before:], u[:, before:], r[:, before:] * moves


def readings(g, p, u, r, motion, loud, before):
    """Noise and level as large as the response without them asks for, and what then is read."""
    still, force = np.zeros(u.shape[:2] + (len(p.C),)), np.zeros(u.shape[:2] + (len(p.W),))
    sd = lambda *a: np.sqrt(simulate(p, *a, motion)[:, before:].var(1).mean(0))  # noqa: E731
    p.response = sd(u.copy(), r, still, force, still)
    noise = p.response * .004 * 12.5 ** g.random()
    each = np.resize(noise / max(1, p.ratio) ** .5, len(p.W)) / p.dense ** (1.5 if p.order == "position" else .5)
    w = g.standard_normal(force.shape) @ np.linalg.cholesky(p.W).T * each * loud
    shrink = min(1, .4 / (sd(0 * u, 0 * r, still, w, still) / p.response).max())
    p.noise, p.W = noise * shrink, p.W * np.outer(each, each) * shrink ** 2
    p.R, p.Q = p.noise ** 2 * min(1, p.ratio), p.noise ** 2 / max(1, p.ratio)
    quantum = p.noise * g.uniform(.1, .2) if p.rounded else 1e-6 * p.response
    p.digits = -np.round(np.log10(quantum)).astype(int)
    p.unit = .1 ** p.digits / quantum  # in it the quantum is a power of ten
    p.step, by_run = p.noise * g.uniform(.1, .5) * (p.level == "wandering"), p.response / 2 * (p.level == "by run")
    p.step = p.step / p.dense ** .5
    p.start = by_run ** 2 + p.step ** 2 * before  # variance of the level at the start
    level = g.standard_normal(still.shape).cumsum(1) * p.step + g.standard_normal(still[:, :1].shape) * by_run
    y = simulate(p, u, r * p.moves, level, w * shrink, g.standard_normal(still.shape) * np.sqrt(p.R), motion)
    p.R = p.R + quantum ** 2 / 12
    return quantum * np.round(y / quantum), u


def thinned(p, every):
    """The plant as one that is logged with one sample of so many, through which inputs are held."""
    if every == 1:
        return p
    powers, q = np.array([np.linalg.matrix_power(p.F, k) for k in range(every + 1)]), argparse.Namespace(**vars(p))
    q.F, q.G, q.d = powers[every], np.zeros_like(p.G), p.d // every
    for i, newer in enumerate(every - p.d % every):
        for lag, part in enumerate((powers[:newer], powers[newer:every])):
            q.G[:, lag, :, i] = np.einsum("kmst,mt->ms", part, p.G[:, 0, :, i])
    q.W = np.einsum("kmst,tu,kmvu->msv", powers[:every], p.W, powers[:every])
    q.step, q.rate_hz = p.step * every ** .5, p.rate_hz / every
    return q


def kalman(p, many, y, u, chain=None):
    """What `filtered` answers of the samples that all inputs can reach, for many sets of parameters."""
    F, G, W, R, mean, step = (np.array([m[name] for m in many]) for name in many[0])
    n, eye, first, last = F.shape[1], np.eye(len(p.C)), p.d.max() + 2, u.shape[1]
    C = np.hstack([p.C, eye * (p.level_in == "sensor")])  # the levels are states, too
    A = np.array([block_diag(a, eye) for a in F])
    V = np.array([block_diag(a, b) for a, b in zip(W, step[:, :, None] * eye)])
    A[:, :n, n:] = (np.eye(n) - F) @ p.C.T * (p.level_in == "equation")
    P = np.diag([*np.resize(25 * p.response ** 2, n), *p.start]) * np.ones((len(F), 1, 1))
    x = np.hstack([np.zeros((len(F), n)), mean]) * np.ones((len(y), 1, 1))
    pushed = sum(u[:, first - d - lag:last - d - lag, i, None, None] * G[:, lag, :, i]
                 for i, d in enumerate(p.d) for lag in (0, 1))
    pushed = np.concatenate([pushed, np.zeros((*pushed.shape[:3], len(p.C)))], 3)
    return filtered(A, V, C, R, x, P, pushed, y[:, first:], chain)


def cramer_rao(p, true, y, u):
    """Gains, 63 % times, and their least errors from the innovations of the true filter; only the delays are known."""
    F, G = np.full(p.W.shape, 1e-3 / p.slow), abs(p.G[0]).max((0, 1)) / 1e3 * np.ones(p.G[0].shape)
    G[1] *= p.dead % 1 > 0
    if p.order == "position":  # the rest is the choice of the second state
        F[0] = G[1, 0] = 0
    sizes = {"F": F, "G": G, "R": p.R / 1e3, "mean": p.noise}
    nudges = [(name, v) for name, a in sizes.items() for v in np.eye(a.size).reshape(-1, *a.shape) * a if v.any()]
    nudges += [(name, true[name] / 1e3) for name in ("W", "step") if true[name].any()]
    many = [true] + [dict(true, **{name: true[name] + sign * v}) for name, v in nudges for sign in (1, -1)]
    (e, S, _), values = kalman(p, many, y, u), response(*(np.array([m[name] for m in many]) for name in "FG"), p.C, p.d)
    (gain, time), de = values, (e[:, :, 1::2] - e[:, :, 2::2]) / 2
    J = np.einsum("krai,kij,krbj->ab", de, np.linalg.inv(S[:, 0, 0]), de, optimize=True)
    size = np.sqrt(np.diag(J) + 1e-12 * np.trace(J))
    cov = np.linalg.pinv(J / np.outer(size, size), 1e-9, hermitian=True) / np.outer(size, size)
    slopes = [(value[1::2] - value[2::2]) / 2 for value in values]
    return gain[0], time[0], *(np.sqrt(np.einsum("a...,ab,b...->...", slope, cov, slope)) for slope in slopes)


def truth_of(p, y, u):
    """What is known of a log, in the units of its files, with the nats of true filters."""
    motions = [{"F": F, "G": G, "W": W, "R": p.R, "mean": 0 * p.R, "step": p.step ** 2}
               for F, G, W in zip(p.F, p.G, np.broadcast_to(p.W, p.F.shape))]
    leave = .9 / p.stay
    chain = lambda n: np.eye(n) * (1 - n * leave) + leave if n > 1 else np.eye(1)  # noqa: E731
    true = nats(p, motions, [1, 9][:1 + p.loud], np.kron(chain(len(motions)), chain(1 + p.loud)), y, u)
    names = "order kind law moves logged shape level level_in ratio rounded dead rate_hz slow train loud use".split()
    truth = dict({name: getattr(p, name) for name in names}, R=p.R * p.unit ** 2, Q=p.Q * p.unit ** 2,
                 input_delay=p.d + 1, state_lags=1 + (p.order == "position"), motions=len(motions), findable=p.moves)
    single = true
    if len(motions) > 1:
        motions.append({name: np.mean([m[name] for m in motions], 0) for name in motions[0]})
        singles = [nats(p, [m], [1, 9, 81, 729], chain(4), y, u) for m in motions]
        single = max(singles, key=lambda one: one[:, :p.train].sum())
        numbers = response(p.F, p.G, p.C, p.d)
        truth["findable"] = min(p.use) >= .05 and findable(true - single, p.train, numbers[1].min())
    elif p.kind == "stable":
        numbers = cramer_rao(p, motions[0], y[:p.train], u[:p.train])
    for name, density in (("nats_true_filter", true), ("nats_true_single", single)):
        truth[name] = density[:, p.train:].mean() - np.log(p.unit).sum()
    if p.kind == "stable":
        for name, value in zip(("gain", "time", "gain_error", "time_error"), numbers):
            truth[name] = value / p.rate_hz if "time" in name else value * p.unit[:, None]
    return {name: value.tolist() if hasattr(value, "tolist") else value for name, value in truth.items()}


def nats(p, motions, factors, chain, y, u):
    """Nats (sample, run) of the filter whose modes are motions times factors on their noise."""
    modes = [dict(m, W=m["W"] * factor) for m in motions for factor in factors]
    return kalman(p, modes, y, u, chain if len(modes) > 1 else None)[2][WARM:].reshape(-1, len(y))


def findable(gain, train, time63):
    """Whether gains (sample, run) reach twice the limit in training, and held out are told by blocks (filter/judge)."""
    if gain[:, :train].sum() < 2 * max(12, .02 * gain[:, :train].size / max(1, time63 / 10)):
        return False
    off, n = gain[:, train:] - gain[:, train:].mean(), len(gain)
    related = [(off[lag:] * off[:n - lag]).mean() / (off ** 2).mean() for lag in range(n // 4)] + [0]
    times = 2 * sum(related[:np.argmax(np.array(related) < .05)]) - 1  # of autocorrelation, and then with caution
    times = 1 + (times - 1) * (1 + ((8 * times + 2) / off.size) ** .5)
    parts = [part.mean() for run in gain[:, train:].T for part in np.array_split(run, max(1, int(n / (2 * times))))]
    return len(parts) >= 8 and bool(ttest_1samp(parts, 0, alternative="greater").pvalue < .025)


def write(folder, p, y, u, r):
    """The files of a log; a logged set point is a column beside."""
    states, inputs = [f"y{o}" for o in range(len(p.C))], [f"u{i}" for i in range(len(p.d))]
    times, logged = np.arange(y.shape[1])[:, None] / p.rate_hz + 0 * r, [r * p.unit[0] + p.offset] * p.logged
    form = ["%.9f"] + [f"%.{d}f" for d in p.digits] + ["%.12g"] * (len(inputs) + p.logged)
    write_tables(folder, "log.ini", np.concatenate([times, y * p.unit + p.offset, u] + logged, 2), form, states, inputs,
                 "train = " + ", ".join(f"{run:02d}" for run in range(p.train)), more=["setpoint"] * p.logged)


def one(options, number):
    """Writes the log of that number, and answers the bounds of the linear stage."""
    g, folder = np.random.default_rng([options.seed, number]), options.folder / f"log_{number:03d}"
    p, y, u, r = draw_log(g, number % 2 == 1, options.motions)
    truth, train = truth_of(p, y, u), (y[:p.train], u[:p.train])
    write(folder, p, y, u, r)
    (folder / "truth.json").write_text(json.dumps(truth, indent=1))
    return judged(truth, identify(options.program, folder, truth), *train) if options.program else []


def drawn(options, group, number):
    """The folders of a log, one for each rate, and its truth; drawn where it has not been."""
    g, how = np.random.default_rng([options.seed, list(GROUPS).index(group), number]), GROUPS[group][1]
    folder, thin = options.folder / f"whole_{options.seed}" / f"{group}_{number:03d}", how.get("dense", 1)
    folders = {every: folder / f"{200 // every}_hz" for every in (20, 4, 1)} if thin > 1 else {1: folder}
    if not (folder / "truth.json").exists():
        p, y, u, r = draw_log(g, group == "one" and number % 2 == 1, **how)
        for every, place in folders.items():
            write(place, thinned(p, every), y[:, ::every], u[:, ::every], r[:, ::every])
        truth = truth_of(thinned(p, thin), y[:, ::thin], u[:, ::thin])
        (folder / "truth.json").write_text(json.dumps(truth, indent=1))
    return list(folders.values()), json.loads((folder / "truth.json").read_text())


def started(program, folder, *words):
    """The finished program, on one thread, with its answer in out.h5."""
    command = [program.resolve(), "run", "log.ini", "--archive.output", "out.h5", "--force", "--job.threads", "1"]
    return subprocess.run(command + list(words), cwd=folder, capture_output=True, text=True, check=False)


def whole_answer(program, folder):
    """The whole program's answer about a log, its motions and their numbers; result.json keeps it."""
    kept, start = folder / "result.json", time.monotonic()
    mark = hashlib.sha256(program.read_bytes()).hexdigest()
    if kept.exists() and (folder / "out.h5").exists():
        said = json.loads(kept.read_text())
        if said["program"] == mark:
            return said
    done = started(program, folder)
    (folder / "screen.txt").write_text(done.stdout + done.stderr)
    said = {"program": mark, "status": done.returncode, "answer": "", "number": 0, "seconds": time.monotonic() - start}
    if done.returncode == 0:
        with h5py.File(folder / "out.h5") as file:
            said.update(motions_of(file), answer=file["evaluation/evidence"].attrs["answer"].decode())
    kept.write_text(json.dumps(said))
    print(folder, *list(said.values())[1:5], flush=True)
    return said


def motions_of(file):
    """Number of motions, without passages, and their numbers, from an archive."""
    bank = file["bank"]
    T, use = bank["transition"][:], np.nanmean(file["evaluation/bank/mode_probability"], 0)
    _, first, motion = np.unique(bank.get("motion", np.arange(len(T))), return_index=True, return_inverse=True)
    member = motion == np.arange(len(first))[:, None]
    leaving = (member * use @ T * ~member).sum(1) / (member @ use)
    said = {"number": (leaving <= 1 / 5).sum(), "use": member @ use}  # a stay under five samples is a passage
    none = np.full((len(T), 1, 1), np.nan)  # as of a bank with nonlinear terms
    for name, key in (("gain", "steady_gain"), ("time", "response_time_s")):
        said[name] = np.array(bank.get(key, none))[first]
        said[name + "_error"] = np.array(bank.get(key + "_standard_error", none))[first]
    return {name: value.tolist() for name, value in said.items()}


def judged_whole(options, group, log):
    """(name of a bound, right or not) of one log and the whole program."""
    truth, answers = log[1], [whole_answer(options.program, folder) for folder in log[0]]
    said, *_ = answers
    claimed, right = said["answer"] == "evidence", said["number"] == truth["motions"]
    out = [("whole program fails", said["status"] != 0) for said in answers]
    if group == "one":
        out += [("one motion: claimed or above 1", claimed or said["number"] > 1)]
    elif group == "rates":
        out += [("same answer at three rates", len({(said["answer"], said["number"]) for said in answers}) == 1)]
    elif not truth["findable"]:
        out += [("not findable: a wrong number", claimed and not right)]
    elif group == "walk":
        out += [("findable, level walks: number", right)]
    else:
        out += [("findable: claimed", claimed), ("findable: number", right)] 
        out += numbers_of(truth, said) if claimed else []
    return out


def numbers_of(truth, said):
    """Bounds of gains and 63 % times in motions used for 5 %, each against the nearest true motion."""
    out = []
    for i in np.flatnonzero(np.array(said["use"]) >= .05):
        off = [(name, abs(np.array(said[name][i]) - truth[name])) for name in ("gain", "time")]
        nearest = sum(np.nan_to_num(v / np.abs(truth[name]), nan=1).clip(0, 1).sum((1, 2)) for name, v in off).argmin()
        for name, missed in off:
            values = zip(missed[nearest].flat, np.ravel(said[name + "_error"][i]), np.ravel(truth[name][nearest]))
            for miss, error, true in values:
                out.append(("gain or time stated", stated := bool(np.isfinite(miss))))
                out += [("within 5 % or 2 errors", miss <= max(.05 * abs(true), 2 * error))] * stated
                out += [("95 % interval covers", miss <= 1.96 * error)] * stated
    return out


def whole(options, pool):
    """Draws each group until enough of its logs are findable, runs the program on them, and answers the bounds."""
    answers = []
    for group in options.whole or GROUPS:
        wanted, logs = max(1, round(GROUPS[group][0] * options.logs)), []
        while (missing := wanted - sum(truth["findable"] for _, truth in logs)) > 0 and len(logs) < 6 * wanted + 10:
            logs += pool.map(functools.partial(drawn, options, group), range(len(logs), len(logs) + missing))
        print(f"{group}: {wanted - missing} of {len(logs)} logs are findable", flush=True)
        answers.append(("enough findable logs", missing <= 0))
        judging = [log for log in logs if options.program and (log[1]["findable"] or group in ("several", "walk"))]
        answers += sum(pool.map(functools.partial(judged_whole, options, group), judging), [])
    return answers


def identify(program, folder, truth):
    """Whether the program refuses the log, or says that a law of y computes u; the numbers where it has a model."""
    few_windows = "--until", "windows", "--filter.variant", "kf", "--window.step", "1000"
    done = started(program, folder, *few_windows)
    law = re.search(r"(doubt|modebank:)\s+u0 [^:]*\s+in\s+every\s+sample,\s+so", done.stdout + done.stderr)
    said = {"refused": done.returncode != 0, "rests": law is not None}
    if said["refused"]:
        return said
    with h5py.File(folder / "out.h5") as file:
        if "baseline" not in file:
            return said
        base, structure, scores = file["baseline"], file["structure"].attrs, file["structure/scores"][:]
        errors, said["R"] = base.get("R_standard_error"), np.diag(np.atleast_2d(base["R"]))
        said["R_error"] = 0 * said["R"] if errors is None else np.diag(np.atleast_2d(errors))  # none without noise
        for name, key in (("gain", "steady_gain"), ("time", "response_time_s")):
            said[name], said[name + "_error"] = base[key][0], base[key + "_standard_error"][0]
        said["order"], = scores[scores["linear"] == 1]  # modes may take other lags
        of_truth = scores["log_score"][scores["state_lags"] == truth["state_lags"]]
        said["lost"] = structure["samples"] * (np.nanmax(of_truth, initial=-np.inf) - said["order"]["log_score"])
        said["input_delay"] = np.broadcast_to(structure["input_delay"], len(truth["input_delay"])).tolist()
    return said


def judged(truth, said, y, u):
    """(name of a bound, right or not) of one log."""
    if not truth["moves"]:
        return [("refused: set point rests", said["rests"])]
    out = [("refused: set point moves" if truth["law"] else "refused: open loops", said["refused"])]
    if "gain_error" not in truth:
        return out
    fitted = pairs = "R" in said
    for name in ("gain", "time") if fitted else ():
        off = abs(said[name] - truth[name])
        out += [(f"95 % interval covers the {name}", held) for held in (off <= 1.96 * said[name + "_error"]).flat]
        pairs &= (off <= np.maximum(.05 * np.abs(truth[name]), np.multiply(2, truth[name + "_error"]))).all()
    out += [("pairs" + ", level wanders" * (truth["level"] == "wandering"), pairs)]
    out += [("pairs, loops", pairs)] * bool(truth["law"])
    if not fitted:
        return out
    off, lags = abs(said["R"] - truth["R"]), said["order"]["state_lags"]
    delays = said["input_delay"], truth["input_delay"]
    out += [("R inside its interval", held) for held in off <= 1.96 * said["R_error"]]
    out += [("R within 25 % where R >= Q", close) for close in off <= .25 * np.array(truth["R"]) if truth["ratio"] >= 1]
    out += [("order", lags == truth["state_lags"] or lags < truth["state_lags"] and said["lost"] < 6)]
    if len(said["R"]) == 1:
        found, true = (half_deviance(y[..., 0], u, said["order"], d) for d in delays)
        out += [("true delay loses under 2 nats", delays[0] == delays[1] or true < found + 2)]
    if truth["order"] == "first" and truth["shape"] != "smooth" and not truth["law"]:
        out += [("delay: first order, held or PRBS", delays[0] == delays[1])]
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", type=pathlib.Path)
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("build/plants"))
    parser.add_argument("--whole", nargs="*", choices=GROUPS)
    for name, default in (("logs", None), ("seed", 1), ("motions", 1), ("jobs", None)):
        parser.add_argument("--" + name, type=int, default=default)
    options, good = parser.parse_args(), True
    options.logs = options.logs or (400 if options.whole is None else 60)
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        if options.whole is None:
            answers = sum(pool.map(one, [options] * options.logs, range(options.logs)), [])
        else:
            answers = whole(options, pool)
    for name, (low, high) in BOUNDS.items():
        got = [bool(right) for what, right in answers if what == name]
        right, n = sum(got), len(got)
        if n == 0:
            continue
        holds = binom.cdf(right, n, low) >= .01 and binom.sf(right - 1, n, high) >= .01
        good &= bool(holds)
        print(f"{name:34} {right:4} of {n:4} {100 * right / n:6.1f} % {low}-{high} {'' if holds else 'FAILS'}")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
