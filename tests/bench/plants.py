#!/usr/bin/env python3
"""Simulated plants with known truth, and how often the linear stage of `modebank run` is right about them.

  plants.py PROGRAM [--logs 400] [--seed 1] [--motions 1] [--folder build/plants] [--jobs N]
  plants.py --folder FOLDER [the same]      writes run_*.csv, log.ini and truth.json of each log, and runs nothing

--motions: at most so many. truth.json: gains, 63 % times (dead time included), their Cramer-Rao errors, R, Q, delays,
held-out nats per sample of the true filter and of the best true motion alone. A bound fails where a count so far off
has a probability below 1 %; then the exit status is 1. Without h5py or scipy it is 77.
"""
import argparse
import concurrent.futures
import json
import pathlib
import re
import subprocess
import sys

try:
    import h5py
    import numpy as np
    from scipy.linalg import block_diag, expm, solve_discrete_are
    from scipy.stats import binom
    from switching_system import filtered, half_deviance, response, signal
except ImportError as missing:
    print(f"SKIPPED: Python has no module {missing.name}")
    sys.exit(77)

TEST_RUNS, WARM = 2, 40  # the first samples of a run are not scored; all times before truth.json are in samples
BOUNDS = {"95 % interval covers the gain": (.90, .98), "95 % interval covers the time": (.90, .98), "pairs": (.90, 1),
          "pairs, level wanders": (.80, 1), "pairs, loops": (.90, 1), "R inside its interval": (.85, 1),
          "R within 25 % where R >= Q": (.95, 1), "order": (.95, 1), "true delay loses under 2 nats": (.95, 1),
          "delay: first order, held or PRBS": (.95, 1), "refused: open loops": (0, .01),
          "refused: set point moves": (0, .01), "refused: set point rests": (.90, 1)}


def sampled(A, B, late):
    """F, G of x[k+1] = F x[k] + G[0] u[k-d] + G[1] u[k-d-1]: the older input acts in the first `late` of a sample."""
    M = [np.block([[A, b[:, None]], [np.zeros((1, len(A) + 1))]]) for b in B.T]
    newer, older = (np.array([expm(t * m) for t, m in zip(part, M)]) for part in (1 - late, late))
    return expm(A), np.array([newer[:, :-1, -1].T, (newer[:, :-1, :-1] @ older[:, :-1, -1:])[..., 0].T])


def draw_plant(g, loop, moves, motions):
    """F, G by motion; what is read: C x; the covariance W, with which A(q) y = B(q) u + w has a w of unit variance."""
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
    scales = list(zip([1, 2.2, .45], [1, g.uniform(.4, .7), g.uniform(1.4, 1.8)]))[:motions]
    F, G = (np.array(v) for v in zip(*[sampled(A / time, B * gain / time, dead % 1) for time, gain in scales]))
    W, C = np.eye(len(A)) + g.uniform(-.6, .6) * (1 - np.eye(len(A))), np.eye(1 + (order == "two"), len(A))
    if order == "position":  # a force that is white noise, over one sample
        M = expm(np.block([[-A, np.diag([0, 1])], [np.zeros((2, 2)), A.T]]))
        W, later = M[2:, 2:].T @ M[:2, 2:], np.array([-F[0, 1, 1], F[0, 0, 1]])
        W /= W[0, 0] + later @ W @ later
    return argparse.Namespace(order=order, kind=kind, slow=slow, gain=gains[0, 0], dead=dead, d=dead.astype(int), F=F,
                              G=G, W=W, C=C, moves=moves, law=None, control=None)


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


def draw_log(g, loop, motions):
    """A plant, and readings, inputs and set points of its runs from the operating point on."""
    moves, p = not loop or g.random() < .75, None
    while p is None or loop and not draw_loop(g, p):
        p = draw_plant(g, loop, moves, g.integers(min(2, motions), motions + 1))
    p.logged, p.rounded, p.loud = loop and g.random() < .5, g.random() < .5, int(len(p.F) > 1 and g.random() < .4)
    p.rate_hz, p.train = round(10 * 20 ** g.random(), 1), g.choice([4, 5, 6, 8])
    p.ratio, p.level = g.choice([0, .25, 1, 10, 70]), g.choice(["fixed", "fixed", "by run", "wandering"])
    p.level_in, p.stay = g.choice(["equation", "sensor"]) if p.kind == "stable" else "sensor", max(120, 4 * p.slow)
    p.shape, low, high = [("held", .3, 2), ("PRBS", .1, .6), ("smooth", .1, .5)][g.integers(3)]
    N = (before := int(3 * p.slow) + 25) + int(np.clip(p.slow * g.uniform(10, 25), 400, 2000))
    many = lambda *a: np.array([signal(g, *a, N) for _ in range(p.train + TEST_RUNS)])  # noqa: E731
    *u, r = (many(p.shape, low * p.slow, high * p.slow)[..., None] for _ in range(len(p.d) + 1))
    motion, loud = (many(kinds, .6 * p.stay, 1.6 * p.stay) for kinds in (len(p.F), 1 + p.loud))
    y, u = readings(g, p, np.concatenate(u, 2), r, motion, 1 + 2 * loud[..., None], before)
    return p, y[:, before:], u[:, before:], r[:, before:] * moves


def readings(g, p, u, r, motion, loud, before):
    """Noise and level as large as the response without them asks for, and what then is read."""
    still, force = np.zeros(u.shape[:2] + (len(p.C),)), np.zeros(u.shape[:2] + (len(p.W),))
    sd = lambda *a: np.sqrt(simulate(p, *a, motion)[:, before:].var(1).mean(0))  # noqa: E731
    p.response = sd(u.copy(), r, still, force, still)
    noise = p.response * .004 * 12.5 ** g.random()
    each = np.resize(noise / max(1, p.ratio) ** .5, len(p.W))
    w = g.standard_normal(force.shape) @ np.linalg.cholesky(p.W).T * each * loud
    shrink = min(1, .4 / (sd(0 * u, 0 * r, still, w, still) / p.response).max())
    p.noise, p.W = noise * shrink, p.W * np.outer(each, each) * shrink ** 2
    p.R, p.Q = p.noise ** 2 * min(1, p.ratio), p.noise ** 2 / max(1, p.ratio)
    quantum = p.noise * g.uniform(.1, .2) if p.rounded else 1e-6 * p.response
    p.digits = -np.round(np.log10(quantum)).astype(int)
    p.unit = .1 ** p.digits / quantum  # in it the quantum is a power of ten
    p.step, by_run = p.noise * g.uniform(.1, .5) * (p.level == "wandering"), p.response / 2 * (p.level == "by run")
    p.start = by_run ** 2 + p.step ** 2 * before  # variance of the level at the start
    level = g.standard_normal(still.shape).cumsum(1) * p.step + g.standard_normal(still[:, :1].shape) * by_run
    y = simulate(p, u, r * p.moves, level, w * shrink, g.standard_normal(still.shape) * np.sqrt(p.R), motion)
    p.R = p.R + quantum ** 2 / 12
    return quantum * np.round(y / quantum), u


def kalman(p, many, y, u, chain=None):
    """What `filtered` answers of the samples that all inputs can reach, for many sets of parameters."""
    F, G, W, R, mean, step = (np.array([m[name] for m in many]) for name in many[0])
    n, eye, first, last = len(p.W), np.eye(len(p.C)), p.d.max() + 2, u.shape[1]
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


def one(options, number):
    """Writes the log of that number (a logged set point is a column beside), and answers the bounds."""
    g, folder = np.random.default_rng([options.seed, number]), options.folder / f"log_{number:03d}"
    p, y, u, r = draw_log(g, number % 2 == 1, options.motions)
    many = [{"F": F, "G": G, "W": p.W * loud, "R": p.R, "mean": 0 * p.R, "step": p.step ** 2}
            for F, G in zip(p.F, p.G) for loud in [1, 9][:1 + p.loud]]
    leave, train, test = .9 / p.stay, (y[:p.train], u[:p.train]), (y[p.train:], u[p.train:])
    chain = [np.eye(n) * (1 - n * leave) + leave if n > 1 else np.eye(1) for n in (len(p.F), 1 + p.loud)]
    nats = [kalman(p, many, *runs)[2][WARM:].mean((0, 1)) for runs in (train, test)]
    true = kalman(p, many, *test, np.kron(*chain) if len(many) > 1 else None)[2][WARM:].mean() - np.log(p.unit).sum()
    names = "order kind law moves logged shape level level_in ratio rounded dead rate_hz slow train loud".split()
    truth = dict({name: getattr(p, name) for name in names}, R=p.R * p.unit ** 2, Q=p.Q * p.unit ** 2,
                 input_delay=p.d + 1, state_lags=1 + (p.order == "position"), motions=len(p.F), nats_true_filter=true,
                 nats_true_single=nats[1][nats[0].argmax()] - np.log(p.unit).sum())
    if p.kind == "stable" and len(p.F) == 1:
        v = cramer_rao(p, many[0], *train)
        truth.update(gain=v[0] * p.unit[:, None], gain_error=v[2] * p.unit[:, None])
        truth.update(time=v[1] / p.rate_hz, time_error=v[3] / p.rate_hz)
    truth = {name: value.tolist() if hasattr(value, "tolist") else value for name, value in truth.items()}
    at, runs = g.choice([0, 20, 101325, -40]), [f"{run:02d}" for run in range(len(y))]
    folder.mkdir(parents=True, exist_ok=True)
    states, inputs = [f"y{o}" for o in range(len(p.C))], [f"u{i}" for i in range(len(p.d))]
    time, logged = np.arange(y.shape[1])[:, None] / p.rate_hz + 0 * r, [r * p.unit[0] + at] * p.logged
    rows = np.concatenate([time, y * p.unit + at, u] + logged, 2)
    form = ["%.9f"] + [f"%.{d}f" for d in p.digits] + ["%.12g"] * (len(inputs) + p.logged)
    header = ",".join(["time"] + states + inputs + ["setpoint"] * p.logged)
    for run, table in zip(runs, rows):
        np.savetxt(folder / f"run_{run}.csv", table, form, ",", header=header, comments="")
    (folder / "log.ini").write_text(f"[data]\ninputs = run_*.csv\ntime = time\nstate = {', '.join(states)}\n"
                                    f"input = {', '.join(inputs)}\ntrain = {', '.join(runs[:p.train])}\n")
    (folder / "truth.json").write_text(json.dumps(truth, indent=1))
    return judged(truth, identify(options.program, folder, truth), *train) if options.program else []


def identify(program, folder, truth):
    """Whether the program refuses the log, or says that a law of y computes u; the numbers where it has a model."""
    command = [program.resolve(), "run", "log.ini", "--until", "windows", "--archive.output", "out.h5", "--force",
               "--job.threads", "1", "--filter.variant", "kf", "--window.step", "1000"]  # no modes, and few windows
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
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
    if "gain" not in truth:
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
    for name, default in (("logs", 400), ("seed", 1), ("motions", 1), ("jobs", None)):
        parser.add_argument("--" + name, type=int, default=default)
    options, good = parser.parse_args(), True
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        answers = sum(pool.map(one, [options] * options.logs, range(options.logs)), [])
    for name, (low, high) in BOUNDS.items() if options.program else ():
        got = [bool(right) for what, right in answers if what == name]
        right, n = sum(got), len(got)
        holds = n == 0 or binom.cdf(right, n, low) >= .01 and binom.sf(right - 1, n, high) >= .01
        good &= bool(holds)
        print(f"{name:34} {right:4} of {n:4} {100 * right / max(n, 1):6.1f} % {low}-{high} {'' if holds else 'FAILS'}")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
