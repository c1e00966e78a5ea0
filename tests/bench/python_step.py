#!/usr/bin/env python3
"""Cost of a filter step from Python: the minimum over many short batches [microseconds].

Usage: PYTHONPATH=build/python python_step.py [ARCHIVE]. Without an archive, the bank has eight modes, one state and two
inputs. bench_modebank measures the same bank in C++.
"""
import sys
import time

import numpy as np

import modebank

STEPS, BATCHES = 500, 300


def eight_modes():
    shape = np.linspace(0.5, 1.5, 8)[:, None, None]
    return modebank.Bank(-0.5 * shape, np.array([[[-0.5, 0.5]]]) * shape, 0.01 * shape, np.full((8, 8), 1 / 8), dt=0.15)


def step_us(bank, make, use):
    inputs, measured = make([0.5] * bank.inputs), [make([0.1 + 0.01 * j] * bank.measurements) for j in range(7)]
    least = float("inf")
    for _ in range(BATCHES):
        step = modebank.Filter(bank).step
        start = time.perf_counter()
        for k in range(STEPS):
            use(step(0.15 * k, inputs, measured[k % 7]))
        least = min(least, (time.perf_counter() - start) / STEPS)
    return 1e6 * least


def main(arguments):
    bank = modebank.Bank.load(arguments[0]) if arguments else eight_modes()
    for name, make in (("arrays", np.array), ("tuples", tuple)):
        print(f"step of {bank.modes} modes, samples as {name}: {step_us(bank, make, lambda e: None):.2f} us, "
              f"with its prediction as an array {step_us(bank, make, lambda e: e.prediction):.2f} us")


if __name__ == "__main__":
    main(sys.argv[1:])
