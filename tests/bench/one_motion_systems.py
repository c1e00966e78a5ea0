"""Systems with one motion: linear ones with a disturbance that was once mistaken for modes, and nonlinear ones.

Each function draws twelve runs of (inputs, states), 400 samples of one or two states and two inputs.
"""
import math

import numpy as np
from scipy.signal import lfilter

from switching_system import SD, inputs, sticky, switched

RUNS, SAMPLES = 12, 400
A, B = -0.3, np.array([-0.2, 0.2])


def one_state(g, noise=None, a=A, b=B, drive=lambda v: v, delay=1, measured=lambda x: x):
    """Runs of x[k+1] = x[k] + a x[k] + drive(b u[k+1-delay]) + w[k]; a and b by run and sample, delay by run."""
    a, b = np.broadcast_to(a, (RUNS, SAMPLES)), np.broadcast_to(b, (RUNS, SAMPLES, 2))
    runs = []
    for run, late in enumerate(np.broadcast_to(delay, RUNS) - 1):
        u, x = inputs(g, run, SAMPLES), np.zeros(SAMPLES)
        w = noise(run) if noise else SD * g.standard_normal(SAMPLES)
        for k in range(SAMPLES - 1):
            x[k + 1] = x[k] + a[run, k] * x[k] + drive(b[run, k] @ u[max(k - late, 0)]) + w[k]
        runs.append((u, measured(x)[:, None]))
    return runs


def stepped(g, step, sd=lambda x, u: SD, first=0):
    """Runs of x[k+1] = x[k] + step(x, u, k) + w[k], w of deviation sd(x[k], u[k])."""
    runs = []
    for run in range(RUNS):
        u, x = inputs(g, run, SAMPLES), np.zeros(SAMPLES)
        for k in range(first, SAMPLES - 1):
            x[k + 1] = x[k] + step(x, u, k) + sd(x[k], u[k]) * g.standard_normal()
        runs.append((u, x[:, None]))
    return runs


def calm(x, u):
    return SD / 2


def linear(x, u, k):
    return A * x[k] + B @ u[k]


def lagged(g, *coefficients):
    """x[k+1] = sum of coefficients times x[k], x[k-1], ... + b u[k] + w[k]."""
    first = len(coefficients) - 1
    return stepped(g, lambda x, u, k: x[k - first:k + 1] @ coefficients[::-1] - x[k] + B @ u[k], first=first)


def walks(g):
    return g.standard_normal((RUNS, SAMPLES)).cumsum(1)


def drifting_bias(g):
    bias = 0.02 / math.sqrt(20) * walks(g)
    return one_state(g, lambda run: bias[run] + SD * g.standard_normal(SAMPLES))


def drifting_coefficients(g):
    phase = g.uniform(0, 2 * np.pi, (RUNS, 1, 3))
    time = 2 * np.pi * np.arange(SAMPLES) / g.uniform(300, 900, (RUNS, 1))
    sines = np.sin(time[..., None] + phase)
    return one_state(g, a=A + 0.15 * sines[..., 0], b=B + 0.12 * sines[..., 1:])


def noise_by_run(g):
    sizes = SD * np.exp(0.5 * g.standard_normal(RUNS))
    return one_state(g, lambda run: sizes[run] * g.standard_normal(SAMPLES))


def quantised(g):
    quantum = SD * g.uniform(1 / 3, 1.0)
    return [(u, quantum * np.round(x / quantum)) for u, x in one_state(g)]


def feedback(g):
    """The inputs control the state to changing levels: u reacts to x of the same sample."""
    def step(x, u, k):
        u[k] = np.array([-1, 1]) * (0.4 * u[k, 0] - x[k]) + 0.05 * g.standard_normal(2)
        u[-1] *= k < SAMPLES - 2
        return linear(x, u, k)
    return stepped(g, step)


def unseen_input(g):
    """A third input, a sine of its own period per run, is not logged."""
    sines = np.sin(2 * np.pi * np.arange(SAMPLES) / g.uniform(20, 60, (RUNS, 1)))
    return one_state(g, lambda run: SD * (g.standard_normal(SAMPLES) + sines[run]))


def two_states(g):
    """Two coupled states with heavy-tailed noise."""
    pair, still = (np.array([[0.7, 0.1], [-0.15, 0.8]]), np.array([[-0.2, 0.2], [0.15, 0.1]])), np.zeros(SAMPLES, int)
    drawn = [(inputs(g, run, SAMPLES), SD / math.sqrt(2) * g.standard_t(4, (SAMPLES - 1, 2))) for run in range(RUNS)]
    return [(u, switched([pair], still, u, w)) for u, w in drawn]


def dead_zone(v, width):
    return math.copysign(max(abs(v) - width, 0), v)


def backlash(g):
    played = [0.0]

    def step(x, u, k):
        v = B @ u[k]
        played[0] = np.clip(played[0] * (k > 0), v - 0.05, v + 0.05)
        return A * x[k] + played[0]
    return stepped(g, step, calm)


LINEAR = {
    "one lag, white noise": one_state,
    "dead time of 3 samples": lambda g: one_state(g, delay=3),
    "delay that differs by run": lambda g: one_state(g, delay=g.integers(1, 5, RUNS)),
    "one lag too few": lambda g: lagged(g, 1.1, -0.4),
    "three lags": lambda g: lagged(g, 1.2, -0.6, 0.2),
    "noise in the inputs": lambda g: [(u + 0.15 * g.standard_normal(u.shape), x) for u, x in one_state(g)],
    "noise that follows the input": lambda g: stepped(g, linear, lambda x, u: SD * (0.4 + 3 * abs(u[0]))),
    "noise that follows the state": lambda g: stepped(g, linear, lambda x, u: SD * (0.4 + 8 * abs(x))),
    "a fraction of a sample of delay": lambda g: stepped(
        g, lambda x, u, k: A * x[k] + B @ (0.6 * u[k] + 0.4 * u[max(k - 1, 0)])),
    "slow gain": lambda g: one_state(g, b=B * np.exp(0.03 * walks(g))[..., None]),
    "drifting bias": drifting_bias,
    "drifting coefficients": drifting_coefficients,
    "pole that differs by run": lambda g: one_state(g, a=g.uniform(-0.45, -0.2, (RUNS, 1))),
    "Student's t, 4 degrees": lambda g: one_state(g, lambda run: SD * g.standard_t(4, SAMPLES) / math.sqrt(2.0)),
    "two noise levels that switch": lambda g: one_state(
        g, lambda run: SD * np.array([0.4, 1.6])[sticky(g, 2, 80, SAMPLES)] * g.standard_normal(SAMPLES)),
    "noise that differs by run": noise_by_run,
    "coloured noise": lambda g: one_state(g, lambda run: lfilter([1], [1, -0.6], SD * g.standard_normal(SAMPLES))),
    "measurement noise as large as the process'": lambda g: one_state(
        g, measured=lambda x: x + SD * g.standard_normal(SAMPLES)),
    "output quantised": quantised,
    "outliers, one in a hundred": lambda g: one_state(
        g, measured=lambda x: x + (g.random(SAMPLES) < 0.01) * 0.3 * g.standard_normal(SAMPLES)),
    "no input effect": lambda g: one_state(g, b=0),
    "feedback": feedback,
    "an input that is not logged": unseen_input,
    "two states, heavy tails": two_states,
}
BENT = {
    "saturation": lambda g: one_state(g, drive=lambda v: min(max(v, -0.05), 0.05)),
    "dead zone": lambda g: one_state(g, drive=lambda v: dead_zone(v, 0.05)),
    "tanh": lambda g: one_state(g, drive=lambda v: 0.1 * math.tanh(v / 0.05)),
    "friction": lambda g: one_state(g, drive=lambda v: dead_zone(v, 0.04) - 0.02 * math.copysign(1, v)),
    "drag": lambda g: stepped(g, lambda x, u, k: B @ u[k] - 0.1 * x[k] - 1.5 * x[k] * abs(x[k]), calm),
    "backlash": backlash,
    "rate limit": lambda g: stepped(g, lambda x, u, k: np.clip(linear(x, u, k), -0.04, 0.04), calm),
}
