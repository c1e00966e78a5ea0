"""Systems with one motion: linear ones with a disturbance that was once mistaken for modes, and nonlinear ones.

Each function draws twelve runs of (inputs, states), 400 samples of one or two states and two inputs, from a numpy generator.
"""
import math

import numpy as np

from switching_system import SD, inputs, sticky

RUNS, SAMPLES = 12, 400
A, B = -0.3, np.array([-0.2, 0.2])


def one_state(g, noise=None, a=None, b=None, drive=lambda v: v, delay=lambda run: 1, measured=lambda g, x: x):
    """Runs of x[k+1] = x[k] + a x[k] + drive(b u[k+1-delay]) + w[k]; noise(run) and a, b per sample where given."""
    runs = []
    for run in range(RUNS):
        u, x = inputs(g, run, SAMPLES), np.zeros(SAMPLES)
        w = noise(run) if noise else SD * g.standard_normal(SAMPLES)
        a_k, b_k = (a(run) if a else np.full(SAMPLES, A)), (b(run) if b else np.tile(B, (SAMPLES, 1)))
        late = delay(run) - 1
        for k in range(SAMPLES - 1):
            x[k + 1] = x[k] + a_k[k] * x[k] + drive(b_k[k] @ u[max(k - late, 0)]) + w[k]
        runs.append((u, measured(g, x)[:, None]))
    return runs


def filtered(g, coefficients, order=2):
    """x[k+1] = sum of coefficients times x[k], x[k-1], ... + b u[k] + w[k]."""
    runs = []
    for run in range(RUNS):
        u, x = inputs(g, run, SAMPLES), np.zeros(SAMPLES)
        for k in range(order - 1, SAMPLES - 1):
            x[k + 1] = sum(c * x[k - i] for i, c in enumerate(coefficients)) + B @ u[k] + SD * g.standard_normal()
        runs.append((u, x[:, None]))
    return runs


def scaled_noise(g, size):
    """w[k] = size(x[k], u[k]) times white noise."""
    runs = []
    for run in range(RUNS):
        u, x = inputs(g, run, SAMPLES), np.zeros(SAMPLES)
        for k in range(SAMPLES - 1):
            x[k + 1] = x[k] + A * x[k] + B @ u[k] + SD * size(x[k], u[k]) * g.standard_normal()
        runs.append((u, x[:, None]))
    return runs


def noisy_inputs(g):
    return [(u + 0.15 * g.standard_normal(u.shape), x) for u, x in one_state(g)]


def fraction_of_a_delay(g):
    """An input takes effect .4 samples after it is stamped."""
    runs = []
    for run in range(RUNS):
        u, x = inputs(g, run, SAMPLES), np.zeros(SAMPLES)
        for k in range(SAMPLES - 1):
            x[k + 1] = x[k] + A * x[k] + B @ (0.6 * u[k] + 0.4 * u[max(k - 1, 0)]) + SD * g.standard_normal()
        runs.append((u, x[:, None]))
    return runs


def slow_gain(g):
    gains = [np.exp(0.3 * np.cumsum(g.standard_normal(SAMPLES)) / math.sqrt(100)) for _ in range(RUNS)]
    return one_state(g, b=lambda run: B * gains[run][:, None])


def drifting_bias(g):
    bias = [0.02 * np.cumsum(g.standard_normal(SAMPLES)) / math.sqrt(20) for _ in range(RUNS)]
    return one_state(g, lambda run: bias[run] + SD * g.standard_normal(SAMPLES))


def drifting_coefficients(g):
    phase = g.uniform(0, 2 * np.pi, (RUNS, 3))
    time = [2 * np.pi * np.arange(SAMPLES) / g.uniform(300, 900) for _ in range(RUNS)]
    return one_state(g, a=lambda r: -0.3 + 0.15 * np.sin(time[r] + phase[r, 0]),
                     b=lambda r: B + 0.12 * np.sin(time[r][:, None] + phase[r, 1:]))


def coloured(g):
    def noise(run):
        w = SD * g.standard_normal(SAMPLES)
        for k in range(1, SAMPLES):
            w[k] += 0.6 * w[k - 1]
        return w
    return one_state(g, noise)


def noise_by_run(g):
    sizes = SD * np.exp(0.5 * g.standard_normal(RUNS))
    return one_state(g, lambda run: sizes[run] * g.standard_normal(SAMPLES))


def pole_by_run(g):
    poles = g.uniform(-0.45, -0.2, RUNS)
    return one_state(g, a=lambda run: np.full(SAMPLES, poles[run]))


def quantised(g):
    quantum = SD * g.uniform(1 / 3, 1.0)
    return [(u, quantum * np.round(x / quantum)) for u, x in one_state(g)]


def outliers(g):
    return one_state(g, measured=lambda h, x: x + (h.random(SAMPLES) < 0.01) * 0.3 * h.standard_normal(SAMPLES))


def feedback(g):
    """The inputs control the state to changing levels: u reacts to x of the same sample."""
    runs = []
    for run in range(RUNS):
        level, u, x = inputs(g, run, SAMPLES)[:, 0] * 0.4, np.zeros((SAMPLES, 2)), np.zeros(SAMPLES)
        for k in range(SAMPLES - 1):
            u[k] = np.array([-1, 1]) * (level[k] - x[k]) + 0.05 * g.standard_normal(2)
            x[k + 1] = x[k] + A * x[k] + B @ u[k] + SD * g.standard_normal()
        runs.append((u, x[:, None]))
    return runs


def unseen_input(g):
    """A third input, a sine of its own period per run, is not logged."""
    periods = g.uniform(20, 60, RUNS)
    return one_state(g, lambda run: SD * (g.standard_normal(SAMPLES) + np.sin(2 * np.pi * np.arange(SAMPLES) / periods[run])))


def two_states(g):
    """Two coupled states with heavy-tailed noise."""
    pair, gain = np.array([[-0.3, 0.1], [-0.15, -0.2]]), np.array([[-0.2, 0.2], [0.15, 0.1]])
    runs = []
    for run in range(RUNS):
        u, x = inputs(g, run, SAMPLES), np.zeros((SAMPLES, 2))
        for k in range(SAMPLES - 1):
            x[k + 1] = x[k] + pair @ x[k] + gain @ u[k] + SD * g.standard_t(4, 2) / math.sqrt(2)
        runs.append((u, x))
    return runs


def delay_by_run(g):
    delays = g.integers(1, 5, RUNS)
    return one_state(g, delay=lambda run: int(delays[run]))


def friction(v):
    return math.copysign(max(abs(v) - 0.04, 0), v) - 0.02 * math.copysign(1, v)


def dragging(g):
    runs = []
    for run in range(RUNS):
        u, x = inputs(g, run, SAMPLES), np.zeros(SAMPLES)
        for k in range(SAMPLES - 1):
            x[k + 1] = x[k] - 0.1 * x[k] - 1.5 * x[k] * abs(x[k]) + B @ u[k] + SD / 2 * g.standard_normal()
        runs.append((u, x[:, None]))
    return runs


def backlash(g):
    runs = []
    for run in range(RUNS):
        u, x, played = inputs(g, run, SAMPLES), np.zeros(SAMPLES), 0.0
        for k in range(SAMPLES - 1):
            v = B @ u[k]
            played = min(max(played, v - 0.05), v + 0.05)
            x[k + 1] = x[k] + A * x[k] + played + SD / 2 * g.standard_normal()
        runs.append((u, x[:, None]))
    return runs


def rate_limit(g):
    runs = []
    for run in range(RUNS):
        u, x = inputs(g, run, SAMPLES), np.zeros(SAMPLES)
        for k in range(SAMPLES - 1):
            step = A * x[k] + B @ u[k]
            x[k + 1] = x[k] + min(max(step, -0.04), 0.04) + SD / 2 * g.standard_normal()
        runs.append((u, x[:, None]))
    return runs


LINEAR = {
    "one lag, white noise": one_state,
    "dead time of 3 samples": lambda g: one_state(g, delay=lambda run: 3),
    "delay that differs by run": delay_by_run,
    "one lag too few": lambda g: filtered(g, [1.1, -0.4]),
    "three lags": lambda g: filtered(g, [1.2, -0.6, 0.2], 3),
    "noise in the inputs": noisy_inputs,
    "noise that follows the input": lambda g: scaled_noise(g, lambda x, u: 0.4 + 3 * abs(u[0])),
    "noise that follows the state": lambda g: scaled_noise(g, lambda x, u: 0.4 + 8 * abs(x)),
    "a fraction of a sample of delay": fraction_of_a_delay,
    "slow gain": slow_gain,
    "drifting bias": drifting_bias,
    "drifting coefficients": drifting_coefficients,
    "pole that differs by run": pole_by_run,
    "Student's t, 4 degrees": lambda g: one_state(g, lambda run: SD * g.standard_t(4, SAMPLES) / math.sqrt(2.0)),
    "two noise levels that switch": lambda g: one_state(
        g, lambda run: SD * np.array([0.4, 1.6])[sticky(g, 2, 80, SAMPLES)] * g.standard_normal(SAMPLES)),
    "noise that differs by run": noise_by_run,
    "coloured noise": coloured,
    "measurement noise as large as the process'": lambda g: one_state(g, measured=lambda h, x: x + SD * h.standard_normal(SAMPLES)),
    "output quantised": quantised,
    "outliers, one in a hundred": outliers,
    "no input effect": lambda g: one_state(g, b=lambda run: np.zeros((SAMPLES, 2))),
    "feedback": feedback,
    "an input that is not logged": unseen_input,
    "two states, heavy tails": two_states,
}
BENT = {
    "saturation": lambda g: one_state(g, drive=lambda v: min(max(v, -0.05), 0.05)),
    "dead zone": lambda g: one_state(g, drive=lambda v: math.copysign(max(abs(v) - 0.05, 0), v)),
    "tanh": lambda g: one_state(g, drive=lambda v: 0.1 * math.tanh(v / 0.05)),
    "friction": lambda g: one_state(g, drive=friction),
    "drag": dragging,
    "backlash": backlash,
    "rate limit": rate_limit,
}
